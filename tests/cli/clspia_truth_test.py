"""CLSPIA is converged only when its samples are hit and it is the optimum: judged by a dense solve of the saddle point in NumPy."""
import json
import subprocess
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD, InFolder

COUNT = 20
HELD = [0, 60, 115, 199]
EXACT = 1e-9  # part of the data's size


class ClspiaTruth(InFolder):
    def setUp(self):
        super().setUp()
        self.t = np.linspace(0, 1, 200)
        self.data = np.c_[np.cos(4 * self.t) + self.t, np.sin(6 * self.t)] + 0.02 * np.random.default_rng(3).normal(size=(200, 2))

    def fit(self, data, *arguments, held=HELD):
        """(summary, the spline at the samples, its distance from the dense optimum), both over the data's size."""
        np.savetxt(self.folder / "p.csv", data, delimiter=",", fmt="%.17g")
        np.savetxt(self.folder / "t.txt", self.t, fmt="%.17g")
        done = subprocess.run([BATTEN, "fit", "p.csv", "-n", str(COUNT), "-m", "clspia", "--parameters", "t.txt", "--interpolate", ",".join(map(str, held)), "-q",
                               "-o", "o.json", "--summary", "s.json", *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        spline, summary = json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text())
        matrix = BSpline.design_matrix(self.t, np.array(spline["knots"][0]), spline["degree"][0]).toarray()
        keep = np.setdiff1d(np.arange(len(data)), held)
        size = np.linalg.norm(np.ptp(data, axis=0))
        origin = data[0]
        A, B = matrix[keep], matrix[held]
        kkt = np.block([[A.T @ A, B.T], [B, np.zeros((len(held), len(held)))]])
        best = np.linalg.solve(kkt, np.r_[A.T @ (data[keep] - origin), data[held] - origin])[:COUNT] + origin
        control = np.array(spline["control_points"])
        miss = np.linalg.norm(matrix[held] @ control - data[held], axis=1).max() / size
        return summary, miss, np.abs(control - best).max() / size

    def test_converged_means_hit_whatever_the_stop(self):
        for scale in (1, 1e-6, 1e6):
            for stop in (("--stop-relative-gradient", 0.5), ("--stop-relative-gradient", 0.01), ("--stop-gradient", 1000 * scale),
                         ("--stop-deviation", 100 * scale), ("--stop-deviation", 100 * scale, "--stop-gradient", scale)):
                summary, miss, _ = self.fit(self.data * scale, "--max-iterations", 100000, *stop)
                self.assertEqual(summary["termination"], "tolerance_met" if "--stop-deviation" in stop else "converged", (stop, scale))
                self.assertLessEqual(miss, EXACT * 1.001, (stop, scale))

    def test_stopping_short_is_not_converged(self):
        for stop in (("--stop-relative-gradient", 0.5), ("--stop-deviation", 100)):
            summary, miss, _ = self.fit(self.data, "--max-iterations", 15, *stop)
            self.assertGreater(miss, EXACT)
            self.assertEqual(summary["termination"], "iteration_limit")

    def test_a_small_relative_gradient_is_the_optimum_in_any_unit(self):
        """lambda^0 = 1 dwarfs data in a small unit: relative to it the gradient would be small at once."""
        for scale in (1, 1e-5, 1e5):
            summary, miss, off = self.fit(self.data * scale, "--stop-relative-gradient", 1e-9, "--max-iterations", 300000)
            self.assertEqual(summary["termination"], "converged", scale)
            self.assertLess(miss, EXACT)
            self.assertLess(off, 1e-7, scale)

    def test_samples_that_must_be_hit_may_be_what_determines_a_control_point(self):
        """The others do not reach it, or only where its hat function is 1e-9."""
        width = 1 / (COUNT - 1)
        middle = 9 * width  # a knot of the even ones, where a hat function is 1
        kept = np.abs(self.t - middle) > 1.01 * width
        only = int(np.argmin(np.abs(self.t - middle)))
        kept[only] = True
        held = int(kept[:only].sum())
        t, data = self.t[kept], self.data[kept]
        for edge in ([], [middle - width * (1 - 1e-9)]):
            with self.subTest(edge=edge):
                self.t = np.insert(t, held, edge)
                points = np.insert(data, held, np.tile(data[held - 1], (len(edge), 1)), axis=0)
                summary, miss, off = self.fit(points, "-p", 1, "--knots", "uniform", "--stop-relative-gradient", 1e-10, "--max-iterations", 300000,
                                              held=[held + len(edge)])
                self.assertEqual(summary["termination"], "converged")
                self.assertLess(miss, EXACT)
                self.assertLess(off, 1e-7)


if __name__ == "__main__":
    unittest.main()
