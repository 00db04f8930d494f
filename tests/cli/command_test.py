"""The command as a user meets it: files in and out, messages, exit statuses. Numbers are checked by SciPy."""
import json
import os
import pty
import re
import select
import signal
import subprocess
import unittest

import numpy as np
from scipy.interpolate import BSpline, make_lsq_spline

from judge import BATTEN, GUARD, InFolder, ORDINARY, ROOT, airfoils, chord, evaluate, shared


class Command(InFolder):
    def good(self, *arguments, stdin=None):
        done = self.run_batten(*arguments, stdin=stdin)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def bad(self, status, message, *arguments, stdin=None, prefix=False):
        """One line on standard error, the status, and nothing written."""
        before = sorted(self.folder.iterdir())
        done = self.run_batten(*arguments, stdin=stdin)
        self.assertEqual(done.stderr[:len(message) + 8] if prefix else done.stderr, "batten: " + message + ("" if prefix else "\n"))
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertEqual(done.returncode, status)
        self.assertEqual(done.stdout, "")
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def read_json(self, name):
        return json.loads((self.folder / name).read_text())


class Fits(Command):
    def test_profile(self):
        profile = shared(self, "profile205.csv")
        self.good("fit", profile, "--control-points", 20, "-o", "a.json", "-o", "a.svg", "--summary", "s.json")
        summary, spline = self.read_json("s.json"), self.read_json("a.json")
        data = np.loadtxt(profile, delimiter=",", skiprows=1)
        deviation = np.linalg.norm(evaluate(spline, chord(data)) - data, axis=1)
        self.assertAlmostEqual(summary["max_deviation"], deviation.max(), 13)
        self.assertAlmostEqual(summary["rms_deviation"], np.sqrt((deviation**2).mean()), 13)
        self.assertEqual(summary["worst_sample"], deviation.argmax())
        self.assertEqual((summary["samples"], summary["dim"], summary["control_shape"], summary["termination"]), (205, 2, [20], "converged"))
        self.assertTrue((self.folder / "a.svg").read_text().startswith("<svg"))
        # the least-squares optimum itself, by SciPy
        best = make_lsq_spline(chord(data), data, np.array(spline["knots"][0]), 3)
        np.testing.assert_allclose(spline["control_points"], best.c, atol=1e-10)

    def test_terrain(self):
        terrain = shared(self, "terrain344x403.npy")
        self.good("fit", terrain, "--heights", "--control-points", "90x100", "-o", "t.json", "--summary", "s.json")
        summary, spline = self.read_json("s.json"), self.read_json("t.json")
        heights = np.load(terrain)
        points = evaluate(spline, np.linspace(0, 1, 344), np.linspace(0, 1, 403))
        deviation = np.abs(points[..., 2] - heights)
        grid = np.stack(np.meshgrid(np.arange(344), np.arange(403), indexing="ij"), axis=-1)
        np.testing.assert_allclose(points[..., :2], grid, atol=1e-9)  # the plane coordinates are linear: reproduced
        self.assertAlmostEqual(summary["max_deviation"] / deviation.max(), 1, 10)
        self.assertAlmostEqual(summary["rms_deviation"] / np.sqrt((deviation**2).mean()), 1, 10)
        self.assertEqual(summary["worst_sample"], deviation.argmax())

    def test_closed_curve_repeats_its_first_control_points(self):
        self.good("generate", "circle", "-o", "c.csv")
        words = self.good("fit", "c.csv", "--closed", "-n", 12, "-o", "c.json", "--summary", "s.json")
        spline = self.read_json("c.json")
        self.assertEqual(spline["closed"], [True])
        self.assertEqual(spline["control_shape"], [15])
        self.assertEqual(self.read_json("s.json")["control_shape"], [12])  # the report counts as -n does
        self.assertIn(" 12 control points, closed", words)
        self.assertEqual(spline["control_points"][:3], spline["control_points"][-3:])
        radius = np.linalg.norm(evaluate(spline, np.linspace(0, 1, 400)), axis=1)
        self.assertLess(abs(radius - 1).max(), 1e-3)  # 12 cubic pieces of a circle: 3e-4

    def test_history_and_streams(self):
        points = self.good("generate", "rose")
        out = self.good("fit", "-", "-n", 40, "--method", "mlspia", "--history", "--summary", "s.json", "-o", "-", stdin=points)
        self.assertEqual(json.loads(out)["format"], "batten-spline")
        summary = self.read_json("s.json")
        self.assertEqual(len(summary["history"]), summary["iterations"] + 1)
        self.assertLess(summary["history"][-1]["gradient_norm"], 1e-10 * summary["history"][0]["gradient_norm"])

    def test_evaluate_compare_info_convert(self):
        self.good("generate", "naca2412", "-o", "w.csv")
        self.good("fit", "w.csv", "-n", 24, "-o", "w.json")
        points = np.array([line.split() for line in self.good("evaluate", "w.json", "--samples", 50).splitlines()], float)
        spline = self.read_json("w.json")
        np.testing.assert_allclose(points, evaluate(spline, np.linspace(0, 1, 50)), atol=1e-15)
        slope = np.array([line.split() for line in self.good("evaluate", "w.json", "--samples", 9, "--derivative", 1).splitlines()], float)
        exact = BSpline(np.array(spline["knots"][0]), np.array(spline["control_points"]), 3).derivative()(np.linspace(0, 1, 9))
        np.testing.assert_allclose(slope, exact, atol=1e-12)
        self.assertRegex(self.good("compare", "w.json", "w.csv"), r"^201 points, distance to the closest point of the spline: largest 0\.00")
        self.assertIn("24 control points", self.good("info", "w.json"))
        self.assertIn("201 points in dimension 2", self.good("info", "w.csv"))
        self.good("convert", "w.json", "-o", "again.json", "-o", "w.svg")
        self.assertEqual((self.folder / "again.json").read_text(), (self.folder / "w.json").read_text())

    def test_knots_and_parameters_from_files(self):
        self.good("generate", "rose", "--samples", 101, "-o", "r.csv")
        self.write("t.txt", "\n".join(str(i / 100) for i in range(101)))
        self.write("k.txt", " ".join(map(str, [0, 0, 0, 0, *np.linspace(0, 1, 20)[1:-1], 1, 1, 1, 1])))
        self.good("fit", "r.csv", "--parameters", "t.txt", "--knots", "k.txt", "-o", "a.json")
        self.good("fit", "r.csv", "--parametrize", "uniform", "--knots", "uniform", "-n", 22, "-o", "b.json")
        a, b = self.read_json("a.json"), self.read_json("b.json")
        np.testing.assert_allclose(a["control_points"], b["control_points"], atol=1e-12)

    def test_every_airfoil_is_read(self):
        files = airfoils(self)
        self.assertGreater(len(files), 100)
        for file in files:
            rows = re.findall(r"^\s*(-?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s+(-?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*$", file.read_text(errors="replace"), re.M)
            found = json.loads(self.good("fit", file, "-n", 16, "-q", "--summary", "-"))
            # every pair of numbers is a point, but for a line of counts and a leading edge that stands twice
            self.assertLessEqual(found["samples"], len(rows), file.name)
            self.assertGreaterEqual(found["samples"], len(rows) - 2, file.name)


class Refusals(Command):
    def setUp(self):
        super().setUp()
        self.good("generate", "rose", "--samples", 30, "-o", "r.csv")
        self.good("generate", "peaks", "--samples", "9x9", "-o", "p.csv")

    def test_flags_may_stand_before_the_file(self):
        self.good("generate", "rose", "-o", "r.csv")
        for words in (("-o", "a.json", "r.csv", "-n", 20, "-q"), ("--closed", "r.csv", "-n", 20, "-q"), ("-p", 3, "r.csv", "-n", 20), ("--set", "mu=0.05", "r.csv", "-n", 20, "-m", "lspia", "-q")):
            self.good("fit", *words)
        self.good("convert", "-o", "b.obj", "a.json")

    def test_flags_that_say_nothing_are_refused(self):
        self.good("generate", "rose", "-o", "r.csv")
        self.good("fit", "r.csv", "-n", 9, "-q", "-o", "k.json")
        for message, *words in (("control points and knots: the knots state the number of control points", "-n", 20, "--knots", "k.json"),
                                ("a fit to a tolerance cannot take a rule for knots; direct, lspia, mlspia, ... can, without what else is asked", "-t", 1, "--knots", "uniform"),
                                ("method direct cannot limit the number of control points of a tolerance; search can, without what else is asked", "-n", 20, "--max-control-points", 5),
                                ("method direct cannot take corners; search can, without what else is asked", "-n", 20, "--corners", "3"),
                                ("method mlspia cannot move only some control points; pia, epia can", "-n", 20, "-m", "mlspia", "--moving", "3"),
                                ("--smooth-order: it needs --smooth", "-n", 20, "--smooth-order", 3),
                                ("--spacing: it is for --heights", "-n", 20, "--spacing", "2,2"),
                                ("--interpolate all: a list like 0,20,40 or a file is needed", "-n", 20, "--interpolate", "all"),
                                ("--report x.pdf: a page .html is written", "-n", 20, "--report", "x.pdf"),
                                ("--date soon: a date like 2026-01-31T12:00:00 is needed", "-n", 20, "--date", "soon", "-o", "x.step"),
                                ("--date: it is for .step, .stp, .igs, .iges", "-n", 20, "--date", "2026-01-31T12:00:00", "-o", "x.obj", "--report", "x.html"),
                                ("--unit: it is for .step, .stp, .igs, .iges, --report", "-n", 20, "--unit", "m", "-o", "x.json", "-o", "x.stl"),
                                ("--unit: it is for .step, .stp, .igs, .iges, --report", "-n", 20, "--unit", "mm"),
                                ("--chord-tolerance: it is for .stl, .vts, .vtu, .csv", "-n", 20, "--chord-tolerance", 0.1, "-o", "x.svg", "-o", "x.step"),
                                ("--history: it needs --summary or --report", "-n", 20, "-m", "lspia", "--history", "-o", "x.json"),
                                ("r.csv: it is the file of the points", "-n", 20, "-o", "r.csv")):
            self.bad(2, message, "fit", "r.csv", *words)
        self.good("convert", "k.json", "-o", "x.json", "--unit", "m")  # what the coordinates are may be said of any spline
        self.bad(2, "--chord-tolerance: it is for .stl, .vts, .vtu, .csv", "convert", "k.json", "-o", "-", "--chord-tolerance", 1)
        self.bad(3, "o.csv:1:1: '1e400' is not a number", "info", self.write("o.csv", "1e400,2\n-1,4\n"))
        self.bad(2, "p.txt: row 1: parameter 1.5 is outside the domain [0, 1] of axis 0", "evaluate", "k.json", "--parameters", self.write("p.txt", "0.5\n1.5\n"))

    def test_outputs_that_show_what_is_given_beside_others(self):
        self.good("fit", "r.csv", "-n", 9, "-q", "-o", "a.json", "-o", "a.csv", "--chord-tolerance", 0.01, "--report", "a.html", "--unit", "cm")
        self.good("convert", "a.json", "-o", "b.vts", "-o", "b.svg", "--chord-tolerance", 0.01)

    def test_a_solution_depends_on_no_start(self):
        for start in ("zero", "data"):
            self.good("fit", "r.csv", "-n", 9, "-q", "--initial", start, "-o", f"{start}.json", "--summary", "s.json")
            self.assertEqual(self.read_json("s.json")["method"], "direct")
        self.assertEqual(self.read_json("zero.json"), self.read_json("data.json"))

    def test_numbers_that_state_nothing(self):
        for flag in ("--stop-deviation", "--stop-gradient", "--stop-relative-gradient", "--max-iterations", "--threads"):
            for value in ("inf", "nan", "-1", "1e400"):
                self.bad(2, f"{flag}: {value} is not a finite number, 0 or more", "fit", "r.csv", "-n", 8, f"{flag}={value}")
        for flag in ("--tolerance", "--chord-tolerance", "--max-control-points"):
            for value in ("inf", "nan", "-1", "0"):
                self.bad(2, f"{flag}: {value} is not a finite number above 0", "fit", "r.csv", f"{flag}={value}")
        self.bad(2, "--spacing inf: a finite number is needed", "fit", "r.csv", "--heights", "--spacing", "1,inf")
        self.bad(2, "--closed C inf: a finite number is needed", "fit", "r.csv", "-n", 8, "--closed=Cinf")
        self.bad(2, "--closed C1e300: C0 to C8 is needed", "fit", "r.csv", "-n", 8, "--closed=C1e300")

    def test_axes_that_cannot_close(self):
        self.bad(2, "--closed 0,0: axis 0 is named twice", "fit", "p.csv", "--grid", "9x9", "-n", "5x5", "--closed=0,0")
        for points, *project in (("p.csv", "--project", "xy"), (self.write("c.obj", "".join(f"v {i % 7} {i // 7} {i % 3}\n" for i in range(49))),)):
            for closed in ("--closed", "--closed=1", "--closed=0,1"):
                self.bad(2, "closed: a cloud's parameters are its points' coordinates in a plane, where no axis closes; give it parameters that go round",
                         "fit", points, *project, "-n", "5x5", closed)
            self.bad(2, "--closed 2: the axes are 0 to 1", "fit", points, *project, "-n", "5x5", "--closed=2")

    def test_a_cloud_with_parameters_closes_the_axis_that_is_named(self):
        rng = np.random.default_rng(4)
        u, v = rng.random((2, 600))
        points = np.c_[np.cos(2 * np.pi * u), np.sin(2 * np.pi * u), v]
        np.savetxt(self.folder / "tube.csv", points, delimiter=",")
        np.savetxt(self.folder / "uv.txt", np.c_[u, v])
        self.good("fit", "tube.csv", "--parameters", "uv.txt", "-n", "12x5", "--closed=0", "-q", "-o", "t.json", "--summary", "s.json")
        spline, summary = self.read_json("t.json"), self.read_json("s.json")
        self.assertEqual((spline["closed"], spline["control_shape"], summary["control_shape"]), ([True, False], [15, 5], [12, 5]))
        self.assertLess(summary["max_deviation"], 1e-3)  # 12 cubic pieces of a circle: 3e-4

    def test_files(self):
        self.bad(3, "none.csv: cannot be read: No such file or directory", "fit", "none.csv", "-n", 8)
        self.bad(3, "e.csv: the file is empty", "fit", self.write("e.csv", ""), "-n", 8)
        self.bad(3, "g.csv:3: 3 numbers where the rows before have 2", "fit", self.write("g.csv", "1,2\n3,4\n5,6,7\n"), "-n", 8)
        self.bad(3, "h.csv:2:3: 'x' is not a number", "fit", self.write("h.csv", "1,2\n3,x\n"), "-n", 8)
        self.bad(2, "sample 1: its coordinates (3, inf) must be finite numbers", "fit", self.write("i.csv", "1,2\n3,inf\n"), "-n", 8)
        self.bad(2, "a.foo: unknown extension '.foo'; known: .json, .svg, .obj, .g2, .stl, .vts, .vtu, .csv, .step, .stp, .igs, .iges", "fit", "r.csv", "-n", 8, "-o", "a.foo")
        self.bad(3, "no/a.json: the folder no does not exist", "fit", "r.csv", "-n", 8, "-o", "no/a.json")
        self.bad(3, "no/s.json: the folder no does not exist", "fit", "r.csv", "-n", 8, "--summary", "no/s.json")

    def test_modes_of_files_and_folders_are_respected(self):
        def ordinary(*arguments):
            done = subprocess.run([*ORDINARY, BATTEN, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
            return done.returncode, done.stderr

        self.write("old.json", "old")
        (self.folder / "r.csv").chmod(0)
        self.assertEqual(ordinary("fit", "r.csv", "-n", 8), (3, "batten: r.csv: cannot be read: Permission denied\n"))
        (self.folder / "r.csv").chmod(0o644)
        self.folder.chmod(0o500)
        before = sorted(self.folder.iterdir())
        status, words = ordinary("fit", "r.csv", "-n", 8, "-q", "-o", "old.json", "-o", "new.svg")
        self.assertEqual(status, 3, words)
        self.assertRegex(words, r"^batten: (old\.json|new\.svg): .*Permission denied\n$")
        self.assertEqual(sorted(self.folder.iterdir()), before)
        self.assertEqual((self.folder / "old.json").read_text(), "old")
        self.folder.chmod(0o700)

    def test_a_full_disk_leaves_nothing(self):
        done = subprocess.run(f"{BATTEN} generate rose > /dev/full", shell=True, capture_output=True, text=True, timeout=GUARD)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr, "batten: standard output: cannot be written: No space left on device\n")

    def test_sizes(self):
        self.bad(2, "axis 0: 40 control points need at least as many samples, got 30", "fit", "r.csv", "-n", 40)
        self.bad(2, "axis 0: degree 3 needs at least 4 control points, got 3", "fit", "r.csv", "-n", 3)
        self.bad(2, "axis 0: degree 11 is outside 1 to 9", "fit", "r.csv", "-n", 20, "-p", 11)
        self.bad(2, "--control-points 20y: counts like 30, 20x30 or 8x8x8 are needed", "fit", "r.csv", "-n", "20y")
        self.bad(2, "grid: 9x8 needs 72 samples, got 81", "fit", "p.csv", "--grid", "9x8", "-n", "5x5")
        self.bad(2, "control points: 2 values given for 1 axis", "fit", "r.csv", "-n", "5x5")
        self.bad(2, "axis 0: all points are identical; a curve through them has no length", "fit", self.write("s.csv", "1,2\n" * 9), "-n", 5)

    def test_knots_and_parameters(self):
        knots = self.write("k.txt", "0 0 0 0 0.6 0.5 1 1 1 1")
        self.bad(2, "axis 0: knots must ascend: knot 5 = 0.5 is less than knot 4 = 0.6", "fit", "r.csv", "--knots", knots)
        knots = self.write("k.txt", "0 0 0 0 0.5 0.9 0.9 0.9 0.9")
        self.bad(2, "axis 0: parameters [0, 1] are outside the knots' domain [0, 0.9]", "fit", "r.csv", "--knots", knots)
        parameters = self.write("t.txt", "\n".join(["0"] * 29 + ["1"]))
        self.bad(2, "axis 0: no samples in knot spans [0.2, 0.4], [0.4, 0.6], [0.6, 0.8]: the direct solver cannot determine every control point "
                    "(Schoenberg-Whitney); use an iterative method such as cg, or smoothing",
                 "fit", "r.csv", "--parameters", parameters, "--knots", "uniform", "-n", 8, "--method", "direct")

    def test_words(self):
        self.bad(2, "unknown option '--contol-points'; did you mean '--control-points'?", "fit", "r.csv", "--contol-points", 8)
        self.bad(2, "unknown argument 'fti'; did you mean 'fit'?", "fti", "r.csv")
        self.bad(2, "unknown method 'lspai'; did you mean 'lspia'?", "fit", "r.csv", "-n", 8, "--method", "lspai")
        self.bad(2, "unknown value of --parametrize 'cord'; did you mean 'chord'?", "fit", "r.csv", "-n", 8, "--parametrize", "cord")
        self.bad(2, "unknown setting of method mlspia 'nue'; did you mean 'nu'?", "fit", "r.csv", "-n", 8, "--method", "mlspia", "--set", "nue=1")
        self.bad(2, "method direct has no settings, got 'mu'", "fit", "r.csv", "-n", 8, "--method", "direct", "--set", "mu=1")
        self.bad(2, "--set mu: name=value is needed", "fit", "r.csv", "-n", 8, "--set", "mu")
        self.bad(2, "unknown data set 'rsoe'; did you mean 'rose'?", "generate", "rsoe")
        done = self.run_batten("fit")
        self.assertEqual((done.returncode, done.stderr), (2, "batten: POINTS is required\n"))


    def test_methods_that_need_more(self):
        self.bad(2, "epia: state where to stop: a stop deviation, a tolerance or a number of control points", "fit", "r.csv", "--method", "epia")
        self.bad(2, "axis 0: pia needs as many control points as samples, got 8 and 30", "fit", "r.csv", "--method", "pia", "-n", 8)
        self.bad(2, "interpolated sample 30: the samples are 0 to 29", "fit", "r.csv", "-n", 8, "--interpolate", "0,30")
        self.bad(2, "interpolated sample 4 is given twice", "fit", "r.csv", "-n", 8, "--interpolate", "4,4")
        self.bad(2, "method lspia cannot pass through samples exactly; direct, clspia, epia can", "fit", "r.csv", "-n", 8, "--method", "lspia", "--interpolate", "ends")
        self.bad(2, "method direct cannot keep a shape of a grid; nothing can",
                 "fit", "p.csv", "--grid", "9x9", "-n", "5x5", "--preserve", "convexity")
        self.bad(2, "setting mu_1 = 0.1 of method clspia is outside ", "fit", "r.csv", "-n", 8, "--method", "clspia",
                 "--interpolate", "ends", "--set", "mu_1=0.1", prefix=True)
        self.bad(2, "unknown paper 'mlpia'; did you mean 'mlspia'?", "reproduce", "mlpia")
        self.bad(3, "nowhere: no folder", "reproduce", "mlspia", "--data", "nowhere")

    def test_exact_samples(self):
        self.good("fit", "r.csv", "-n", 10, "--interpolate", "ends", "-o", "e.json", "--summary", "e_s.json")
        ends = np.loadtxt(self.folder / "r.csv", delimiter=",")[[0, -1]]
        np.testing.assert_allclose(evaluate(self.read_json("e.json"), np.array([0.0, 1.0])), ends, atol=1e-13)
        self.assertEqual(self.read_json("e_s.json")["interpolated"], 2)
        self.good("fit", "r.csv", "-n", 10, "-o", "f.json")  # not held, they are missed
        self.assertGreater(abs(evaluate(self.read_json("f.json"), np.array([0.0, 1.0])) - ends).max(), 1e-6)

    def test_reproduce(self):
        table = self.good("reproduce", "mlspia", "--folder", "papers")
        self.assertRegex(table, r"334 control points, I +696 +696 +1\n")
        self.assertRegex(table, r"mlspia +Table 1, Example 3 +to the digit, 14 figures")
        part = table[table.index("  Table 2, Example 3: "):]
        self.assertRegex(part, r"iterations of LSPIA, Frobenius norm +- +157 ")
        self.assertRegex(part, r"the same, 2-norm as in eq. 39 +156 +156 +1\n")
        self.assertRegex(part, r"MaxDeviations.* +1\.1266e-9 +1\.12664\d+e-09 +1\n")
        for example in range(1, 5):
            self.assertRegex(table, rf"Table 3, Example {example}, starts in the box as printed: stand-in: .*ten starts in \[-200000, 20000\] of other random numbers")
            self.assertRegex(table, rf"Table 3, Example {example}, starts in the symmetric box: stand-in: .*ten starts in \[-200000, 200000\] of other random numbers")
        self.assertIn("Table 3, Example 5, random starts: stand-in: ", table)
        for step in (0, 200):
            self.assertTrue((self.folder / "papers" / f"mlspia_example5_step{step}.svg").exists())
        self.assertTrue((self.folder / "papers" / "mlspia_example3_comb.svg").exists())
        self.assertEqual(len((self.folder / "papers" / "mlspia_example3_history.csv").read_text().splitlines()), 1 + 48)


class Manners(Command):
    def test_help_names_an_example_for_every_command(self):
        for name in re.findall(r"^  (\w+) ", self.good("--help").split("Subcommands:")[1], re.M):
            self.assertIn(f"batten {name}", self.good(name, "--help"), name)

    def test_no_argument_says_what_to_do_next(self):
        self.assertIn("batten fit wing.csv", self.good())

    def listen(self, terminal, word):
        """What a program says on its terminal, until it says `word` (None: until it ends)."""
        said = ""
        while word is None or word not in said:
            self.assertTrue(select.select([terminal], [], [], GUARD)[0], f"silent after {said!r}")
            try:
                heard = os.read(terminal, 65536).decode()
            except OSError:  # the other end is closed
                heard = ""
            if not heard:
                self.assertIsNone(word, f"it ended without {word!r}: {said!r}")
                break
            said += heard
        return said

    def test_reading_says_how_far_it_is_and_ends_at_once(self):
        """Through a pipe that is slow; interrupted while it waits for more."""
        os.mkfifo(self.folder / "slow.csv")
        terminal, other = pty.openpty()
        fit = subprocess.Popen([BATTEN, "fit", "slow.csv", "-n", "8", "-o", "x.json"], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=other)
        os.close(other)
        try:
            with open(self.folder / "slow.csv", "wb", buffering=0) as pipe:
                pipe.write(b"0.25,0.5\n" * 400000)
                self.listen(terminal, "reading slow.csv: 2 MB, ")
                fit.send_signal(signal.SIGINT)
                words = self.listen(terminal, None)
                self.assertEqual(fit.wait(GUARD), 130)
        finally:
            fit.kill()
            fit.wait()
            os.close(terminal)
        self.assertTrue(words.endswith("batten: interrupted; nothing was written\r\n"), words)

    def test_interrupt_leaves_nothing(self):
        """Interrupted once the fit itself says that it is under way."""
        self.good("generate", "rose", "--samples", 200000, "-o", "big.csv")
        before = sorted(self.folder.iterdir())
        for word, *work in (("iteration ", "-n", "90000", "--method", "lspia", "--stop-gradient", "1e-300", "--max-iterations", "100000000"),
                            ("fitting", "--tolerance", "1e-10")):
            terminal, other = pty.openpty()
            fit = subprocess.Popen([BATTEN, "fit", "big.csv", *work, "-o", "x.json"], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=other)
            os.close(other)
            try:
                self.listen(terminal, word)
                fit.send_signal(signal.SIGINT)
                words = self.listen(terminal, None)
                self.assertEqual(fit.wait(GUARD), 130, work)
            finally:
                fit.kill()
                fit.wait()
                os.close(terminal)
            self.assertTrue(words.endswith("batten: interrupted; nothing was written\r\n"), words)
            self.assertEqual(sorted(self.folder.iterdir()), before)


class Readme(Command):
    def test_commands_shown_run(self):
        """Every `batten ...` line in README's code blocks runs in order in an empty folder."""
        text = (ROOT / "README.md").read_text()
        lines = [line for block in re.findall(r"```sh\n(.*?)```", text, re.S) for line in block.splitlines() if line.startswith("batten ")]
        self.assertGreater(len(lines), 3)
        for line in lines:
            self.good(*line.split("#")[0].split()[1:])


if __name__ == "__main__":
    unittest.main()
