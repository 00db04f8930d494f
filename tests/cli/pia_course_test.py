"""PIA's course: predicted rates and best weights beside NumPy's eigenvalues, and turns kept by Algorithm 1 of the 2004 paper written out in NumPy."""
import json
import re
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import InFolder


def turns(polygon):
    """Signed areas of the triangles of points that follow each other, and what rounding leaves of them."""
    a, b, c = polygon[:-2], polygon[1:-1], polygon[2:]
    area = (b - a)[:, 0] * (c - b)[:, 1] - (b - a)[:, 1] * (c - b)[:, 0]
    doubt = 2 * np.finfo(float).eps * abs(polygon).max() * (abs(b - a) + abs(c - b)).sum(axis=1)
    return area, doubt


def signs(polygon):
    area, doubt = turns(polygon)
    return np.where(abs(area) <= doubt, 0, np.sign(area))


class Course(InFolder):
    def pia(self, data, *more):
        np.savetxt(self.folder / "p.csv", data, delimiter=",", fmt="%.17g")
        done = self.run_batten("fit", "p.csv", "-m", "pia", "-q", "-o", "o.json", "--summary", "s.json", *more)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        spline, summary = (json.loads((self.folder / name).read_text()) for name in ("o.json", "s.json"))
        return np.array(spline["knots"][0]), np.array(spline["control_points"]), summary

    def square(self, count, spread, degree=3, *more):
        """Samples on uneven parameters; their collocation matrix and what the command says of them."""
        rng = np.random.default_rng(count)
        t = np.r_[0, np.cumsum(np.exp(spread * rng.uniform(-1, 1, count - 1)))]
        t /= t[-1]
        np.savetxt(self.folder / "t.txt", t, fmt="%.17g")
        data = np.column_stack([np.cos(5 * t), np.sin(7 * t)])
        knots, _, summary = self.pia(data, "-n", count, "-p", degree, "--parameters", "t.txt", "--max-iterations", 1, *more)
        return BSpline.design_matrix(t, knots, degree).toarray(), summary

    def said(self, summary):
        """How far off the predicted rate may be; notes have one digit."""
        note = re.search(r"the predicted rate is known to (\S+) only", " ".join(summary.get("notes", [])))
        return 1.5 * float(note[1]) if note else 1e-6

    def test_predicted_rates_are_as_exact_as_is_said(self):
        seen = 0
        for count in (20, 85, 150, 300, 700):
            for spread in (0, 0.5, 1.5):
                for degree in (2, 3, 5):
                    matrix, summary = self.square(count, spread, degree)
                    expected = abs(1 - np.linalg.eigvals(matrix)).max()
                    allowed = self.said(summary)
                    seen += allowed == 1e-6
                    self.assertLess(abs(summary["predicted_rate"] - expected), allowed, (count, spread, degree))
        self.assertGreater(seen, 25)

    def test_the_best_weight_is_lus(self):
        for count in (12, 60, 200):
            for degree in (2, 3, 4):
                matrix, summary = self.square(count, 0.7, degree, "--set", "best_weight=1")
                values = np.linalg.eigvals(matrix)
                self.assertLess(abs(values.imag).max(), 1e-6)
                self.assertAlmostEqual(values.real.max(), 1)
                weight = 2 / (1 + values.real.min())
                self.assertAlmostEqual(summary["settings"]["weight"], weight, delta=1e-5)
                self.assertAlmostEqual(summary["predicted_rate"], (1 - values.real.min()) / (1 + values.real.min()), delta=self.said(summary))

    def test_the_best_weight_of_chosen_control_points_is_best_of_all(self):
        chosen = list(range(5, 13))
        matrix, summary = self.square(30, 0.7, 3, "--set", "best_weight=1", "--moving", ",".join(map(str, chosen)))
        values = np.linalg.eigvals(matrix[np.ix_(chosen, chosen)])
        least = min(abs(1 - w * values).max() for w in np.linspace(0.5, 3, 20001))
        self.assertAlmostEqual(summary["predicted_rate"], least, delta=1e-4)

    def test_settings_that_contradict_or_do_nothing_are_refused(self):
        np.savetxt(self.folder / "p.csv", np.random.default_rng(1).random((9, 2)), delimiter=",")
        for words, *more in (("settings weight and best_weight = 1 of method pia: one of them at most", "--set", "weight=1", "--set", "best_weight=1"),
                             ("setting threshold of method pia: only where convexity is preserved", "--set", "threshold=0.1")):
            done = self.run_batten("fit", "p.csv", "-m", "pia", "-n", 9, *more, "-q", "-o", "o.json")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr)

    def algorithm_1(self, polygon, moves, threshold):
        """The factor of the moves: halved until all turns are the same, then as near to the whole as D says."""
        same = lambda part: (signs(polygon + part * moves) == signs(polygon)).all()
        if same(1):
            return 1.0
        good, bad = 0.5, 1.0
        while not same(good):
            good /= 2
        while bad - good > threshold:
            middle = (good + bad) / 2
            good, bad = (middle, bad) if same(middle) else (good, middle)
        return good

    def test_turns_of_any_polygon_are_kept_as_algorithm_1_says(self):
        shortened = 0
        for seed in range(12):
            rng = np.random.default_rng(seed)
            t = np.sort(rng.uniform(0, 1, 14))
            data = np.column_stack([t, 0.3 * np.sin(2 * np.pi * t)]) + 0.01 * rng.normal(size=(14, 2))  # bends both ways
            np.savetxt(self.folder / "t.txt", (t - t[0]) / (t[-1] - t[0]), fmt="%.17g")
            for threshold in (0.1, 1e-4):
                knots, control, summary = self.pia(data, "-n", 14, "--parameters", "t.txt", "--preserve", "convexity", "--set", f"threshold={threshold}",
                                                   "--max-iterations", 8, "--stop-relative-gradient", 0)
                matrix = BSpline.design_matrix((t - t[0]) / (t[-1] - t[0]), knots, 3).toarray()
                polygon = data.copy()
                for _ in range(8):
                    moves = data - matrix @ polygon
                    part = self.algorithm_1(polygon, moves, threshold)
                    shortened += part < 1
                    polygon = polygon + part * moves
                self.assertLess(abs(control - polygon).max(), 1e-9, (seed, threshold))
                self.assertTrue((signs(control) == signs(data)).all(), seed)
        self.assertGreater(shortened, 20)

    def test_what_holds_the_moves_is_said(self):
        locked = 0
        for seed in range(30):
            rng = np.random.default_rng(seed)
            angle = np.sort(rng.uniform(0, 2 * np.pi, 12))
            data = np.column_stack([3 * np.cos(angle), np.sin(angle)])
            _, control, summary = self.pia(data, "-n", 12, "--preserve", "convexity", "--max-iterations", 3000)
            self.assertTrue((signs(control) * signs(data) >= 0).all(), seed)  # what locks is a turn that has come to its rounding
            if "held_back" not in summary:
                continue
            locked += 1
            self.assertEqual(summary["goals"][0]["goal"], "relative gradient")
            self.assertFalse(summary["goals"][0]["met"])
            note = " ".join(summary["notes"])
            found = re.search(r"their sum over (\d+) steps is (\S+),", note)
            self.assertIsNotNone(found, note)
            self.assertLess(float(found[2]), float(found[1]))
        self.assertGreater(locked, 3)

    def test_a_collinear_triple_is_named(self):
        data = np.array([[0, 0], [1, 4], [4, 6], [8, 6], [12, 6], [16, 5], [18, 0]], float)
        _, control, summary = self.pia(data, "-n", 7, "--preserve", "convexity", "--max-iterations", 3000)
        self.assertGreater(summary["held_back"], 1)
        self.assertIn("the moves are held: control points 2, 3 and 4 are collinear", " ".join(summary["notes"]))
        self.assertTrue((signs(control) <= 0).all())


if __name__ == "__main__":
    unittest.main()
