"""EPIA [LinZhang2011] beside its formulas in NumPy on dense matrices: where it starts, what moves, when knots come, how it ends."""
import json
import re
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import InFolder, chord, control_points, evaluate, shared


def design(knots, degree, at):
    return BSpline.design_matrix(at, np.array(knots), degree).toarray()


def averaged(own, degree=3):
    """Eq. 38."""
    inner = [np.mean(own[k:k + degree]) for k in range(1, len(own) - degree)]
    return np.r_[[own[0]] * (degree + 1), inner, [own[-1]] * (degree + 1)]


def curvature(points):
    """Eq. 29, without smoothing."""
    first, second = (points[2:] - points[:-2]) / 2, points[2:] - 2 * points[1:-1] + points[:-2]
    square = (first ** 2).sum(axis=1)
    area = square * (second ** 2).sum(axis=1) - (first * second).sum(axis=1) ** 2
    k = np.sqrt(np.maximum(area, 0)) / square ** 1.5
    return np.r_[k[0], k, k[-1]]


def fence(own, k, t):
    """Eq. 44: the first sample of every group."""
    begin = [0]
    for s, e in zip(own[:-1], own[1:]):
        bent = (k[s:e] - k[s:e + 1].min()) / (np.ptp(k[s:e + 1]) or 1)
        terms = np.exp(bent) * (t[s:e] - t[s]) / (t[e] - t[s])
        halves = [abs(terms[:w].sum() - terms[w:].sum()) for w in range(1, e - s)]
        begin.append(s + 1 + int(np.argmin(halves)) if halves else e)
    return np.array(begin)


def wave(m, seed=3):
    """A smooth curve sampled unevenly."""
    t = np.sort(np.r_[0, 1, np.random.default_rng(seed).random(m - 2)])
    return np.c_[t + 0.1 * np.sin(5 * t), np.cos(4 * t) + 0.2 * np.sin(9 * t)]


def turned(points, angle):
    return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def hills(m, n, seed=5, roughness=1.1):
    """Heights whose spectrum falls by a power of the frequency, as those of terrain do: detail at every scale, no noise."""
    f = np.hypot(*np.meshgrid(np.fft.fftfreq(m), np.fft.fftfreq(n), indexing="ij"))
    f[0, 0] = np.inf
    random = np.random.default_rng(seed)
    z = np.fft.ifft2(random.normal(size=(m, n)) * np.exp(2j * np.pi * random.random((m, n))) / f ** (1 + roughness)).real
    return 200 * (z - z.min()) / np.ptp(z)


class Epia(InFolder):
    def save(self, points, name="points"):
        if points.ndim == 2:
            np.savetxt(self.folder / f"{name}.csv", points, delimiter=",", fmt="%.17g")
            return f"{name}.csv"
        np.save(self.folder / f"{name}.npy", points)
        return f"{name}.npy"

    def fit(self, points, *options, status=(0, 4)):
        """The spline and the report."""
        name = points if isinstance(points, str) else self.save(points)
        done = self.run_batten("fit", name, "-m", "epia", "-q", "-o", "s.json", "--summary", "r.json", *options)
        self.assertIn(done.returncode, status if isinstance(status, tuple) else (status,), done.stderr)
        return json.loads((self.folder / "s.json").read_text()), json.loads((self.folder / "r.json").read_text())

    def own(self, points, spline):
        """Which samples the control points of a fit that made no step are."""
        away = np.linalg.norm(control_points(spline)[:, None] - points[None], axis=-1)
        self.assertLess(away.min(axis=1).max(), 1e-12)
        return away.argmin(axis=1)


class Start(Epia):
    def test_the_validation_check_goes_on_until_it_holds(self):
        for eta in (0.6, 0.9):
            points = wave(160)
            asked = ["--stop-deviation", 1e-4, "--max-iterations", 0, "--set", f"eta={eta}", "--set", "smoothing=0", "--set", "screen=0"]
            spline, report = self.fit(points, *asked)
            self.assertFalse([note for note in report["notes"] if "(47)" in note])
            self.assertGreater(report["settings"]["rounds_made"], 2)
            own, t = self.own(points, spline), chord(points)
            np.testing.assert_allclose(spline["knots"][0], averaged(t[own]), atol=1e-14)
            residual = points - design(spline["knots"][0], 3, t) @ points[own]
            begin = fence(own, curvature(points), t)
            summed = np.linalg.norm(np.add.reduceat(residual, begin), axis=1)
            lengths = np.add.reduceat(np.linalg.norm(residual, axis=1), begin)
            self.assertTrue(((summed > eta * lengths) | (lengths < 1e-13)).all())
            _, report = self.fit(points, *asked, "--set", "rounds=1")
            self.assertRegex(" ".join(report["notes"]), r"\d+ groups fail the validation check \(47\) after 1 rounds, the most allowed")

    def test_straight_data_start_with_few_points_whatever_their_rotation(self):
        x = np.linspace(0, 10, 100) ** 1.1
        for angle in np.linspace(0, 3, 13):
            _, report = self.fit(turned(np.c_[x, 0 * x], angle) + 100, "--stop-deviation", 1e-9, "--max-iterations", 0)
            self.assertEqual(report["control_shape"], [4], angle)
        u, v = np.meshgrid(np.linspace(0, 7, 30), np.linspace(0, 5, 40), indexing="ij")
        _, report = self.fit(np.stack([u - 0.3 * v, 0.7 * u + v, u + 2 * v], -1), "--stop-deviation", 1e-9, "--max-iterations", 0)
        self.assertEqual(report["control_shape"], [4, 4])

    def test_maxima_of_the_curvature_that_noise_makes_are_screened(self):
        a = np.linspace(0, 2 * np.pi, 600)
        exact = np.c_[2 * np.cos(a), np.sin(a)]
        noisy = exact + 1e-3 * np.random.default_rng(1).normal(size=exact.shape)
        asked = ["--stop-deviation", 0.01]
        _, clean = self.fit(exact, *asked)
        _, screened = self.fit(noisy, *asked, status=0)
        _, every = self.fit(noisy, *asked, "--set", "screen=0", "--set", "rounds=0", status=0)
        self.assertLess(screened["control_shape"][0], 2 * clean["control_shape"][0])
        self.assertGreater(every["control_shape"][0], 3 * screened["control_shape"][0])

    def test_patches_start_small_and_noise_is_told_apart_from_detail(self):
        u, v = np.meshgrid(np.arange(60.0), np.arange(70.0), indexing="ij")
        noise = np.random.default_rng(2).normal(size=u.shape)
        bumps = lambda size: 30 * np.sin(u / size) * np.cos(v / (size + 1)) + noise
        for name, heights, words in (("hills", hills(60, 70), "(47); to split them would take more control points than an eighth of the samples, which show detail, not noise"),
                                     ("noise", bumps(3), "(47); to split them would take more control points than an eighth of the samples, which are noisy by"),
                                     ("noise on little", bumps(10), "epia started with")):
            asked = ["--stop-deviation", 1, "--max-iterations", 0]
            grid = np.stack([u, v, heights], -1)
            _, report = self.fit(grid, *asked)
            _, every = self.fit(grid, *asked, "--set", "screen=0")
            self.assertGreater(np.prod(every["control_shape"]), 0.4 * u.size, name)
            self.assertLess(np.prod(report["control_shape"]), 0.15 * u.size, name)
            notes = " ".join(report["notes"])
            self.assertIn(words, notes, name)

    def test_terrain_starts_small(self):
        heights = np.load(shared(self, "terrain344x403.npy"))
        np.save(self.folder / "t.npy", heights)
        _, report = self.fit("t.npy", "--heights", "--stop-deviation", 20, "--max-iterations", 0)
        self.assertLess(np.prod(report["control_shape"]), 0.13 * heights.size)


class Interpolated(Epia):
    def test_with_a_control_point_for_every_sample_it_goes_on_to_interpolation(self):
        points = wave(30)
        spline, report = self.fit(points, "--stop-deviation", 1e-11, "--max-iterations", 100000, "--set", "exact=0", status=0)
        self.assertEqual((report["termination"], report["control_shape"]), ("tolerance_met", [30]))
        t = chord(points)
        knots = averaged(t)
        np.testing.assert_allclose(spline["knots"][0], knots, atol=1e-14)
        limit = np.linalg.solve(design(knots, 3, t), points)
        np.testing.assert_allclose(control_points(spline), limit, atol=1e-8)
        u, v = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 8), indexing="ij")
        grid = np.stack([u, v, np.sin(5 * u) * v ** 2], -1)
        _, report = self.fit(grid, "--stop-deviation", 1e-11, "--max-iterations", 100000, status=0)
        self.assertEqual((report["termination"], report["control_shape"]), ("tolerance_met", [9, 8]))

    def test_a_due_insertion_is_not_lost_to_a_stall(self):
        """Moves that vanish before e_c is below a tiny t_c."""
        points = wave(60)
        _, report = self.fit(points, "--stop-deviation", 1e-5, "--max-iterations", 1000000, "--set", "t_c=1e-300", "--set", "exact=1", status=0)
        self.assertEqual(report["termination"], "tolerance_met")
        self.assertGreater(report["settings"]["insertions"], 1)

    def test_neighbours_with_a_gap_are_each_alone(self):
        """The first move of an interpolated sample's control point is that sample's own residual [eq. 8 and 9]."""
        points = wave(120)
        t = chord(points)
        for held in ([50, 52], [50, 57], [0, 2, 4], [117, 119]):
            asked = ["-n", 30, "--interpolate", ",".join(map(str, held))]
            before, _ = self.fit(points, *asked, "--max-iterations", 0)
            after, _ = self.fit(points, *asked, "--max-iterations", 1)
            own = list(self.own(points, before))
            moved = control_points(after) - control_points(before)
            residual = points - evaluate(before, t)
            for j in held:
                np.testing.assert_allclose(moved[own.index(j)], residual[j], atol=1e-13)
            self.assertTrue([j for j in own if held[0] < j < held[1]])
            _, report = self.fit(points, *asked, "--max-iterations", 20000, status=0)
            self.assertLess(report["constraint_error"], 1e-9)


class Precision(Epia):
    def test_each_sample_has_its_own(self):
        points = wave(300)
        tight = np.arange(300) < 60
        own = np.where(tight, 1e-4, 1e-2)
        np.savetxt(self.folder / "own.txt", own)
        asked = ["--max-iterations", 20000]
        spline, report = self.fit(points, "--tolerances", "own.txt", *asked, status=0)
        t = chord(points)
        away = np.linalg.norm(evaluate(spline, t) - points, axis=1)
        self.assertTrue((away <= own * (1 + 1e-9)).all())
        self.assertEqual((report["termination"], report["tolerance"]), ("tolerance_met", 1e-4))
        self.assertEqual(report["verdict"], "met at the samples' own parameters")
        self.assertGreater(away.max(), 1e-3)
        _, all_tight = self.fit(points, "--tolerance", 1e-4, *asked, status=0)
        self.assertLess(report["control_shape"][0], all_tight["control_shape"][0])
        _, short = self.fit(points, "--tolerances", "own.txt", "--max-iterations", 3, status=4)
        self.assertEqual(short["verdict"], "not met: iteration_limit after 3 iterations")

    def test_no_precision_ends_it_before_interpolated_samples_are_hit(self):
        points = wave(300) + 0.002 * np.random.default_rng(3).normal(size=(300, 2))
        for exact, precision in (("20", 0.03), ("100,101,150", 0.02), ("20,21,200", 0.01)):
            for how in ("--tolerance", "--stop-deviation"):
                spline, report = self.fit(points, how, precision, "--interpolate", exact, status=0)
                away = np.linalg.norm(evaluate(spline, chord(points)) - points, axis=1)
                self.assertLess(away[[int(i) for i in exact.split(",")]].max(), 1e-9 * np.ptp(points, axis=0).max() * 2)
                self.assertLess(away.max(), precision)
                self.assertLess(report["control_shape"][0], 100)  # while it waits no knot comes

    def test_a_stated_number_is_never_exceeded_and_43_samples_take_13_control_points(self):
        points = wave(43)
        for n in (4, 7, 13, 20):
            _, report = self.fit(points, "-n", n, "--max-iterations", 4000, "--stop-deviation", 1e-9)
            self.assertEqual(report["control_shape"], [n])
        before, start = self.fit(points, "-n", 13, "--interpolate", 21, "--max-iterations", 0)
        after, report = self.fit(points, "-n", 13, "--interpolate", 21, "--max-iterations", 60)
        self.assertEqual((start["control_shape"], report["control_shape"]), ([13], [13]))
        self.assertGreater(start["constraint_error"], 13 * report["constraint_error"])  # Fig. 2: 0.1265 to 0.0097

    def test_own_control_points_to_start_from(self):
        points = wave(80)
        first = points[::8] + 0.3
        np.savetxt(self.folder / "p.txt", first, fmt="%.17g")
        spline, _ = self.fit(points, "--initial", "p.txt", "--max-iterations", 0)
        np.testing.assert_array_equal(control_points(spline), first)
        _, report = self.fit(points, "--initial", "p.txt", "--stop-deviation", 1e-3, status=0)
        self.assertGreater(report["control_shape"][0], 10)

    def test_only_some_move(self):
        """The means of the groups of those that move vanish [eq. 17], the others stay."""
        points, t = wave(90), chord(wave(90))
        asked = ["-n", 30, "--set", "screen=0", "--set", "smoothing=0", "--set", "rounds=0", "--moving", "3,4,9"]
        before, _ = self.fit(points, *asked, "--max-iterations", 0)
        after, report = self.fit(points, *asked, "--max-iterations", 5000, "--stop-relative-gradient", 1e-12)
        own = self.own(points, before)
        moved = np.linalg.norm(control_points(after) - control_points(before), axis=1) > 0
        self.assertEqual(list(np.flatnonzero(moved)), [3, 4, 9])
        begin = fence(own, curvature(points), t)
        means = np.add.reduceat(points - evaluate(after, t), begin) / np.diff(np.r_[begin, 90])[:, None]
        self.assertLess(np.abs(means[[3, 4, 9]]).max(), 1e-12)
        self.assertEqual(report["settings"]["insertions"], 0)
        done = self.run_batten("fit", "points.csv", "-m", "epia", "-n", 9, "--moving", "9")
        self.assertEqual((done.returncode, done.stderr), (2, "batten: moving: control point 9 is outside 0 to 8\n"))

    def test_refusals(self):
        points, first = wave(30), wave(30)[::3]
        np.savetxt(self.folder / "p.txt", first, fmt="%.17g")
        self.save(points)
        for words, *asked in (("state where to stop: a stop deviation, a tolerance or a number of control points",),
                              ("axis 0: 10 control points given to start from, the samples to interpolate need 13", "--initial", "p.txt", "--interpolate",
                               "1,3,5,7,9,11"),):
            done = self.run_batten("fit", "points.csv", "-m", "epia", *asked)
            self.assertEqual((done.returncode, done.stderr), (2, f"batten: epia: {words}\n"))
        np.save(self.folder / "g.npy", np.stack(np.meshgrid(np.arange(6.0), np.arange(7.0), [0.0], indexing="ij"), -1)[:, :, 0])
        np.savetxt(self.folder / "q.txt", np.zeros((16, 3)))
        done = self.run_batten("fit", "g.npy", "-m", "epia", "--initial", "q.txt")
        self.assertEqual((done.returncode, done.stderr), (2, "batten: epia: control points to start from need their numbers along the axes\n"))

    def test_weights_weigh_the_mean_of_a_group(self):
        points, t = wave(120), chord(wave(120))
        weights = np.random.default_rng(1).uniform(0.1, 4, 120)
        np.savetxt(self.folder / "w.txt", weights, fmt="%.17g")
        asked = ["--weights", "w.txt", "--stop-deviation", 1e-9, "--set", "screen=0", "--set", "smoothing=0", "--set", "rounds=0"]
        before, _ = self.fit(points, *asked, "--max-iterations", 0)
        after, _ = self.fit(points, *asked, "--max-iterations", 1)
        own = self.own(points, before)
        begin = fence(own, curvature(points), t)
        residual = points - evaluate(before, t)
        means = np.add.reduceat(weights[:, None] * residual, begin) / np.add.reduceat(weights, begin)[:, None]
        np.testing.assert_allclose(control_points(after) - control_points(before), means, atol=1e-13)

    def test_history_and_report_are_of_the_whole_run(self):
        _, report = self.fit(wave(200), "--stop-deviation", 1e-3, "--history", status=0)
        history = report["history"]
        counts = [entry["control_points"] for entry in history]
        self.assertEqual(counts[-1], report["control_shape"][0])
        self.assertEqual(counts, sorted(counts))
        self.assertEqual(counts[-1] - counts[0], report["settings"]["insertions"])
        self.assertEqual([entry["iteration"] for entry in history], list(range(report["iterations"] + 1)))
        self.assertEqual(history[0]["gradient_norm"], report["first_gradient_norm"])
        self.assertEqual(history[-1]["gradient_norm"], report["gradient_norm"])
        norms = [entry["gradient_norm"] for entry in history]
        half = len(norms) // 2
        self.assertAlmostEqual(report["observed_rate"], (norms[-1] / norms[half]) ** (1 / (len(norms) - 1 - half)), 12)
        for entry, following in zip(history, history[1:]):
            if entry["control_points"] == following["control_points"]:
                self.assertAlmostEqual(entry["largest_mean"], following["largest_move"], 14)
        for name in ("eta", "t_c", "rounds", "insertions"):
            self.assertIn(name, report["settings"])


class Surfaces(Epia):
    def cloud(self, m=1500):
        uv = np.random.default_rng(4).random((m, 2))
        np.savetxt(self.folder / "uv.txt", uv, fmt="%.17g")
        return uv, np.c_[uv, np.sin(5 * uv[:, 0]) * np.cos(4 * uv[:, 1])]

    def test_samples_of_patches_are_interpolated(self):
        u, v = np.meshgrid(np.linspace(0, 3, 31), np.linspace(0, 4, 41), indexing="ij")
        grid = np.stack([u, v, np.sin(2 * u) * np.cos(v)], -1)
        held = [5 * 41 + 7, 5 * 41 + 9, 20 * 41 + 33]
        asked = ["--interpolate", ",".join(map(str, held)), "-n", "18x20", "--max-iterations", 20000]
        spline, report = self.fit(grid, *asked, status=0)
        self.assertLess(report["constraint_error"], 1e-8)
        self.assertTrue(all(np.array(report["control_shape"]) <= [18, 20]))

    def test_clouds_grow(self):
        uv, points = self.cloud()
        spline, report = self.fit(points, "--parameters", "uv.txt", "--stop-deviation", 0.005, "--max-iterations", 20000, status=0)
        ku, kv = (np.array(k) for k in spline["knots"])
        net = control_points(spline)
        away = np.linalg.norm(np.einsum("ma,mb,abd->md", design(ku, 3, uv[:, 0]), design(kv, 3, uv[:, 1]), net) - points, axis=1)
        self.assertLessEqual(away.max(), 0.005 * (1 + 1e-9))
        self.assertGreater(report["settings"]["insertions"], 0)
        self.assertLess(np.prod(report["control_shape"]), 400)
        for k in (ku, kv):  # halves of halves of the whole
            parts = (k - k[0]) / (k[-1] - k[0]) * 2 ** 20
            np.testing.assert_allclose(parts, parts.round(), atol=1e-6)

    def test_samples_of_clouds_are_interpolated(self):
        uv, points = self.cloud(500)
        held = [3, 99, 250]
        asked = ["--parameters", "uv.txt", "-n", "9x8", "--interpolate", ",".join(map(str, held))]
        before, _ = self.fit(points, *asked, "--max-iterations", 0)
        after, _ = self.fit(points, *asked, "--max-iterations", 1)
        _, report = self.fit(points, *asked, "--max-iterations", 20000, "--stop-relative-gradient", 1e-12, status=0)
        self.assertLess(report["constraint_error"], 1e-9)
        net, ku, kv = control_points(before), *(np.array(k) for k in before["knots"])
        gu, gv = (np.array([k[i + 1:i + 4].mean() for i in range(n)]) for k, n in ((ku, 9), (kv, 8)))
        moved = (control_points(after) - net).reshape(-1, 3)
        residual = points - np.einsum("ma,mb,abd->md", design(ku, 3, uv[:, 0]), design(kv, 3, uv[:, 1]), net)
        for j in held:  # the nearest control point follows this sample alone
            own = 8 * np.abs(gu - uv[j, 0]).argmin() + np.abs(gv - uv[j, 1]).argmin()
            np.testing.assert_allclose(moved[own], residual[j], atol=1e-13)


class Reproduced(Epia):
    def test_the_papers_tables(self):
        """The counts that Table 1 prints for 50 and 70 iterations; pictures of every step with its own control points."""
        data = shared(self, "glyph273.csv").parent
        done = self.run_batten("reproduce", "epia", "--data", data, "--folder", "f")
        self.assertEqual(done.returncode, 0, done.stderr)
        table = done.stdout.split("Table 1 and Fig. 3, eta 0.6")[1]
        count = lambda after: re.search(f"control points after {after} iterations +([0-9]+) +([0-9]+)", table).groups()
        self.assertEqual([count(50), count(70)], [("59", "59"), ("66", "66")])
        for step in (0, 15, 50, 70):
            picture = (self.folder / "f" / f"epia_letter_0.6_step{step}.svg").read_text()
            before = int(count(step)[1]) - picture.count("<circle")
            self.assertIn(before, (0, 1), step)  # the picture is before a knot that comes then
        fig_2 = done.stdout.split("Figure 2")[1]
        self.assertEqual(re.search("control points +([0-9]+) +([0-9]+)", fig_2).groups(), ("13", "13"))
        self.assertRegex(done.stdout, r"\[27\]: control points along u, start +20 +20 .*\n.*along v, start +31 +31 ")
        for name in ("epia_start", "epia_100", "columns_start", "columns_100"):
            self.assertIn("<svg", (self.folder / "f" / f"epia_fig6_{name}.svg").read_text())
        self.assertEqual(self.run_batten("reproduce", "epia", "--folder", "g").returncode, 0)


if __name__ == "__main__":
    unittest.main()
