"""Fits to a tolerance on real data: counts against the peers' (measured: FITPACK, Open CASCADE, SISL), distances by SciPy from the written file."""
import json
import math
import subprocess
import unittest

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import minimize_scalar

from judge import BATTEN, GUARD, InFolder, airfoils, chord, control_points, curve, distances, evaluate, largest_distance, shared, some, surface_distances

# control points of the best peer that truly kept T = 1e-2, 1e-3, 1e-4
PEERS = {"profile205.csv": (27, 60, 149), "glyph273.csv": (40, 109, 161), "glyph577.csv": (38, 98, 171),
         "rose": (28, 43, 76), "helix": (22, 35, 58), "naca2412": (9, 13, 22)}


class Tolerance(InFolder):
    def fit(self, points, *arguments, status=0):
        done = subprocess.run([BATTEN, "fit", str(points), *map(str, arguments), "-q", "-o", "o.json", "--summary", "s.json"], cwd=self.folder,
                              capture_output=True, text=True, timeout=GUARD)
        self.assertEqual(done.returncode, status, done.stderr)
        return json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text())

    def data(self, name):
        if name.endswith(".csv"):
            return shared(self, name), np.loadtxt(shared(self, name), delimiter=",", skiprows=1)
        path = self.folder / f"{name}.csv"
        subprocess.run([BATTEN, "generate", name, "-o", path], check=True)
        return path, np.loadtxt(path, delimiter=",")

    def test_no_more_control_points_than_any_peer(self):
        ratios = []
        for name, peers in PEERS.items():
            path, points = self.data(name)
            for tolerance, peer in zip((1e-2, 1e-3, 1e-4), peers):
                spline, summary = self.fit(path, "--tolerance", tolerance)
                self.assertLess(summary["between_samples"], 3)
                count = spline["control_shape"][0]
                self.assertLessEqual(count, peer, (name, tolerance))
                self.assertLessEqual(largest_distance(spline, points), tolerance * (1 + 1e-9), (name, tolerance))
                self.assertEqual(summary["termination"], "tolerance_met")
                if tolerance > 1e-4:
                    ratios.append(count / peer)
        self.assertLessEqual(math.exp(np.log(ratios).mean()), 0.75)

    def test_surfaces_take_fewer_poles(self):
        subprocess.run([BATTEN, "generate", "peaks", "-o", self.folder / "p.npy"], check=True)
        heights = np.load(self.folder / "p.npy")[..., 2]
        np.save(self.folder / "h.npy", heights)
        for tolerance, peer in ((0.1, 15 * 20), (0.01, 21 * 29), (0.001, 32 * 44)):
            spline, summary = self.fit(self.folder / "h.npy", "--heights", "--tolerance", tolerance)
            self.assertLessEqual(np.prod(spline["control_shape"]), 0.8 * peer, tolerance)
            z = np.array(spline["control_points"])[:, 2].reshape(spline["control_shape"])
            for axis in (0, 1):
                z = np.moveaxis(BSpline(np.array(spline["knots"][axis]), np.moveaxis(z, axis, 0), 3)(np.linspace(0, 1, 121)), 0, axis)
            self.assertLessEqual(abs(z - heights).max(), tolerance)

    def test_ends_hold_exactly_within_the_tolerance(self):
        path, points = self.data("profile205.csv")
        spline, summary = self.fit(path, "--tolerance", 1e-3, "--interpolate", "ends")
        size = np.linalg.norm(np.ptp(points, axis=0))
        self.assertLess(np.linalg.norm(np.array(spline["control_points"][0]) - points[0]), 1e-12 * size)
        self.assertLess(np.linalg.norm(np.array(spline["control_points"][-1]) - points[-1]), 1e-12 * size)
        self.assertLessEqual(largest_distance(spline, points), 1e-3)
        spline, summary = self.fit(path, "--tolerance", 1e-2, "--interpolate", "0,100,204")
        self.assertLess(largest_distance(spline, points[[0, 100, 204]]), 1e-12 * size)
        self.assertLess(summary["constraint_error"], 1e-12 * size)
        spline, _ = self.fit(path, "--tolerance", 1e-2)  # not held, it is missed
        self.assertGreater(largest_distance(spline, points[[0, 100, 204]]), 1e-6 * size)

    def derivative(self, spline, t, order=1):
        return curve(spline).derivative(order)(t)

    def closest_parameter(self, spline, point):
        t = np.linspace(0, 1, 20001)
        line = curve(spline)
        near = t[((line(t) - point) ** 2).sum(axis=1).argmin()]
        return minimize_scalar(lambda s: ((line(s) - point) ** 2).sum(), bounds=(max(0, near - 1e-4), min(1, near + 1e-4)), method="bounded", options={"xatol": 1e-15}).x

    def test_tangents_and_samples_hold_within_the_tolerance(self):
        path, points = self.data("profile205.csv")
        size = np.linalg.norm(np.ptp(points, axis=0))
        held = [0, 60, 100, 204]
        with open(self.folder / "t.csv", "w") as file:
            for i in held:
                x, y = points[min(i + 1, 204)] - points[max(i - 1, 0)]
                file.write(f"{i},{x!r},{y!r}\n")
        rows = np.loadtxt(self.folder / "t.csv", delimiter=",")
        spline, summary = self.fit(path, "--tolerance", 1e-3, "--tangents", "t.csv", "--interpolate", "0,60,100,204")
        self.assertLessEqual(largest_distance(spline, points), 1e-3 * (1 + 1e-9))
        self.assertLess(summary["constraint_error"], 1e-12 * size)
        self.assertLess(summary["tangent_error"], 1e-12)
        for i, direction in zip(held, rows[:, 1:]):
            t = {0: 0.0, 204: 1.0}.get(i) if i in (0, 204) else self.closest_parameter(spline, points[i])  # the sample is hit, so this is its parameter, to the search's rounding
            got = self.derivative(spline, t)
            self.assertGreater(got @ direction, 0)
            self.assertLess(abs(np.cross(got, direction)) / np.linalg.norm(got) / np.linalg.norm(direction), 1e-5)
        (self.folder / "d.csv").write_text("0,-2.5,0.5\n")  # the derivative itself, at the open end
        spline, summary = self.fit(path, "--tolerance", 1e-2, "--derivatives", "d.csv")
        self.assertLess(np.linalg.norm(self.derivative(spline, 0) - [-2.5, 0.5]), 1e-12 * size * 10)
        self.assertLessEqual(largest_distance(spline, points), 1e-2 * (1 + 1e-9))

    def test_tangents_keep_their_direction_on_every_airfoil(self):
        files = some(airfoils(self))
        judged = 0
        for file in files:
            report = json.loads(subprocess.run([BATTEN, "fit", file, "-n", "9", "-q", "--summary", "-"], capture_output=True, text=True).stdout)
            (self.folder / "t.csv").write_text(f"0,-1,0\n{report['samples'] - 1},1,0\n")
            done = subprocess.run([BATTEN, "fit", file, "--tolerance", "0.001", "--interpolate", "ends", "--tangents", "t.csv", "-q", "-o", "o.json", "--summary", "s.json"],
                                  cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
            if done.returncode == 2:  # the section runs the other way there
                self.assertRegex(done.stderr, "it points against the order of the samples; reverse its sign")
                continue
            self.assertIn(done.returncode, (0, 4), file.name)
            spline, summary = json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text())
            # the rounding of the control points alone, over the knot span at an end
            knots = np.array(spline["knots"][0])
            span = min(knots[4] - knots[3], knots[-4] - knots[-5])
            self.assertLess(summary["tangent_error"], 1e-12 + 1e-15 / span, file.name)
            self.assertLess(self.derivative(spline, 0)[0], 0, file.name)
            self.assertGreater(self.derivative(spline, 1)[0], 0, file.name)
            for end in (0, 1):
                slope = self.derivative(spline, end)
                self.assertLess(abs(slope[1]), 1e-9 * abs(slope[0]), file.name)
            judged += 1
        self.assertGreater(judged, 0.8 * len(files))

    def test_a_seam_is_as_smooth_as_asked(self):
        path, points = self.data("glyph577.csv")
        for form, order in (("--closed", 2), ("--closed=C1", 1), ("--closed=C0", 0)):
            spline, summary = self.fit(path, "--tolerance", 1e-2, form, "--corners", "none", "--interpolate", 0)
            self.assertLessEqual(largest_distance(spline, points), 1e-2 * (1 + 1e-9))
            for k in range(order + 1):
                a, b = (curve(spline).derivative(k)(x) if k else curve(spline)(x) for x in (0, 1))
                self.assertLess(np.linalg.norm(a - b), 1e-9 * max(1, np.linalg.norm(a)), (form, k))

    def test_a_seam_asked_to_be_smooth_is_no_corner(self):
        t = np.linspace(0, 2 * np.pi, 200, endpoint=False)
        drop = np.c_[np.cos(t), np.sin(t) * np.sin(t / 2)]  # sharp at its first sample
        np.savetxt(self.folder / "drop.csv", drop, delimiter=",", fmt="%.17g")
        turns = []
        for form in ("--closed=C0", "--closed=C1", "--closed=C2"):
            for size in (("--tolerance", 1e-3), ("-n", 20), ("-n", 20, "--smooth", 1e-7), ("--smooth", "auto")):
                spline, _ = self.fit("drop.csv", form, *size)
                first, last = (curve(spline)(x, nu=1) for x in (0, 1 - 1e-13))
                turns.append(np.linalg.norm(first - last) / np.linalg.norm(first))
        self.assertGreater(min(turns[:4]), 0.1)  # the drop is sharp there
        self.assertLess(max(turns[4:]), 1e-9)
        run = self.run_batten("fit", "drop.csv", "--closed=C1", "--tolerance", 1e-3, "--corners", "0")
        self.assertEqual((run.returncode, run.stderr), (2, "batten: corner 0: it is the seam, which is asked to be C1\n"))

    def test_each_sample_has_the_smaller_of_two_tolerances(self):
        t = np.linspace(0, 3, 200)
        points = np.c_[t, np.sin(5 * t)]
        own = np.where(t < 1.5, 0.001, 0.05)
        np.savetxt(self.folder / "w.csv", points, delimiter=",", fmt="%.17g")
        np.savetxt(self.folder / "own.csv", own)
        for more, allowed in (((), own), (("--tolerance", 0.01), np.minimum(own, 0.01)), (("--tolerance", 1e-4), np.full(200, 1e-4))):
            spline, summary = self.fit("w.csv", "--tolerances", "own.csv", *more)
            ratio = (distances(spline, points) / allowed).max()
            self.assertLessEqual(ratio, 1 + 1e-9)
            self.assertAlmostEqual(summary["tolerance_ratio"], ratio, delta=1e-6)
            self.assertEqual(summary["tolerance"], allowed.min())
            self.assertEqual(summary.get("largest_tolerance"), None if allowed.min() == allowed.max() else allowed.max())

    def test_boundaries_hold_within_the_tolerance(self):
        terrain = shared(self, "terrain344x403.npy")
        heights = np.load(terrain)[:80, :90]
        np.save(self.folder / "h.npy", heights)
        x, y = np.meshgrid(60.0 * np.arange(80), 60.0 * np.arange(90), indexing="ij")
        grid = np.stack([x, y, heights], axis=-1)
        np.savetxt(self.folder / "u0.csv", grid[0], delimiter=",", fmt="%.17g")
        np.savetxt(self.folder / "v1.csv", grid[:, -1], delimiter=",", fmt="%.17g")
        for name in ("u0", "v1"):
            self.fit(self.folder / f"{name}.csv", "--tolerance", 2, "--interpolate", "ends")
            (self.folder / "o.json").rename(self.folder / f"{name}.json")
        spline, summary = self.fit("h.npy", "--heights", "--spacing", "60,60", "--tolerance", 25, "--boundary", "u0=u0.json", "--boundary", "v1=v1.json")
        self.assertEqual(summary["boundaries"], 2)
        control = np.array(spline["control_points"]).reshape(*spline["control_shape"], 3)
        size = np.linalg.norm(np.ptp(grid.reshape(-1, 3), axis=0))
        for name, row, axis in (("u0", control[0], 1), ("v1", control[:, -1], 0)):
            given = json.loads((self.folder / f"{name}.json").read_text())
            t = np.linspace(0, 1, 997)
            ours = BSpline(np.array(spline["knots"][axis]), row, 3)(t)
            theirs = BSpline(np.array(given["knots"][0]), np.array(given["control_points"]), 3)(t)
            self.assertLess(abs(ours - theirs).max(), 1e-12 * size)

    def test_exact_samples_of_a_surface(self):
        subprocess.run([BATTEN, "generate", "peaks", "-o", self.folder / "p.npy"], check=True)
        points = np.load(self.folder / "p.npy")
        spline, summary = self.fit("p.npy", "--tolerance", 0.01, "--interpolate", "0,120,7381,14640")
        size, points = np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)), points.reshape(-1, 3)
        corners = evaluate(spline, np.array([0.0, 1]), np.array([0.0, 1])).reshape(-1, 3)
        self.assertLess(abs(corners[[0, 1, 3]] - points[[0, 120, 14640]]).max(), 1e-12 * size)
        edge = {"knots": spline["knots"][:1], "degree": spline["degree"][:1], "control_points": control_points(spline)[:, 0]}
        self.assertLess(largest_distance(edge, points[[7381]]), 1e-12 * size)  # row 61, column 0
        self.assertLess(summary["constraint_error"], 1e-12 * size)
        self.assertLessEqual(surface_distances(spline, points[::37]).max(), 0.01)
        self.assertLessEqual(summary["max_deviation"], 0.01)
        self.assertLessEqual(summary["between_samples"], 1)

    def test_kept_shape_on_the_control_polygon(self):
        def inflections(control, closed):
            edges = np.diff(np.concatenate([control, control[:2]]) if closed else control, axis=0)
            turns = np.sign(edges[:-1, 0] * edges[1:, 1] - edges[:-1, 1] * edges[1:, 0])
            turns = turns[turns != 0]
            return int((turns != np.roll(turns, 1)).sum() if closed else (turns[1:] != turns[:-1]).sum())

        for name, tolerance, shape in (("profile205.csv", 1e-3, "inflections"), ("glyph577.csv", 1e-2, "inflections"), ("naca2412", 1e-4, "convexity"), ("rose", 1e-3, "convexity")):
            path, points = self.data(name)
            spline, summary = self.fit(path, "--tolerance", tolerance, "--preserve", shape, "--interpolate", "ends")
            self.assertLessEqual(largest_distance(spline, points), tolerance * (1 + 1e-9))
            count = inflections(np.array(spline["control_points"]), False)
            self.assertEqual(count, summary["inflections"])
            self.assertLessEqual(count, summary["data_inflections"])
            if shape == "convexity":
                self.assertEqual(count, 0)
        path, _ = self.data("helix")
        done = subprocess.run([BATTEN, "fit", path, "--tolerance", "1e-3", "--preserve", "convexity"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (2, "batten: preserve: shape is kept for curves in the plane, not for a curve in dimension 3\n"))
        t = np.linspace(0, 1, 200)
        np.savetxt(self.folder / "wave.csv", np.stack([t, np.sin(9 * t)], axis=1), delimiter=",")
        done = subprocess.run([BATTEN, "fit", self.folder / "wave.csv", "--tolerance", "1e-3", "--preserve", "convexity"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (2, "batten: preserve convexity: the samples have 2 inflections larger than the tolerance 0.001\n"))

    def test_outliers_are_found_and_listed(self):
        t = np.linspace(0, 1, 400)
        points = np.stack([10 * t, np.sin(6 * t)], axis=1)
        spoiled = points.copy()
        spoiled[[90, 200, 333], 1] += [1, -2, 0.5]
        np.savetxt(self.folder / "s.csv", spoiled, delimiter=",", fmt="%.17g")
        spline, summary = self.fit("s.csv", "--tolerance", 1e-3, "--robust")
        self.assertEqual(summary["set_aside"], [90, 200, 333])
        self.assertEqual(summary["samples"], 400)
        self.assertLessEqual(largest_distance(spline, np.delete(points, [90, 200, 333], axis=0)), 1e-3)
        np.savetxt(self.folder / "c.csv", points, delimiter=",", fmt="%.17g")
        self.assertNotIn("set_aside", self.fit("c.csv", "--tolerance", 1e-3, "--robust")[1])
        rng = np.random.default_rng(5)
        place = rng.random((5000, 2)) * [100, 50]
        height = np.sin(place[:, 0] / 15) * np.cos(place[:, 1] / 9)
        height[[5, 77]] += 4
        np.savetxt(self.folder / "cloud.csv", np.column_stack([place, height]), delimiter=",", fmt="%.17g")
        summary = self.fit("cloud.csv", "--project", "xy", "--tolerance", 0.02, "--robust")[1]
        self.assertEqual(summary["set_aside"], [5, 77])
        subprocess.run([BATTEN, "generate", "peaks", "-o", self.folder / "p.npy"], check=True)
        grid = np.load(self.folder / "p.npy")
        grid[30, 40, 2] += 3
        np.save(self.folder / "p.npy", grid)
        summary = self.fit("p.npy", "--tolerance", 0.01, "--robust")[1]
        self.assertEqual(summary["set_aside"], [30 * 121 + 40])

    def test_smoothing_finds_the_noise_and_knows_no_scale(self):
        rng = np.random.default_rng(3)
        t = np.linspace(0, 1, 400)
        clean = np.stack([10 * t, np.sin(6 * t)], axis=1)
        noisy = clean + np.stack([np.zeros(400), rng.normal(0, 0.05, 400)], axis=1)
        splines = []
        for factor in (1, 1000):
            np.savetxt(self.folder / "n.csv", factor * noisy, delimiter=",", fmt="%.17g")
            spline, summary = self.fit("n.csv", "--smooth", "auto")
            splines.append(np.array(spline["control_points"]) / factor)
            self.assertLess(abs(summary["noise_level"] / factor / 0.05 - 1), 0.1)
        self.assertLess(abs(splines[0] - splines[1]).max(), 1e-12 * 10)
        self.assertLess(largest_distance(spline, 1000 * clean) / 1000, 0.03)  # the noise itself is 0.05
        parameters = chord(clean)
        np.savetxt(self.folder / "n.csv", noisy, delimiter=",", fmt="%.17g")
        np.savetxt(self.folder / "t.txt", parameters, fmt="%.17g")
        for order in (2, 3):
            for amount in (1e-8, 1e-4, 1):  # the mean square plus so much of the derivative's squared integral, solved by NumPy
                spline, _ = self.fit("n.csv", "--parameters", "t.txt", "--smooth", amount, "--smooth-order", order, "-n", 30)
                knots = np.array(spline["knots"][0])
                a = BSpline.design_matrix(parameters, knots, 3).toarray()
                node, weight = np.polynomial.legendre.leggauss(4)
                breaks = np.unique(knots)
                half = np.diff(breaks)[:, None] / 2
                places, weights = (breaks[:-1, None] + half * (1 + node)).ravel(), (half * weight).ravel()
                bend = BSpline(knots, np.eye(30), 3).derivative(order)(places)
                best = np.linalg.lstsq(np.concatenate([a / 20, np.sqrt(amount * weights)[:, None] * bend]), np.concatenate([noisy / 20, np.zeros((places.size, 2))]), rcond=None)[0]
                self.assertLess(abs(np.array(spline["control_points"]) - best).max(), 1e-4 if amount == 1 else 1e-7, (order, amount))  # the condition grows with the amount, here to 1e11
        x = np.linspace(0, 1, 60)
        u, v = np.meshgrid(x, x, indexing="ij")
        np.save(self.folder / "g.npy", np.stack([u, v, np.sin(3 * u) * np.cos(4 * v) + rng.normal(0, 0.05, u.shape)], axis=-1))
        summary = self.fit("g.npy", "--smooth", "auto")[1]
        self.assertLess(abs(summary["noise_level"] / 0.05 - 1), 0.1)
        place = rng.random((4000, 2))
        np.savetxt(self.folder / "c.csv", np.column_stack([place, np.sin(3 * place[:, 0]) + rng.normal(0, 0.05, 4000)]), delimiter=",")
        summary = self.fit("c.csv", "--project", "xy", "--smooth", "auto", "-n", "20x20")[1]
        self.assertLess(abs(summary["noise_level"] / 0.05 - 1), 0.1)

    def test_poles_and_closed_axes(self):
        u, v = np.meshgrid(np.linspace(0, np.pi, 41), np.linspace(0, 2 * np.pi, 80, endpoint=False), indexing="ij")
        np.save(self.folder / "sphere.npy", np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1))
        spline, summary = self.fit("sphere.npy", "--tolerance", 1e-3, "--closed=1")
        self.assertLessEqual(summary["max_deviation"], 1e-3)
        self.assertLessEqual(summary["between_samples"], 1)
        # between the samples too: everywhere on the sphere
        u, v = np.linspace(0, 1, 201), np.linspace(0, 1, 301)
        self.assertLess(abs(np.linalg.norm(evaluate(spline, u, v), axis=-1) - 1).max(), 2e-3)
        seam = evaluate(spline, u, np.array([0.0, 1.0]))
        self.assertLess(abs(seam[:, 0] - seam[:, 1]).max(), 1e-12)

    def points_of(self, file):
        """The numbers of an airfoil's file, in whatever order: pairs within the chord, and no counts."""
        rows = []
        for line in file.read_text(errors="replace").splitlines()[1:]:
            try:
                rows.append([float(x) for x in line.split()])
            except ValueError:
                continue
        points = np.array([row for row in rows if len(row) == 2])
        return points[abs(points).max(axis=1) < 1.5]

    def test_every_airfoil_without_a_knob(self):
        files = some(airfoils(self))
        counts, astray, bent = [], 0, 0
        for file in files:
            for form in (["--interpolate", "ends"], ["--closed"]):
                spline, summary = self.fit(file, "--tolerance", 0.001, *form)
                self.assertLessEqual(largest_distance(spline, self.points_of(file)), 0.001 * (1 + 1e-9), (file.name, form))
                self.assertLessEqual(summary["max_deviation"], 0.001, file.name)
                counts.append(spline["control_shape"][0])
                astray += summary["between_samples"] > 1
                bent += summary["curve_inflections"] > summary["data_inflections"]
        self.assertLess(np.median(counts), 15)
        self.assertLessEqual(bent, 3)  # of 242; they say so
        self.assertLessEqual(astray, 5)  # 27 to 34 samples, none near a sharp nose: said in the verdict

    def test_compare_finds_the_closest_point_of_a_wiggly_curve(self):
        rng = np.random.default_rng(2)
        x = np.linspace(0, 5, 400)
        points = np.column_stack([x, np.sin(x) + 0.02 * rng.standard_normal(400)])
        np.savetxt(self.folder / "noise.csv", points, delimiter=",", fmt="%.17g")
        spline, _ = self.fit("noise.csv", "-n", 200)
        words = subprocess.run([BATTEN, "compare", "o.json", "noise.csv"], cwd=self.folder, capture_output=True, text=True, check=True).stdout
        ours = float(words.split("largest ")[1].split(" ")[0])
        self.assertAlmostEqual(ours / largest_distance(spline, points), 1, 4)

    def test_noise_is_named_not_interpolated(self):
        angle = np.linspace(0, 2 * np.pi, 1_000_000)
        noise = np.random.default_rng(1).normal(0, 0.01 / math.sqrt(2), (angle.size, 2))
        np.save(self.folder / "noisy.npy", np.stack([np.cos(angle), np.sin(angle)], axis=1) + noise)
        spline, summary = self.fit(self.folder / "noisy.npy", "--tolerance", 1e-4, status=4)
        self.assertEqual(summary["termination"], "tolerance_not_met")
        self.assertLess(abs(summary["noise_level"] / 0.01 - 1), 0.1)
        self.assertLess(spline["control_shape"][0], 100)
        self.assertIn("noise level", summary["verdict"])

    def test_hostile_data_have_an_answer(self):
        rng = np.random.default_rng(2)
        line = np.linspace(0, 1, 60)
        cases = {
            "collinear": np.stack([line, 2 * line], axis=1),
            "back and forth": np.stack([np.abs((np.arange(60) * 7) % 60 - 30.0), np.zeros(60)], axis=1),
            "spike": np.stack([line, np.where(np.arange(60) == 30, 5.0, 0)], axis=1),
            "runs of duplicates": np.repeat(np.stack([line[:20], line[:20] ** 2], axis=1), 4, axis=0),
            "far away": np.stack([1e9 + line, 1e9 + np.sin(6 * line)], axis=1),
            "tiny": 1e-9 * np.stack([line, np.sin(6 * line)], axis=1),
            "noise": rng.normal(size=(60, 2)),
            "far away and tiny": np.stack([1e9 + 1e-3 * line, 1e9 + 1e-3 * np.sin(6 * line)], axis=1),
        }
        for name, points in cases.items():
            path = self.folder / "c.csv"
            np.savetxt(path, points, delimiter=",", fmt="%.17g")
            size = np.linalg.norm(np.ptp(points, axis=0))
            for part in (1e-1, 1e-3, 1e-6, 10):
                done = subprocess.run([BATTEN, "fit", path, "--tolerance", repr(part * size), "-q", "-o", self.folder / "h.json", "--summary", "-"],
                                      capture_output=True, text=True, timeout=GUARD)
                self.assertIn(done.returncode, (0, 4), (name, part, done.stderr))
                summary, judged = json.loads(done.stdout), json.loads((self.folder / "h.json").read_text())
                self.assertEqual(summary["termination"], "tolerance_met" if done.returncode == 0 else "tolerance_not_met")
                for form in ("--closed", "--closed=C0", "--closed=C1"):
                    again = subprocess.run([BATTEN, "fit", path, "--tolerance", repr(part * size), "-q", form], capture_output=True, text=True, timeout=GUARD)
                    self.assertIn(again.returncode, (0, 4), (name, part, form, again.stderr))
                if done.returncode == 0:
                    self.assertLessEqual(largest_distance(judged, points), part * size * (1 + 1e-9) + 1e-15 * abs(points).max(), (name, part))
                if part >= 10 or name == "collinear":  # any curve does, or a straight one
                    self.assertEqual(done.returncode, 0, (name, part))

    def test_refusals(self):
        path, _ = self.data("rose")
        self.fit(path, "--tolerance", 1e-2)
        (self.folder / "o.json").rename(self.folder / "rose.json")
        for message, *arguments in (
            ("--tolerance: 0 is not a finite number above 0", "--tolerance", 0),
            ("--tolerance and --control-points: one of them states the size; --max-control-points bounds a tolerance", "--tolerance", 1, "-n", 9),
            ("a fit to a tolerance cannot smooth; direct, lspia, mlspia, ... can, without what else is asked", "--tolerance", 1, "--smooth", "auto"),
            ("closed: continuity C3 at the seam is more than degree 3 has anywhere, C2", "--tolerance", 1, "--closed=C3"),
            ("boundary u0: only a grid's surface or volume has boundaries to hold", "--tolerance", 1, "--boundary", f"u0={self.folder / 'rose.json'}"),
            ("corner 900: the samples are 0 to 500", "--tolerance", 1, "--corners", "900"),
            ("project: points of dimension 3 are needed, got 2", "--tolerance", 1, "--project", "xz"),
            ("smoothing: the derivative of order 3 vanishes for degree 2", "--smooth", "auto", "--smooth-order", 3, "-p", 2),
            ("corner 2: too few samples between it and the corner or end beside it; a piece of degree 3 needs 4", "--tolerance", 1, "--corners", "2"),
            ("--smooth -1: auto or a positive number is needed", "--smooth=-1"),
            ("8 constraints on 6 control points: at most as many are possible", "--tolerance", 1, "--interpolate", "0,9,18,27,36,45,54,63", "--max-control-points", 6),
            ("method lspia cannot fit to a tolerance; epia, search can", "--tolerance", 1, "--method", "lspia"),
        ):
            done = subprocess.run([BATTEN, "fit", path, *map(str, arguments)], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (2, f"batten: {message}\n"))
        for points, message in ((np.repeat(np.array([[0.0, 0], [1, 0], [1, 1]]), 4, axis=0), "axis 0: degree 3 needs at least 4 samples at different places, got 3"),
                                (np.zeros((1, 2)), "axis 0: 1 sample, at least 2 are needed"),
                                (np.zeros((20, 2)), "axis 0: all points are identical; a curve through them has no length")):
            np.savetxt(self.folder / "d.csv", points, delimiter=",")
            done = subprocess.run([BATTEN, "fit", self.folder / "d.csv", "--tolerance", "1"], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (2, f"batten: {message}\n"))

    def test_a_stated_limit_is_kept_and_said(self):
        path, _ = self.data("rose")
        spline, summary = self.fit(path, "--tolerance", 1e-5, "--max-control-points", 20, status=4)
        self.assertLessEqual(spline["control_shape"][0], 20)
        self.assertEqual(summary["verdict"].split(";")[0], "not met: 20 control points are allowed and do not suffice")


if __name__ == "__main__":
    unittest.main()
