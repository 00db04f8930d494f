"""What a fit to a tolerance says of itself, judged from the written file: distances, extents and noise by NumPy and SciPy."""
import json
import os
import pathlib
import re
import subprocess
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD, InFolder, shared, some

AIRFOILS = pathlib.Path(os.environ["BATTEN_ROOT"]).parent / "shared" / "data" / "airfoils"
# thin sections of few samples, on which searches at a tight tolerance go astray, and some ordinary ones
SECTIONS = ("bambino6", "goe165", "goe319", "clarkw", "dormoy", "naca651212", "raf33", "goe797", "e193gu", "naca2410")
FORMS = ((), ("--interpolate", "ends"), ("--closed",), ("--closed=C0",), ("-p", 1), ("-p", 2), ("-p", 5), ("-p", 7))
THROUGH = ("bambino6", "goe165", "goe319")  # that a tame curve through all samples exists for, not only one to 1e-4
STRAY = 0.03  # part of the samples' diagonal by which a tame curve may leave their box


def coordinates(file):
    rows = [line.split() for line in file.read_text(errors="replace").splitlines()]
    pairs = []
    for row in rows:
        try:
            pairs.append([float(x) for x in row])
        except ValueError:
            continue
    return np.array([p for p in pairs if len(p) == 2 and max(map(abs, p)) < 2])


def dense(spline, per_span=512):
    knots, degree = np.array(spline["knots"][0]), spline["degree"][0]
    breaks = np.unique(knots[degree:len(knots) - degree])
    t = np.concatenate([np.linspace(a, b, per_span, endpoint=False) for a, b in zip(breaks, breaks[1:])] + [breaks[-1:]])
    return BSpline(knots, np.array(spline["control_points"]), degree)(t)


def largest_distance(spline, points):
    """From each sample to the nearest segment of a dense polyline: right to a small part of the curve's own steps."""
    line = dense(spline)
    a, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along ** 2).sum(axis=1), 1e-300)
    worst = 0
    for p in points:
        part = np.clip(((p - a) * along).sum(axis=1) / square, 0, 1)
        worst = max(worst, np.sqrt((((a + part[:, None] * along) - p) ** 2).sum(axis=1).min()))
    return worst


def uneven_samples(rng, dim, count, turns):
    """Exact ones at random distances along a curve."""
    u = np.sort(rng.random(count) ** rng.integers(1, 4))
    return np.column_stack([u] + [np.sin((turns + 2 * k) * u + k) for k in range(dim - 1)])


class Truth(InFolder):
    def fit(self, points, *arguments):
        if not isinstance(points, pathlib.Path):
            np.save(self.folder / "p.npy", np.ascontiguousarray(points))
            points = self.folder / "p.npy"
        done = subprocess.run([BATTEN, "fit", points, *map(str, arguments), "-q", "-o", "o.json", "--summary", "s.json"], cwd=self.folder,
                              capture_output=True, text=True, timeout=GUARD)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        return json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text()), done.returncode

    def judge(self, points, tolerance, spline, summary, status):
        met = summary["termination"] == "tolerance_met"
        self.assertEqual(met, status == 0)
        self.assertEqual(met, summary["verdict"].split(",")[0].split(";")[0] == "met", summary["verdict"])
        size = np.linalg.norm(np.ptp(points, axis=0))
        distance = largest_distance(spline, points)
        self.assertLessEqual(distance, summary["max_deviation"] + 1e-5 * size)
        self.assertEqual(met, summary["max_deviation"] <= tolerance)
        unseen = max(1, 1e-4 * size / tolerance)  # what is allowed between samples of a tolerance too tight to see
        self.assertLessEqual(summary["between_samples"], 3 * unseen)
        if not met:  # the words say what was written
            count, deviation = re.search(r"fit found: (\d+) control points, largest deviation ([^,;]+)", summary["verdict"]).groups()
            repeated = spline["degree"][0] if summary["closed"][0] else 0
            self.assertEqual(int(count), spline["control_shape"][0] - repeated)
            self.assertAlmostEqual(float(deviation) / summary["max_deviation"], 1, 2)
        curve, room = dense(spline), STRAY * size + summary["max_deviation"]
        self.assertGreater((curve - points.min(axis=0) + room).min(), 0)
        self.assertGreater((points.max(axis=0) + room - curve).min(), 0)

    def test_the_closest_tame_curve_is_handed_out(self):
        shared(self, "airfoils")
        for name in some(SECTIONS):
            points = coordinates(AIRFOILS / f"{name}.dat")
            for form in FORMS:
                with self.subTest(section=name, form=form):
                    reached = []
                    for tolerance in (1e-3, 4e-4, 2e-4, 1e-4):
                        spline, summary, status = self.fit(AIRFOILS / f"{name}.dat", "--tolerance", tolerance, *form)
                        self.judge(points, tolerance, spline, summary, status)
                        self.assertNotIn("noise_level", summary)  # too few samples to tell noise from shape
                        # a tighter wish never brings a curve much farther away than a looser one did
                        self.assertLessEqual(summary["max_deviation"], 2 * max([tolerance, *reached[-1:]]))
                        reached.append(summary["max_deviation"])
                        if name in THROUGH and form in ((), ("--interpolate", "ends")):
                            self.assertEqual(status, 0, summary["verdict"])

    def test_a_tighter_tolerance_brings_no_farther_curve(self):
        shared(self, "airfoils")
        for name, form in (("dormoy", ["--interpolate", "ends"]), ("goe319", []), ("bambino6", ["--closed=C0"]), ("fx2", ["--closed=C0"])):
            reached = []
            for tolerance in (1e-4, 3.16e-5, 1e-5, 3.16e-6, 1e-6):
                spline, summary, status = self.fit(AIRFOILS / f"{name}.dat", "--tolerance", tolerance, *form)
                self.judge(coordinates(AIRFOILS / f"{name}.dat"), tolerance, spline, summary, status)
                reached.append(summary["max_deviation"])
                with self.subTest(section=name, form=form, tolerance=tolerance):
                    self.assertEqual(status, 0, summary["verdict"])

    def test_a_closed_curve_of_a_stated_size_is_the_same_reversed_about_its_first_sample(self):
        rng = np.random.default_rng(1)
        for count, size, degree in ((16, 7, 3), (16, 8, 1), (16, 16, 2), (16, 16, 3), (31, 12, 4), (50, 20, 5), (40, 39, 3)):
            angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
            points = np.column_stack([np.cos(angle), 0.6 * np.sin(angle)]) + 0.1 * rng.normal(size=(count, 2))
            reverse = np.roll(points[::-1], 1, axis=0)
            with self.subTest(count=count, size=size, degree=degree):
                a, b = (self.fit(q, "-n", size, "-p", degree, "--closed")[1] for q in (points, reverse))
                self.assertLess(abs(a["max_deviation"] / b["max_deviation"] - 1) if size < count else a["max_deviation"], 1e-8)

    def test_a_seam_is_drawn_right_at_both_ends_by_any_evaluator(self):
        angle = np.linspace(0, 6 * np.pi, 30, endpoint=False)
        for run in (1, -1):
            points = np.column_stack([np.cos(angle), np.sin(angle), angle / 20])[::run]
            for degree, seam in ((3, 0), (4, 0), (4, 1), (5, 2)):
                spline = self.fit(points, "--tolerance", 0.03, "-p", degree, f"--closed=C{seam}")[0]
                knots, control = np.array(spline["knots"][0]), np.array(spline["control_points"])
                curve = BSpline(knots, control, degree)
                begin, end = knots[degree], knots[len(control)]
                with self.subTest(degree=degree, seam=seam, run=run):
                    self.assertLess(np.abs(curve(begin) - curve(end)).max(), 1e-9)
                    self.assertLess(np.abs(curve(end) - curve(end - 1e-12)).max(), 1e-9)
                    self.assertLess(np.abs(curve(begin) - curve(begin + 1e-12)).max(), 1e-9)

    def test_no_more_control_points_than_are_allowed(self):
        for seed in some(range(30)):
            rng = np.random.default_rng(seed)
            t = np.linspace(0, 1, int(rng.integers(30, 120)))
            f = rng.uniform(2, 12)
            points = np.column_stack([np.cos(f * t), np.sin(1.3 * f * t + 1)]) + 0.003 * rng.normal(size=(t.size, 2))
            tolerance = 10 ** rng.uniform(-2.5, -1)
            free = self.fit(points, "--tolerance", tolerance)[0]["control_shape"][0]
            for limit in {max(4, free - 2), free, free + 1, t.size}:
                with self.subTest(seed=seed, limit=limit):
                    spline, summary, status = self.fit(points, "--tolerance", tolerance, "--max-control-points", limit)
                    self.assertLessEqual(spline["control_shape"][0], limit, summary["verdict"])
                    self.assertEqual(status == 0, summary["max_deviation"] <= tolerance, summary["verdict"])

    def test_where_every_thin_curve_is_wild_a_calmer_one_is_handed_out(self):
        t = np.linspace(0, 1, 12)
        points = np.c_[t, 0.2 * np.abs((4 * t) % 1 - 0.5)]
        for seam, more in ((1, []), (1, ["--tolerance", 1e-4]), (2, []), (0, [])):
            with self.subTest(seam=seam, more=more):
                spline, summary, status = self.fit(points, "--degree", 5, f"--closed=C{seam}", *more)
                curve = dense(spline)
                self.assertIn(status, (0, 4))
                self.assertLess(np.abs(curve - points.mean(axis=0)).max(), 2 * np.ptp(points, axis=0).max())

    def test_noise_is_known_from_an_adequate_fit_or_not_at_all(self):
        rng = np.random.default_rng(5)
        for count, noise in ((200, 0.02), (400, 0.001), (3000, 0.01)):
            t = np.linspace(0, 1, count)
            clean = np.column_stack([10 * t, np.sin(6 * t)])
            spoiled = clean + np.column_stack([np.zeros(count), rng.normal(0, noise, count)])
            spline, summary, status = self.fit(spoiled, "--tolerance", noise / 5)
            self.judge(spoiled, noise / 5, spline, summary, status)
            self.assertLess(abs(summary["noise_level"] / noise - 1), 0.15)
            self.assertIn("noise level", summary["verdict"])
            if status == 4:  # else the tolerance stated is met, noise and all: so few samples leave room
                self.assertLess(spline["control_shape"][0], 20)  # it follows the curve, not the noise
            self.assertTrue(status == 4 or count == 200, (count, status))
        walk = np.cumsum(rng.normal(size=(300, 2)), axis=0)  # no part of it is noise
        spline, summary, status = self.fit(walk, "--tolerance", 0.01)
        self.judge(walk, 0.01, spline, summary, status)  # a curve through all of them is allowed where it is tame
        self.assertNotIn("noise_level", summary)
        self.assertIn("noise level is unknown", summary["verdict"])

    def test_exact_samples_have_no_noise_however_few_or_repeated(self):
        for count, turns in ((18, 15), (20, 20), (22, 20), (24, 20)):
            t = np.linspace(0, 1, count)
            for tolerance in (2e-3, 2e-4):
                spline, summary, status = self.fit(np.column_stack([t, np.sin(turns * t)]), "--tolerance", tolerance)
                self.assertNotIn("noise_level", summary, (count, turns, tolerance))
        t = np.linspace(0, 1, 1000)
        once = np.column_stack([t, np.cos(6 * t)])
        spline, summary, status = self.fit(np.repeat(once, 2, axis=0), "--tolerance", 2.236e-4)
        self.assertEqual(status, 0, summary["verdict"])
        self.assertNotIn("noise_level", summary)

    def test_uneven_distances_are_no_noise(self):
        for seed in some(range(24)):
            rng = np.random.default_rng(seed)
            count = int(rng.choice([16, 20, 33, 60, 130, 500, 1500, 5000]))
            points = uneven_samples(rng, int(rng.integers(1, 5)), count, rng.uniform(1, 20))
            tolerance = 10 ** rng.uniform(-5, -2)
            with self.subTest(seed=seed, count=count):
                spline, summary, status = self.fit(points, "--tolerance", tolerance)
                self.assertLess(summary.get("noise_level", 0), tolerance / 3, summary["verdict"])
                if count > 200:  # enough to draw every turn with
                    self.assertEqual(status, 0, summary["verdict"])
                    thinned = points[::50]  # a dense search takes long
                    self.assertLess(largest_distance(spline, thinned), tolerance * (1 + 1e-6))

    def test_noise_on_uneven_samples_is_told_to_a_tenth(self):
        for seed in some(range(8)):
            rng = np.random.default_rng(100 + seed)
            dim = int(rng.integers(2, 5))
            noise = 10 ** rng.uniform(-3, -2)
            points = uneven_samples(rng, dim, 2000, rng.uniform(2, 6))
            points += noise / np.sqrt(dim) * rng.normal(size=points.shape)
            with self.subTest(seed=seed, dim=dim, noise=noise):
                spline, summary, status = self.fit(points, "--tolerance", noise / 4)
                self.assertEqual(status, 4)
                self.assertLess(abs(summary["noise_level"] / noise - 1), 0.1)
                self.assertLess(spline["control_shape"][0], 40)  # a fiftieth of the samples: it does not follow them

    def test_a_kept_convexity_is_one_of_the_curve(self):
        t = np.linspace(0, 1, 80)
        corner = np.column_stack([t, np.abs(t - 0.5)])
        for degree in range(2, 7):
            for tolerance in (1e-2, 1e-3):
                spline, summary, status = self.fit(corner, "--tolerance", tolerance, "-p", degree, "--preserve", "convexity")
                self.assertIn(status, (0, 4))
                curve = BSpline(np.array(spline["knots"][0]), np.array(spline["control_points"]), degree)
                breaks = np.unique(spline["knots"][0])
                at = np.concatenate([np.linspace(a, b, 200)[1:-1] for a, b in zip(breaks, breaks[1:])])
                (x, y), (u, v) = curve(at, 1).T, curve(at, 2).T
                bend = (x * v - y * u) / (x * x + y * y) ** 1.5  # curvature; the chart is of size one
                self.assertFalse(bend.min() < -1e-3 and bend.max() > 1e-3, (degree, tolerance, bend.min(), bend.max()))

    def test_units_and_direction_do_not_count(self):
        rng = np.random.default_rng(7)
        t = np.sort(np.concatenate([[0, 1], rng.random(118)]))
        curve = np.column_stack([np.sin(3 * t), np.cos(5 * t), t ** 2])
        u, v = np.meshgrid(np.linspace(0, 1, 24), np.linspace(0, 1, 20), indexing="ij")
        grid = np.stack([u, v, np.sin(5 * u) * np.cos(4 * v)], axis=-1)
        for points, form in ((curve, ()), (curve, ("--closed",)), (curve, ("-p", 1)), (grid, ())):
            for tolerance in (1e-2, 1e-4):
                spline, _, status = self.fit(points, "--tolerance", repr(tolerance), *form)
                control, count = np.array(spline["control_points"]), np.array(spline["control_shape"])
                for power in (-60, -7, 60):
                    other, _, again = self.fit(points * 2.0 ** power, "--tolerance", repr(tolerance * 2.0 ** power), *form)
                    self.assertEqual(again, status)
                    self.assertTrue(np.array_equal(np.array(other["control_points"]), control * 2.0 ** power), (form, tolerance, power))
                for factor in (1e-3, 25.4, 1e6):
                    other, _, again = self.fit(points * factor, "--tolerance", repr(tolerance * factor), *form)
                    self.assertEqual(again, status, (form, tolerance, factor))
                    self.assertLessEqual(abs(np.array(other["control_shape"]) - count).max(), 2, (form, tolerance, factor))
        for points, tolerance in ((curve, 1e-2), (curve, 1e-4), (curve, 1e-6)):
            spline, summary, status = self.fit(points, "--tolerance", tolerance)
            other, turned, again = self.fit(points[::-1], "--tolerance", tolerance)
            self.assertEqual((again, other["control_shape"]), (status, spline["control_shape"]))
            self.assertLess(abs(np.array(other["control_points"])[::-1] - np.array(spline["control_points"])).max(), 1e-9)
        spline, _, status = self.fit(grid, "--tolerance", 1e-3)
        for flipped in (grid[::-1], grid[:, ::-1]):
            other, _, again = self.fit(flipped, "--tolerance", 1e-3)
            self.assertEqual(again, status)
            self.assertLessEqual(abs(np.array(other["control_shape"]) - spline["control_shape"]).max(), 2)

    def test_every_sample_has_its_own_tolerance_and_weight(self):
        t = np.linspace(0, 1, 200)
        curve = np.column_stack([t, np.sin(20 * t)])
        u, v = np.meshgrid(np.linspace(0, 1, 30), np.linspace(0, 1, 25), indexing="ij")
        grid = np.stack([u, v, np.sin(5 * u) * np.cos(4 * v)], axis=-1)
        for points in (curve, grid):
            flat = points.reshape(-1, points.shape[-1])
            own = np.where(flat[:, 0] < 0.5, 0.2, 1e-3)
            np.savetxt(self.folder / "t.txt", own)
            spline, summary, status = self.fit(points, "--tolerances", "t.txt")
            tight, _, _ = self.fit(points, "--tolerance", 1e-3)
            self.assertEqual((status, summary["tolerance"]), (0, 1e-3))
            self.assertLessEqual(np.prod(spline["control_shape"]), np.prod(tight["control_shape"]))
            if points is curve:
                self.assertLess(spline["control_shape"][0], tight["control_shape"][0])
                self.assertLessEqual(largest_distance(spline, flat[own == 1e-3]), 1e-3 + 1e-6)
            np.savetxt(self.folder / "w.txt", np.where(flat[:, 0] < 0.5, 100.0, 1.0))
            noisy = points + np.random.default_rng(1).normal(0, 0.01, points.shape) * np.array([0] * (points.shape[-1] - 1) + [1])
            plain, _, _ = self.fit(noisy, "--tolerance", 0.05)
            weighted, _, status = self.fit(noisy, "--tolerance", 0.05, "--weights", "w.txt")
            self.assertEqual(status, 0)
            self.assertNotEqual(plain["control_points"], weighted["control_points"])


if __name__ == "__main__":
    unittest.main()
