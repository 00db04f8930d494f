"""What options come to at sizes that once were too dear, or singular by mistake: judged by sparse and dense algebra of NumPy and SciPy, and by
the memory that they take, which a method of too high an order shows in any surroundings."""
import json
import subprocess
import sys
import unittest

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
from scipy.interpolate import BSpline
from scipy.optimize import nnls

from judge import BATTEN, GUARD, SANITIZED, InFolder

# runs a command, prints the kibibytes that it took: of a small process, as what is started has the size of its parent at first
MEASURED = """
import resource, subprocess, sys
status = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(status)
"""


def noisy(m, noise=1e-3):
    t = np.linspace(0, 1, m)
    return np.stack([np.cos(6 * t) + t, np.sin(9 * t)], axis=1) + noise * np.random.default_rng(7).standard_normal((m, 2))


def turns(p):
    a, b = np.diff(p, axis=0)[:-1], np.diff(p, axis=0)[1:]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


class Scale(InFolder):
    def fit(self, points, *arguments, at=None, most=None):
        """The spline and the summary of a fit at even parameters over [0, 1] that takes at most so many mebibytes."""
        np.save(self.folder / "p.npy", points)
        np.save(self.folder / "t.npy", np.linspace(0, 1, len(points)) if at is None else at)
        done = subprocess.run([sys.executable, "-c", MEASURED, BATTEN, "fit", "p.npy", "--parameters", "t.npy", *map(str, arguments), "-q", "-o", "o.json",
                               "--summary", "s.json"], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        if most and not SANITIZED:
            self.assertLess(int(done.stdout) / 1024, most)
        spline = json.loads((self.folder / "o.json").read_text())
        return spline, json.loads((self.folder / "s.json").read_text())

    @staticmethod
    def collocation(spline, m):
        knots, degree = np.array(spline["knots"][0]), spline["degree"][0]
        return BSpline.design_matrix(np.linspace(0, 1, m), knots, degree).tocsc()

    @staticmethod
    def roughness(spline):
        """Integrals of products of second derivatives of cubics, Simpson's rule being exact."""
        knots = np.array(spline["knots"][0])
        n = len(knots) - 4
        breaks = np.unique(knots[3:n + 1])
        bend = BSpline(knots, np.eye(n), 3).derivative(2)
        at = [bend(breaks[:-1] + part * np.diff(breaks)) for part in (1e-9, 0.5, 1 - 1e-9)]
        return sum(weight * (values.T * np.diff(breaks) / 6) @ values for weight, values in zip((1, 4, 1), at))

    def test_freedom_of_a_smoothed_curve(self):
        """The trace of A (A^T A + lambda m R)^-1 A^T by dense inverses, at many control points and at few, open and closed."""
        for m, n, extra in ((20000, 1200, ()), (3000, 40, ()), (3000, 40, ("--smooth-order", 3))):
            with self.subTest(n=n, extra=extra):
                spline, summary = self.fit(noisy(m), "-n", n, "--smooth", "auto", *extra)
                if extra:
                    self.assertLess(summary["degrees_of_freedom"], n)
                    continue
                a = self.collocation(spline, m)
                gram = (a.T @ a).toarray()
                freedom = np.trace(np.linalg.solve(gram + summary["smoothing"] * m * self.roughness(spline), gram))
                self.assertAlmostEqual(summary["degrees_of_freedom"] / freedom, 1, delta=1e-6)

    def test_many_control_points_are_smoothed_in_parts(self):
        """Samples that are taken in several parts leave rows of each other that once vanished into a division of nothing by nothing."""
        few, all_of = (self.fit(noisy(30000), "-n", n, "--smooth", "auto", most=150)[1] for n in (2000, 12000))
        self.assertAlmostEqual(few["degrees_of_freedom"] / all_of["degrees_of_freedom"], 1, delta=0.01)
        self.assertAlmostEqual(few["smoothing"] / all_of["smoothing"], 1, delta=0.05)

    def test_a_list_of_exact_samples(self):
        """By the saddle point's sparse LU factors; S alone would be a gigabyte and more."""
        m, n = 100_000, 20_000
        q = noisy(m)
        exact = np.linspace(0, m - 1, 5000).astype(int)
        (self.folder / "i.txt").write_text("\n".join(map(str, exact)))
        spline, _ = self.fit(q, "-n", n, "--interpolate", "i.txt", most=150)
        p = np.array(spline["control_points"])
        a = self.collocation(spline, m)
        c = a[exact]
        self.assertLess(np.abs(c @ p - q[exact]).max(), 1e-13)
        saddle = sparse.bmat([[a.T @ a, c.T], [c, None]]).tocsc()
        best = sparse.linalg.spsolve(saddle, np.vstack([a.T @ q, q[exact]]))[:n]
        self.assertLess(np.abs(p - best).max(), 1e-10)

    def test_a_list_of_exact_samples_on_a_closed_curve(self):
        m, n = 12_000, 1500
        t = np.arange(m) / m
        q = np.stack([np.cos(2 * np.pi * t), np.sin(4 * np.pi * t)], axis=1) + 1e-3 * np.random.default_rng(2).standard_normal((m, 2))
        exact = np.arange(0, m, 20)
        (self.folder / "i.txt").write_text("\n".join(map(str, exact)))
        spline, _ = self.fit(q, "-n", n, "--closed", "--interpolate", "i.txt", at=t)
        a = BSpline.design_matrix(t, np.array(spline["knots"][0]), 3).tocsc()
        a = a[:, :n] + sparse.hstack([a[:, n:], sparse.csc_matrix((m, n - 3))])
        c = a[exact]
        best = sparse.linalg.spsolve(sparse.bmat([[a.T @ a, c.T], [c, None]]).tocsc(), np.vstack([a.T @ q, q[exact]]))[:n]
        self.assertLess(np.abs(np.array(spline["control_points"])[:n] - best).max(), 1e-10)

    def test_kept_inflections_of_a_noisy_curve(self):
        """No more than the initial polygon's, and a minimum: the pull of the least squares is one of turns that are straight, each held from its own
        side."""
        m, n = 24_000, 3000
        q = noisy(m)
        spline, summary = self.fit(q, "-n", n, "--preserve", "inflections", "-m", "direct", most=150)
        p = np.array(spline["control_points"])
        bends = turns(p)
        self.assertLessEqual(int((np.sign(bends)[1:] != np.sign(bends)[:-1]).sum()), summary["allowed_inflections"])
        a = self.collocation(spline, m)
        pull = (a.T @ (a @ p - q)).ravel()
        legs = np.linalg.norm(np.diff(p, axis=0), axis=1)
        size = (legs[:-1] + legs[1:]) ** 2
        straight = np.flatnonzero(np.abs(bends) < 1e-5 * size)
        rows = np.zeros((len(straight), 2 * n))
        for r, k in enumerate(straight):
            (ax, ay), (bx, by), (cx, cy) = p[k:k + 3]
            rows[r, 2 * k:2 * k + 6] = np.sign(bends[k]) * np.array([by - cy, cx - bx, cy - ay, ax - cx, ay - by, bx - ax]) / np.sqrt(size[k])
        free = pull - rows.T @ self.least_multipliers(rows, pull)
        self.assertLess(np.linalg.norm(free), 0.02 * np.linalg.norm(pull))

    @staticmethod
    def least_multipliers(rows, pull):
        """Not negative, run by run of coordinates that rows share."""
        result = np.zeros(len(rows))
        first = np.array([np.flatnonzero(row)[0] for row in rows])
        breaks = np.flatnonzero(np.diff(first) > 5) + 1
        for run in np.split(np.arange(len(rows)), breaks):
            columns = slice(first[run[0]], first[run[-1]] + 6)
            result[run] = nnls(rows[run, columns].T, pull[columns])[0]
        return result

    def test_nearly_as_many_control_points_as_samples(self):
        q = noisy(1000)
        for n in (850, 880, 900, 920):
            with self.subTest(n=n):
                spline, summary = self.fit(q, "-n", n)
                self.assertEqual(summary["method"], "direct")
                a = self.collocation(spline, len(q)).toarray()
                best = q - a @ np.linalg.lstsq(a, q, rcond=None)[0]
                self.assertAlmostEqual(summary["rms_deviation"] / np.sqrt((best ** 2).sum(axis=1).mean()), 1, delta=1e-6)

    def test_what_no_number_determines_is_refused(self):
        """One knot after the other stands an unlikely row of samples: the condition grows with every span, no single pivot shows it."""
        np.save(self.folder / "p.npy", noisy(1000))
        done = self.run_batten("fit", "p.npy", "--parametrize", "uniform", "-n", 980, "-m", "direct")
        self.assertEqual(done.returncode, 2)
        self.assertIn("singular", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)


if __name__ == "__main__":
    unittest.main()
