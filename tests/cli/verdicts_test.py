"""Exit statuses, endings and words say what holds: every stated goal is judged here by SciPy on the written spline."""
import json
import re
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import InFolder, ROOT, chord, control_points, curve, evaluate, largest_distance, shared


class Verdicts(InFolder):
    def fit(self, status, points, *options):
        """The spline and the report of a fit that ends with `status`."""
        done = self.run_batten("fit", points, *options, "-o", "s.json", "--summary", "r.json")
        self.assertEqual(done.returncode, status, (options, done.stdout, done.stderr))
        report = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(status == 0, all(goal["met"] for goal in report.get("goals", [])), report)
        self.assertEqual(status == 4, report["termination"] in ("tolerance_not_met", "stalled") or
                         any(not goal["met"] for goal in report.get("goals", [])), report)
        return json.loads((self.folder / "s.json").read_text()), report, done.stdout

    def refused(self, words, *arguments):
        done = self.run_batten("fit", *arguments)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done)
        self.assertRegex(done.stderr, f"^batten: {words}\n$")

    def save(self, name, points):
        np.savetxt(self.folder / name, points, delimiter=",", fmt="%.17g")
        return name

    def good(self, *arguments):
        done = self.run_batten(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)


def wave(m, seed=3):
    """A smooth curve sampled unevenly."""
    t = np.sort(np.r_[0, 1, np.random.default_rng(seed).random(m - 2)])
    return np.c_[t + 0.1 * np.sin(5 * t), np.cos(4 * t) + 0.2 * np.sin(9 * t)]


class Goals(Verdicts):
    def test_epia_stopped_by_its_gradient_has_not_met_the_deviation(self):
        profile = shared(self, "profile205.csv")
        data = np.loadtxt(profile, delimiter=",", skiprows=1)
        for more in ([], ["-n", 62, "--stop-relative-gradient", 0.5]):
            spline, report, words = self.fit(4, profile, "-m", "epia", "--stop-deviation", 1e-9, "--stop-gradient", 1, *more)
            self.assertEqual(report["termination"], "tolerance_not_met")
            self.assertGreater(largest_distance(spline, data), 1e-9)
            self.assertIn("missed      deviation: stated 1e-09, reached", words)

    def test_a_quiet_fit_says_on_one_line_what_it_missed(self):
        name = self.save("w.csv", wave(60))
        for options, words in ((["-t", 1e-6, "--max-control-points", 8], "tolerance 1e-06: not met: 8 control points are allowed and do not suffice; .*"),
                               (["-n", 12, "-m", "lspia", "--stop-deviation", 1e-9], r"deviation: stated 1e-09, reached \S+"),
                               (["-n", 12, "-m", "clspia", "--interpolate", "0,30", "--stop-gradient", 1e-12, "--max-iterations", 2],
                                r"gradient: stated 1e-12, reached \S+; exact samples: stated \S+, reached \S+")):
            done = self.run_batten("fit", name, *options, "-q", "-o", "s.json")
            self.assertEqual((done.returncode, done.stdout), (4, ""), done)
            self.assertRegex(done.stderr, f"^batten: missed: {words}\n$")
            self.assertTrue((self.folder / "s.json").exists())
            said = self.run_batten("fit", name, *options, "-o", "s.json")
            self.assertEqual((said.returncode, said.stderr), (4, ""), said)  # the report says it
        done = self.run_batten("fit", name, "-t", 0.01, "-q", "-o", "s.json")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_epia_is_judged_by_the_parameters_that_it_fitted(self):
        glyph = shared(self, "glyph273.csv")
        spline, report, _ = self.fit(0, glyph, "-m", "epia", "--stop-deviation", 0.0035, "--parametrize", "uniform")
        self.assertEqual(report["termination"], "tolerance_met")
        data = np.loadtxt(glyph, delimiter=",", skiprows=1)
        t = np.arange(len(data)) / (len(data) - 1)
        for i in range(1, len(data)):  # a repeated sample has the place of the first
            t[i] = t[i - 1] if (data[i] == data[i - 1]).all() else t[i]
        away = np.linalg.norm(evaluate(spline, t) - data, axis=1).max()
        self.assertAlmostEqual(away, report["max_deviation"], 12)
        self.assertLessEqual(away, 0.0035)

    def test_used_up_iterations_are_no_failure_and_a_missed_gradient_is(self):
        points = self.save("w.csv", wave(120))
        _, report, _ = self.fit(0, points, "-n", 20, "-m", "lspia", "--max-iterations", 5)
        self.assertEqual((report["termination"], report["iterations"]), ("iteration_limit", 5))
        _, report, words = self.fit(4, points, "-n", 20, "-m", "lspia", "--max-iterations", 5, "--stop-gradient", 1e-13)
        self.assertEqual(report["goals"][0]["goal"], "gradient")
        self.assertIn("missed      gradient", words)
        self.fit(0, points, "-n", 20, "-m", "direct", "--stop-gradient", 1e-9)
        _, report, words = self.fit(4, points, "-n", 20, "-m", "direct", "--stop-gradient", 1e-18)  # beyond rounding
        self.assertIn("missed      gradient", words)

    def test_clspia_has_converged_only_with_its_samples_hit(self):
        points, data = self.save("w.csv", wave(150)), wave(150)
        size = np.linalg.norm(np.ptp(data, axis=0))
        exact = [0, 40, 90, 149]
        options = ["-n", 15, "-m", "clspia", "--interpolate", ",".join(map(str, exact))]
        for more, status in ((["--max-iterations", 3], 4), (["--stop-relative-gradient", 0.9, "--max-iterations", 100000], 0),
                             (["--max-iterations", 100000], 0)):
            spline, report, words = self.fit(status, points, *options, *more)
            missed = np.linalg.norm(evaluate(spline, chord(data)[exact]) - data[exact], axis=1).max()
            self.assertEqual(missed <= 1e-9 * size, status == 0)
            self.assertEqual("4 samples hit to" in words, status == 0)
            self.assertEqual("4 samples missed by up to" in words, status == 4)

    def test_a_tangent_turned_round_is_said_without_a_number(self):
        points = self.save("w.csv", wave(60))
        spline, _, _ = self.fit(0, points, "-n", 9)
        self.save("back.csv", control_points(spline)[::-1])  # from here the curve runs the other way
        step = wave(60)[31] - wave(60)[29]
        (self.folder / "t.csv").write_text(f"30,{step[0]!r},{step[1]!r}\n")
        options = [points, "-n", 9, "-m", "clspia", "--tangents", "t.csv", "--initial", "back.csv", "--max-iterations"]
        spline, report, words = self.fit(4, *options, 0)
        self.assertLess(BSpline(np.array(spline["knots"][0]), control_points(spline), 3)(chord(wave(60))[30], nu=1) @ step, 0)
        self.assertNotIn("null", (self.folder / "r.json").read_text())
        self.assertNotIn("tangent_error", report)
        self.assertEqual(report["goals"], [{"goal": "tangents", "stated": 1e-9, "met": False}])
        self.assertIn("runs against the stated direction", report["notes"][0])
        self.assertIn("1 tangent missed, turned round", words)
        self.assertNotIn("inf", words)
        self.assertLess(self.fit(0, *options, 100000)[1]["tangent_error"], 1e-9)

    def test_a_tangent_against_the_order_of_a_grid_is_refused(self):
        u, v = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 7), indexing="ij")
        np.save(self.folder / "g.npy", np.stack([u, v, np.sin(3 * u) * v], axis=-1))
        for sample in (0, 31, 62):
            for axis, direction in ((0, (-1, 0.5, 0)), (1, (0.5, -1, 0))):
                row = f"{sample},{axis},{','.join(map(str, direction))}\n"
                (self.folder / "t.csv").write_text(row)
                self.refused(f"tangent at sample {sample}: it points against the order of the samples; reverse its sign", "g.npy", "-n", "5x5", "--tangents", "t.csv")
                (self.folder / "t.csv").write_text(f"{sample},{axis},{','.join(str(-x) for x in direction)}\n")
                self.good("fit", "g.npy", "-n", "5x5", "--tangents", "t.csv", "-q")

    def test_closed_pia_interpolates_a_torus(self):
        self.good("generate", "torus", "-o", "t.npy")
        spline, _, _ = self.fit(0, "t.npy", "-m", "pia", "-n", "60x40", "--closed=0,1", "--max-iterations", 40)
        data = np.load(self.folder / "t.npy")
        net = control_points(spline)
        for axis, m in enumerate(data.shape[:2]):  # the closed basis at the even parameters, by SciPy
            knots = np.array(spline["knots"][axis])
            begin, t = knots[3], np.arange(m) / m
            t = begin + (t - begin) % 1.0
            net = np.moveaxis(BSpline(knots, np.moveaxis(net, axis, 0), 3)(t), 0, axis)
        self.assertLess(np.abs(net - data).max(), 1e-6)

    def test_a_tolerance_is_judged_by_the_true_distance(self):
        data = wave(200)
        for tolerance in (1e-2, 1e-4):
            spline, report, _ = self.fit(0, self.save("w.csv", data), "-t", tolerance)
            away = largest_distance(spline, data)
            self.assertEqual(report["deviation_kind"], "distance")
            self.assertLessEqual(away, tolerance * (1 + 1e-9))
            self.assertAlmostEqual(report["max_deviation"] / away, 1, 6)

    def test_pia_refuses_a_tolerance(self):
        self.refused("method pia cannot fit to a tolerance; epia, search can", self.save("w.csv", wave(30)), "-m", "pia", "-t", 0.01)

    def test_a_deviation_stated_alone_is_a_tolerance(self):
        data = wave(200)
        spline, _, _ = self.fit(0, self.save("w.csv", data), "--stop-deviation", 1e-3)
        self.assertLessEqual(largest_distance(spline, data), 1e-3 * (1 + 1e-9))
        _, report, _ = self.fit(4, "w.csv", "-n", 6, "--stop-deviation", 1e-6)
        self.assertEqual(report["method"], "direct")


class KeptShape(Verdicts):
    def away(self, spline, data):
        return np.linalg.norm(evaluate(spline, chord(data)) - data, axis=1).max()

    def test_a_straight_start_is_no_lock(self):
        """Where nothing bends yet a polygon may begin to; from zero it comes to the samples."""
        t = np.arange(12.0)
        for slope in (1, 0.37):
            for shift in (0, 1000):
                data = np.c_[shift + t, shift + slope * t]
                for shape in ("convexity", "inflections"):
                    options = [self.save("l.csv", data), "-n", 4, "-m", "lspia", "--preserve", shape]
                    spline, report, _ = self.fit(0, *options)
                    self.assertEqual((report["termination"], report["inflections"]), ("converged", 0))
                    self.assertLess(self.away(spline, data), 1e-9)
                    done = self.run_batten("fit", *options, "--initial", "zero", "-o", "s.json")
                    self.assertIn(done.returncode, (0, 4))
                    self.assertLess(self.away(json.loads((self.folder / "s.json").read_text()), data), 1e-3)
                spline, report, _ = self.fit(0, "l.csv", "-m", "pia", "-n", 12, "--preserve", "convexity", "--initial", "zero")
                self.assertLess(self.away(spline, data), 1e-6)

    def test_a_lock_far_from_the_samples_has_not_reached_its_stop(self):
        t = np.arange(12.0)
        data = np.c_[1000 + t, 1000 + 0.1 * (t - 6) ** 2]
        for method, n in (("lspia", 4), ("mlspia", 12)):
            for unit in (1.0, 2.0 ** 600):
                np.save(self.folder / "a.npy", data * unit)
                spline, report, words = self.fit(4, "a.npy", "-n", n, "-m", method, "--preserve", "convexity", "--initial", "zero")
                self.assertEqual(report["termination"], "stalled")
                spline["control_points"] = (np.array(spline["control_points"]) / unit).tolist()
                self.assertAlmostEqual(self.away(spline, data) / (report["max_deviation"] / unit), 1, 9)
                self.assertGreater(report["max_deviation"] / unit, 1)
                self.assertGreater(report["held_back"] / unit, 1)
                goal, = (goal for goal in report["goals"] if not goal["met"])
                self.assertEqual((goal["goal"], goal["stated"]), ("relative gradient", 1e-10))
                self.assertAlmostEqual(goal["reached"], report["gradient_norm"] / report["first_gradient_norm"], 12)
                self.assertIn("shape       it locked the iteration, which was to move a control point by ", words)
            spline, report, _ = self.fit(0, "a.npy", "-n", 4, "-m", method, "--preserve", "convexity")
            self.assertEqual(report["termination"], "converged")
            self.assertNotIn("held_back", report)


class Sameness(Verdicts):
    def test_reversed_samples_give_the_reversed_spline(self):
        data = wave(90)
        self.save("w.csv", data)
        self.save("r.csv", data[::-1])
        for degree in range(1, 10):
            for n in (degree + 1, 17, 31):
                one = control_points(self.fit(0, "w.csv", "-n", n, "-p", degree)[0])
                two = control_points(self.fit(0, "r.csv", "-n", n, "-p", degree)[0])
                self.assertLess(np.abs(one - two[::-1]).max(), 1e-6 * 4.0 ** (degree - 5) if degree > 5 else 1e-9, (degree, n))

    def test_units_change_nothing(self):
        data = wave(80)
        base = self.fit(0, self.save("w.csv", data), "-t", 1e-3)[0]
        for exponent in (-700, -40, 7, 332, 600):  # the coordinates' exponents alone change
            np.save(self.folder / "u.npy", data * 2.0 ** exponent)
            scaled = self.fit(0, "u.npy", "-t", repr(1e-3 * 2.0 ** exponent))[0]
            self.assertTrue((control_points(scaled) == control_points(base) * 2.0 ** exponent).all(), exponent)
        for factor in (1e-3, 25.4, 1e100, 1e-100):
            scaled = self.fit(0, self.save("u.csv", data * factor), "-t", repr(1e-3 * factor))[0]
            self.assertLessEqual(abs(len(control_points(scaled)) - len(control_points(base))), 2, factor)

    def test_every_length_of_the_report_is_in_the_callers_unit(self):
        data = wave(80)
        options = ["-n", 12, "-m", "clspia", "--interpolate", "0,79", "--history", "--max-iterations", 30]
        base = self.fit(4, self.save("w.csv", data), *options)[1]
        np.save(self.folder / "u.npy", data * 2.0 ** 600)
        far = self.fit(4, "u.npy", *options)[1]
        for key in ("max_deviation", "rms_deviation", "gradient_norm", "first_gradient_norm", "constraint_error", "data_size"):
            self.assertEqual(far[key], base[key] * 2.0 ** 600, key)
        self.assertEqual(far["history"][3]["max_deviation"], base["history"][3]["max_deviation"] * 2.0 ** 600)
        self.assertEqual(far["goals"][0]["reached"], base["goals"][0]["reached"] * 2.0 ** 600)

    def test_a_seam_of_a_stated_continuity(self):
        a = np.linspace(0, 2 * np.pi, 121)[:-1]
        ring = np.c_[(2 + np.cos(3 * a)) * np.cos(a), (2 + np.cos(2 * a)) * np.sin(a)]
        self.save("ring.csv", ring)
        for degree in (3, 5):
            for order in range(degree):
                spline = curve(self.fit(0, "ring.csv", "-n", 24, "-p", degree, f"--closed=C{order}")[0])
                begin, end = spline.t[degree], spline.t[-degree - 1]
                for k in range(degree):
                    gap = np.linalg.norm(spline(end - 1e-13, nu=k) - spline(begin, nu=k))
                    scale = 1 + np.abs(spline(np.linspace(begin, end, 99), nu=k)).max()
                    self.assertEqual(gap < 1e-6 * scale, k <= order, (degree, order, k, gap))


class Table(Verdicts):
    def test_the_documented_table_is_the_commands(self):
        table = self.run_batten("methods", "--table").stdout
        self.assertIn(table, (ROOT / "docs" / "methods.md").read_text())
        head, _, *rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
        self.assertIn("search", head)
        self.assertEqual({cell for row in rows for cell in row[1:]} - {"-"} - {"s", "g", "c", "sg", "sc", "gc", "sgc"}, set())

    def test_the_table_is_what_the_command_does(self):
        """A few cells from the outside; the library's test tries them all."""
        self.save("w.csv", wave(40))
        (self.folder / "weights.txt").write_text("1\n" * 40)
        table = [[cell.strip() for cell in line.strip("|").split("|")] for line in self.run_batten("methods", "--table").stdout.splitlines()]
        head = table[0]
        rows = {row[0]: dict(zip(head[1:], row[1:])) for row in table[2:]}
        flags = {"weigh samples": ["--weights", "weights.txt"], "smooth": ["--smooth", "1e-6"], "record a history": ["--history", "--summary", "r.json"],
                 "pass through samples exactly": ["--interpolate", "ends"], "set outliers aside": ["--robust"], "start from stated control points": ["--initial", "zero"]}
        for words, flag in flags.items():
            for method, cell in rows[words].items():
                size = {"search": ["-t", 0.01], "pia": [], "epia": ["--stop-deviation", 0.01]}.get(method, ["-n", 12])
                done = self.run_batten("fit", "w.csv", "-m", method, *size, *flag, "-q")
                self.assertEqual(done.returncode in (0, 4), "s" in cell, (method, words, done.stderr))
                if "s" not in cell:
                    self.assertRegex(done.stderr, f"cannot {re.escape(words)}; ")


if __name__ == "__main__":
    unittest.main()
