"""Fits to a tolerance of very many samples go by some of them: how often all are passed, and what all say of the result, by SciPy."""
import json
import unittest

import numpy as np

from judge import InFolder, curve, distances, evaluate, some


def helix(count):
    t = np.linspace(0, 1, count)
    return np.c_[np.cos(20 * t), np.sin(20 * t), 3 * t]


class ManySamples(InFolder):
    def fit(self, points, *arguments, status=0):
        np.save(self.folder / "p.npy", points)
        done = self.run_batten("fit", "p.npy", *arguments, "-q", "-o", "o.json", "--summary", "s.json")
        self.assertEqual(done.returncode, status, done.stderr)
        return json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text())

    def goes_by_some(self, summary, samples, checks):
        self.assertLess(summary["searched_samples"], samples / 3)
        self.assertLessEqual(summary["full_checks"], checks)
        self.assertEqual(summary["termination"], "tolerance_met")

    def worst_and_some(self, spline, points):
        """Distances of every hundredth sample, and of all beside where these are largest."""
        far = distances(spline, points[::101]).argsort()[-20:] * 101
        beside = np.unique(np.clip(far[:, None] + np.arange(-101, 102), 0, len(points) - 1))
        return max(distances(spline, points[::101]).max(), distances(spline, points[beside]).max())

    def test_a_curve_of_a_million(self):
        noise = 1e-3 * np.random.default_rng(1).standard_normal((10**6, 3))
        for points, tolerance, most in some([(helix(10**6), 1e-4, 42), (helix(10**6) + noise, 0.01, 19)]):
            spline, summary = self.fit(points, "--tolerance", tolerance)
            self.goes_by_some(summary, 10**6, 40)
            self.assertLessEqual(summary["control_shape"][0], most)
            self.assertLessEqual(self.worst_and_some(spline, points), tolerance * (1 + 1e-9))

    def test_what_few_samples_do_not_show_is_found(self):
        """A spike of a few dozen samples, and samples that crowd at one place."""
        t = np.linspace(0, 1, 60000)
        spike = np.c_[6 * t, np.exp(-(((t - 0.4137) / 3e-4) ** 2))]
        crowd = np.r_[helix(30000)[:300], np.repeat(helix(30000)[300:301], 30000, 0), helix(30000)[300:]]
        for points in (spike, crowd):
            spline, summary = self.fit(points, "--tolerance", 1e-3)
            self.goes_by_some(summary, len(points), 60)
            self.assertLessEqual(distances(spline, points[18000:32000]).max(), 1e-3 * (1 + 1e-9))
            self.assertLessEqual(self.worst_and_some(spline, points), 1e-3 * (1 + 1e-9))

    def test_what_must_hold_holds(self):
        points = helix(50000)
        for arguments in (["--interpolate", "0,777,31234,49999"], ["--interpolate", "ends", "--degree", "5"], ["--degree", "1"]):
            spline, summary = self.fit(points, "--tolerance", 1e-3, *arguments)
            self.goes_by_some(summary, len(points), 60)
            self.assertLessEqual(self.worst_and_some(spline, points), 1e-3 * (1 + 1e-9))
            if "0,777,31234,49999" in arguments:
                self.assertLess(distances(spline, points[[0, 777, 31234, 49999]]).max(), 1e-9)

    def test_each_sample_has_its_own_tolerance_and_weight(self):
        points = helix(40000)
        own = np.where(np.arange(40000) % 7 == 0, 1e-3, 1e-2)
        np.savetxt(self.folder / "own.txt", own)
        spline, summary = self.fit(points, "--tolerances", "own.txt")
        self.goes_by_some(summary, len(points), 60)
        self.assertLessEqual(distances(spline, points[::7]).max(), 1e-3 * (1 + 1e-9))
        self.assertLessEqual(distances(spline, points[::5]).max(), 1e-2 * (1 + 1e-9))

    def test_closed_curves_corners_and_limits(self):
        t = np.linspace(0, 1, 40000, endpoint=False)
        ring = np.c_[(2 + np.cos(10 * np.pi * t)) * np.cos(2 * np.pi * t), (2 + np.cos(10 * np.pi * t)) * np.sin(2 * np.pi * t)]
        spline, summary = self.fit(ring, "--closed", "--tolerance", 1e-3)
        self.goes_by_some(summary, len(ring), 60)
        self.assertLessEqual(self.worst_and_some(spline, ring), 1e-3 * (1 + 1e-9))
        zigzag = np.c_[np.linspace(0, 4, 40001), abs(np.linspace(0, 4, 40001) % 2 - 1)]
        spline, summary = self.fit(zigzag, "--tolerance", 1e-4)
        self.goes_by_some(summary, len(zigzag), 60)
        self.assertLessEqual(summary["control_shape"][0], 13)
        self.assertLessEqual(self.worst_and_some(spline, zigzag), 1e-4 * (1 + 1e-9))
        _, summary = self.fit(helix(40000), "--tolerance", 1e-4, "--max-control-points", 12, status=4)
        self.assertEqual(summary["termination"], "tolerance_not_met")
        self.assertLessEqual(summary["control_shape"][0], 12)

    def test_reversed_samples_and_threads(self):
        points = helix(40000) + 1e-3 * np.random.default_rng(2).standard_normal((40000, 3))
        spline, _ = self.fit(points, "--tolerance", 0.01)
        one, _ = self.fit(points, "--tolerance", 0.01, "--threads", 1)
        self.assertEqual(one, spline)
        back, _ = self.fit(points[::-1], "--tolerance", 0.01)
        t = np.linspace(0, 1, 400)
        np.testing.assert_allclose(curve(back)(1 - t), curve(spline)(t), atol=1e-9)

    def test_surfaces(self):
        """A grid by some of its lines, a cloud by some of its samples: every sample at its parameters, by SciPy."""
        u, v = np.linspace(0, 1, 500), np.linspace(0, 1, 400)
        heights = np.sin(7 * u)[:, None] * np.cos(9 * v)
        spline, summary = self.fit(heights, "--heights", "--tolerance", 1e-3)
        self.goes_by_some(summary, heights.size, 40)
        self.assertLessEqual(np.prod(summary["control_shape"]), 14 * 18)
        ends = [(knots[0], knots[-1]) for knots in spline["knots"]]
        surface = evaluate(spline, *(a + (b - a) * w for (a, b), w in zip(ends, (u, v))))
        self.assertLessEqual(abs(surface[..., -1] - heights).max(), 1e-3 * (1 + 1e-9))
        places = np.random.default_rng(3).random((100000, 2))
        cloud = np.c_[places, np.sin(7 * places[:, 0]) * np.cos(9 * places[:, 1])]
        _, summary = self.fit(cloud, "--project", "xy", "--tolerance", 1e-3)
        self.goes_by_some(summary, len(cloud), 40)


if __name__ == "__main__":
    unittest.main()
