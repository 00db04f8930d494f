"""A kept shape, on the control polygon as it is written: its turns counted in fractions from the file's own doubles."""
import fractions
import json
import unittest

import numpy as np

from judge import InFolder, some

METHODS = ("direct", "lspia", "mlspia", "clspia", "chebyshev", "salspia", "lin2018", "cg")


def inflections(points, closed=False):
    """Changes between left and right along a polygon, exactly."""
    points = [tuple(map(fractions.Fraction, p)) for k, p in enumerate(points) if k == 0 or p != points[k - 1]]
    count = len(points)
    signs = []
    for k in range(count if closed else count - 2):
        a, b, c = points[k], points[(k + 1) % count], points[(k + 2) % count]
        turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        if turn != 0:
            signs.append(turn > 0)
    if closed and signs:
        signs.append(signs[0])
    return sum(a != b for a, b in zip(signs, signs[1:]))


def turned(points, angle):
    return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def line_arc_line(count=200):
    s = np.linspace(0, 4 + np.pi / 2, count)
    a = np.clip(s - 2, 0, np.pi / 2)
    return np.c_[np.minimum(s - 2, 0) + np.sin(a), 1 - np.cos(a) + np.maximum(s - 2 - np.pi / 2, 0)]


def stadium(count=240):
    s = np.arange(count) * (4 + 2 * np.pi) / count
    half = 2 + np.pi
    side = np.where(s < half, 1, -1)
    s = s % half
    a = np.clip(s - 2, 0, np.pi)
    return np.c_[side * (np.minimum(s, 2) - 1 + np.sin(a)), -side * np.cos(a)]


def bump(count=200):
    x = np.linspace(0, 1, count)
    noise = 0.003 * np.random.default_rng(8).uniform(-1, 1, count)
    return np.c_[x, 0.4 * np.exp(-40 * (x - 0.5) ** 2) + 0.1 * x + noise]


def star(count=200):
    t = np.arange(count) * 2 * np.pi / count
    r = 1 + 0.25 * np.cos(5 * t) + 0.004 * np.random.default_rng(3).uniform(-1, 1, count)
    return np.c_[r * np.cos(t), r * np.sin(t)]


class Shape(InFolder):
    def fit(self, points, method, *more, preserve="inflections", size=24):
        np.savetxt(self.folder / "p.csv", points, delimiter=",", fmt="%.17g")
        for name in ("o.json", "s.json"):
            (self.folder / name).unlink(missing_ok=True)
        arguments = ["fit", "p.csv", "-q", "-m", method, "-o", "o.json", "--summary", "s.json"]
        if preserve:
            arguments += ["--preserve", preserve]
        if size:
            arguments += ["-n", size]
        if method == "clspia":
            arguments += ["--interpolate", "0,50,150"]
        done = self.run_batten(*arguments, *more)
        self.assertIn(done.returncode, (0, 4), (method, done.stderr))
        spline = json.loads((self.folder / "o.json").read_text())
        report = json.loads((self.folder / "s.json").read_text())
        return done.returncode, report, spline["control_points"]

    def kept(self, points, method, *more, closed=False, **options):
        """The report of a fit that keeps the shape; its count is the file's, and more than allowed is never met."""
        status, report, control = self.fit(points, method, *more, *(["--closed"] if closed else []), **options)
        control = control[:report["control_shape"][0]]
        self.assertEqual(inflections(control, closed), report["inflections"], (method, more))
        if report["inflections"] > report["allowed_inflections"]:
            self.assertEqual(status, 4, (method, more))
            self.assertNotIn(report["termination"], ("converged", "tolerance_met"))
        return report

    def test_the_file_has_no_more_inflections_than_allowed(self):
        for k, method in enumerate(some(METHODS)):
            stop = [] if method == "direct" else ["--max-iterations", 200]
            for j, offset in enumerate((0, 1e3, 1e6, 1e9)):
                make, closed = ((bump, False), (star, True), (line_arc_line, False), (stadium, True))[(j + k) % 4]
                scale = (1, 1e-6, 1e6)[(j + k) % 3]
                points = scale * (turned(make(), 0.3 * (k % 3)) + [offset, -0.7 * offset])
                report = self.kept(points, method, *stop, closed=closed)
                self.assertLessEqual(report["inflections"], report["allowed_inflections"], (method, make.__name__, offset, scale))

    def test_weights_exact_samples_convexity_and_tolerances(self):
        np.savetxt(self.folder / "w.txt", np.random.default_rng(1).uniform(0.2, 5, 200))
        for offset in (0, 1e6):
            points = turned(line_arc_line(), 0.2) + [offset, offset]
            for method in ("direct", "mlspia", "clspia"):
                stop = [] if method == "direct" else ["--max-iterations", 200]
                report = self.kept(points, method, *stop, "--weights", "w.txt", preserve="convexity")
                self.assertEqual(report["inflections"], 0, (method, offset))
            report = self.kept(points, "auto", "--tolerance", 0.02, preserve="convexity", size=None)
            self.assertEqual((report["inflections"], report["termination"]), (0, "tolerance_met"))
            report = self.kept(turned(bump(), 0.2)[::8] + [offset, 0], "pia", "--max-iterations", 50, size=None)
            self.assertLessEqual(report["inflections"], report["allowed_inflections"], offset)

    def test_straight_runs_do_not_lock(self):
        free = self.fit(line_arc_line(), "lspia", preserve=None)[1]["rms_deviation"]
        for angle in (0, 0.3):
            points = turned(line_arc_line(), angle)
            start = self.kept(points, "lspia", "--max-iterations", 0)["rms_deviation"]
            report = self.kept(points, "lspia", "--max-iterations", 500)
            self.assertEqual((report["inflections"], report["allowed_inflections"]), (0, 0))
            self.assertLess(report["rms_deviation"], 10 * free)  # of 2.2e-1 at the start; the least with this shape is 4 times free
            self.assertLess(report["rms_deviation"], start / 50)

    def test_alpha_and_the_rays_as_printed(self):
        points = bump()
        usual = self.kept(points, "clspia", "--max-iterations", 20)
        stated = self.kept(points, "clspia", "--max-iterations", 20, "--set", "alpha=0.8", "--set", "rays=0")
        self.assertEqual(usual["rms_deviation"], stated["rms_deviation"])
        careful = self.kept(points, "clspia", "--max-iterations", 20, "--set", "alpha=0.2")
        self.assertNotEqual(usual["rms_deviation"], careful["rms_deviation"])
        self.assertLessEqual(careful["inflections"], careful["allowed_inflections"])
        printed = self.kept(points, "lspia", "--max-iterations", 500, "--set", "rays=1")
        self.assertGreater(printed["inflections"], printed["allowed_inflections"])  # they leave gaps, and say so

    def test_a_limit_that_nothing_has_is_refused(self):
        np.savetxt(self.folder / "p.csv", bump(40), delimiter=",")
        for more, words in (
                (["-m", "lspia", "-n", 9, "--set", "alpha=0.5"], "setting alpha: no shape is to be kept (preserve)"),
                (["-m", "lspia", "-n", 9, "--set", "rays=1"], "setting rays: no shape is to be kept (preserve)"),
                (["-m", "lspia", "-n", 9, "--set", "alpha=1", "--preserve", "inflections"], "setting alpha = 1 of method lspia is outside 0 < alpha < 1"),
                (["-m", "lspia", "-n", 9, "--set", "rays=2", "--preserve", "inflections"], "setting rays = 2 of method lspia is outside"),
                (["-m", "direct", "-n", 9, "--set", "alpha=0.5", "--preserve", "inflections"], "method direct has no settings, got 'alpha'")):
            done = self.run_batten("fit", "p.csv", "-o", "o.json", *more)
            self.assertEqual(done.returncode, 2, more)
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1)
        t = np.linspace(0, np.pi, 12)
        np.savetxt(self.folder / "p.csv", np.c_[np.cos(t), np.sin(t)], delimiter=",")
        done = self.run_batten("fit", "p.csv", "-o", "o.json", "-m", "pia", "--preserve", "convexity", "--set", "alpha=0.5")
        self.assertEqual((done.returncode, "setting alpha: pia keeps convexity by one factor for all moves" in done.stderr), (2, True))


if __name__ == "__main__":
    unittest.main()
