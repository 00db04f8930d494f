"""Files that hold several splines: each is reached by its number, all are taken apart, and each command says how."""
import unittest

import numpy as np

from judge import HAS_CAD, InFolder, evaluate, lacks, read_spline


class Entities(InFolder):
    def setUp(self):
        super().setUp()
        if not HAS_CAD:
            lacks(self, "batten-cad was not built")
        t = np.linspace(0, 3, 60)
        self.points = [np.c_[k + np.cos(t), np.sin((k + 1) * t), 0 * t] for k in range(3)]
        for k, points in enumerate(self.points):
            np.savetxt(self.folder / f"p{k}.csv", points, delimiter=",")
            self.good("fit", f"p{k}.csv", "-n", 24, "-q", "-o", f"s{k}.json")
        self.good("convert", "s0.json", "s1.json", "s2.json", "-o", "all.step", "-o", "all.igs")

    def good(self, *arguments):
        done = self.run_batten(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def bad(self, message, *arguments):
        done = self.run_batten(*arguments)
        self.assertEqual((done.returncode, done.stderr), (2, f"batten: {message}\n"))

    def same(self, name, k):
        t = np.linspace(0, 1, 101)
        np.testing.assert_allclose(evaluate(read_spline(self.folder / name), t), evaluate(read_spline(self.folder / f"s{k}.json"), t),
                                   atol=1e-14)

    def test_all_are_taken_apart(self):
        for file in ("all.step", "all.igs"):
            self.good("convert", file, "-o", "part-%d.json", "-o", "whole.step")
            for k in range(3):
                self.same(f"part-{k + 1}.json", k)
            self.assertEqual(self.good("info", "whole.step").count("entity"), 3)
            self.good("convert", file, "-o", "q%d-%d.json")
            self.same("q2-2.json", 1)

    def test_one_is_named(self):
        for file in ("all.step", "all.igs"):
            for k in range(3):
                self.good("convert", file, "--entity", k + 1, "-o", "one.json")
                self.same("one.json", k)
                self.good("evaluate", file, "--entity", k + 1, "--samples", 11, "-o", "e.csv")
                np.testing.assert_allclose(np.loadtxt(self.folder / "e.csv", delimiter=",")[[0, -1]],
                                           evaluate(read_spline(self.folder / f"s{k}.json"), [0, 1]), atol=1e-12)
                largest = float(self.good("compare", file, f"p{k}.csv", "--entity", k + 1).split("largest ")[1].split()[0])
                self.assertLess(largest, 0.05)  # the others are 1 away
                self.good("plot", file, "--entity", k + 1, "-o", "p.svg")

    def test_a_wrong_number_is_refused(self):
        several = "all.step: it holds 3 splines, one is needed: say which, entity 1 to 3 (a conversion takes them apart)"
        self.bad(several, "evaluate", "all.step", "--samples", 3)
        self.bad(several, "compare", "all.step", "p0.csv")
        self.bad(several, "plot", "all.step", "-o", "p.svg")
        self.bad("all.step: entity 4: the file holds 3 splines, counted from 1", "convert", "all.step", "--entity", 4, "-o", "x.json")
        self.bad("s0.json: entity 2: the file holds 1 spline, counted from 1", "evaluate", "s0.json", "--entity", 2, "--samples", 3)
        self.bad("x.json: .json files hold one spline, got 3", "convert", "all.step", "-o", "x.json")
        self.assertFalse((self.folder / "x.json").exists())

    def test_names_that_meet_are_refused(self):
        done = self.run_batten("convert", "all.step", "-o", "part-%d.json", "-o", "part-2.json")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertFalse((self.folder / "part-1.json").exists())


if __name__ == "__main__":
    unittest.main()
