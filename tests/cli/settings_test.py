"""Every method's own settings: what is given is taken as it is, or refused with the range; judged by NumPy from the collocation matrix."""
import json
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD

COUNT = 18
HELD = "0,40,119"


def run(folder, *arguments):
    return subprocess.run([BATTEN, *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=GUARD)


class Settings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls._folder.name)
        t = np.linspace(0, 1, 120)
        cls.data = np.c_[np.cos(5 * t) + t, np.sin(4 * t) + 0.2 * np.cos(11 * t)]
        np.savetxt(cls.folder / "p.csv", cls.data, delimiter=",", fmt="%.17g")
        done = run(cls.folder, "fit", "p.csv", "-n", COUNT, "-m", "direct", "--parameters", cls.parameters(t), "-o", "d.json", "-q")
        assert done.returncode == 0, done.stderr
        spline = json.loads((cls.folder / "d.json").read_text())
        cls.matrix = BSpline.design_matrix(t, np.array(spline["knots"][0]), 3).toarray()
        cls.largest, cls.smallest = np.linalg.svd(cls.matrix, compute_uv=False)[[0, -1]] ** 2

    @classmethod
    def parameters(cls, t):
        np.savetxt(cls.folder / "t.txt", t, fmt="%.17g")
        return "t.txt"

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def fit(self, method, *settings, more=()):
        for old in ("o.json", "s.json"):
            (self.folder / old).unlink(missing_ok=True)
        arguments = ["fit", "p.csv", "-m", method, "-q", "-o", "o.json", "--summary", "s.json", *more]
        if method != "pia":
            arguments += ["-n", COUNT]
        if method not in ("pia", "epia"):
            arguments += ["--parameters", "t.txt"]
        if method == "clspia":
            arguments += ["--interpolate", HELD]
        for setting in settings:
            arguments += ["--set", setting]
        return run(self.folder, *arguments)

    def refused(self, method, setting, words, more=()):
        done = self.fit(method, setting, more=more)
        self.assertEqual(done.returncode, 2, (method, setting, done.stderr))
        name, value = setting.split("=")
        self.assertIn(f"setting {name} = {value} of method {method} is outside {words}", done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1)

    def runs(self, method, *settings, more=()):
        done = self.fit(method, *settings, more=(*([] if "--max-iterations" in more else ["--max-iterations", 30]), *more))
        self.assertIn(done.returncode, (0, 4), (method, settings, done.stderr))
        return json.loads((self.folder / "s.json").read_text())

    def test_values_outside_a_range_are_refused_with_it(self):
        for method, setting, words in (
                ("lspia", "mu=0", "0 < mu"), ("lspia", "mu=-1", "0 < mu"),
                ("mlspia", "omega=0", "0 < omega < 2"), ("mlspia", "omega=2", "0 < omega < 2"), ("mlspia", "nu=0", "0 < nu"), ("mlspia", "nu=-2", "0 < nu"),
                ("clspia", "mu=0", "0 < mu"), ("clspia", "mu_1=0", "0 < mu_1"), ("clspia", "inner_tolerance=-5", "0 < inner_tolerance"),
                ("clspia", "inner_tolerance=0", "0 < inner_tolerance"),
                ("pia", "weight=0", "0 < weight <= 2"), ("pia", "weight=2.1", "0 < weight <= 2"),
                ("epia", "eta=1", "0 <= eta < 1"), ("epia", "eta=-0.1", "0 <= eta < 1"), ("epia", "t_c=0", "0 < t_c"),
                ("epia", "rounds=1.7", "the whole numbers 0 <= rounds"), ("epia", "rounds=-1", "the whole numbers 0 <= rounds"),
                ("epia", "smoothing=0.5", "the whole numbers 0 <= smoothing"), ("epia", "exact=2", "the whole numbers 0 <= exact <= 1"),
                ("cg", "plain=0.5", "the whole numbers 0 <= plain <= 1"), ("cg", "diagonal=-1", "the whole numbers 0 <= diagonal <= 1"),
                ("barzilai-borwein", "memory=0", "the whole numbers 1 <= memory"), ("barzilai-borwein", "memory=2.5", "the whole numbers 1 <= memory")):
            self.refused(method, setting, words)
        for method in ("lspia", "mlspia", "clspia", "chebyshev", "nesterov"):
            for value in (0, 1, -0.5, 7):
                self.refused(method, f"eigenvalue_tolerance={value}", "0 < eigenvalue_tolerance < 1")

    def test_values_inside_a_range_are_taken_as_they_are(self):
        for method, settings in (("mlspia", ["gamma=0"]), ("epia", ["eta=0", "rounds=0", "smoothing=0", "exact=0", "t_c=1e-5"]), ("epia", ["exact=1"]),
                                 ("cg", ["plain=1"]), ("cg", ["plain=0", "diagonal=1"]), ("barzilai-borwein", ["memory=1"]), ("pia", ["weight=2"]),
                                 ("pia", ["weight=0.01"]), ("clspia", ["inner_tolerance=1e-3"]), ("lspia", ["eigenvalue_tolerance=0.999"])):
            summary = self.runs(method, *settings)
            for setting in settings:
                name, value = setting.split("=")
                if name in summary["settings"]:
                    self.assertEqual(summary["settings"][name], float(value), (method, setting))

    def test_settings_change_what_is_iterated(self):
        """The default written out gives the same control points, another value other ones."""
        for method, default, other in (("epia", "screen=1", "screen=0"), ("epia", "smoothing=4", "smoothing=0"), ("cg", "plain=0", "plain=1"),
                                       ("barzilai-borwein", "memory=10", "memory=1"), ("pia", "weight=1", "weight=0.5")):
            points = []
            for setting in (None, default, other):
                self.runs(method, *filter(None, [setting]), more=("--stop-deviation", 1e-3) if method == "epia" else ("--stop-relative-gradient", 0, "--max-iterations", 9))
                points.append(json.loads((self.folder / "o.json").read_text())["control_points"])
            self.assertEqual(points[0], points[1], (method, default))
            self.assertNotEqual(points[0], points[2], (method, other))

    def test_both_kinds_of_cg_at_once_are_refused(self):
        done = self.fit("cg", "plain=1", "diagonal=1")
        self.assertEqual(done.returncode, 2)
        self.assertIn("plain = 1 and diagonal = 1", done.stderr)

    def test_regions_of_convergence_end_where_the_theory_says(self):
        accurate = "eigenvalue_tolerance=1e-12"
        high = 2 / self.largest
        self.runs("lspia", f"mu={high * 0.9999:.17g}", accurate)
        done = self.fit("lspia", f"mu={high * 1.0001:.17g}", accurate)
        self.assertEqual(done.returncode, 2)
        self.assertIn("its region of convergence", done.stderr)
        self.assertAlmostEqual(float(done.stderr.split("0 < mu < ")[1].split(",")[0]), high, delta=1e-8 * high)
        omega, nu = 0.8, 0.7 / self.largest  # sigma_1^2 nu = 0.7: eq. 11 allows gamma from -0.34 to 2.1
        for gamma, inside in ((0.8 - 0.8 / 0.7, None), (0, True), (0.4 + 1.2 / 0.7, None)):
            for off, taken in ((-1e-4, gamma > 0), (1e-4, gamma <= 0)) if inside is None else ((0, True),):
                done = self.fit("mlspia", f"omega={omega}", f"nu={nu:.17g}", f"gamma={gamma + off:.17g}", accurate, more=("--max-iterations", 5))
                self.assertEqual(done.returncode, 0 if taken else 2, (gamma, off, done.stderr))

    def test_a_gamma_of_0_iterates_by_equation_3(self):
        """Huang, Wang 2020: Delta = (1 - omega) Delta' + gamma delta + (omega - gamma) delta', here with gamma = 0."""
        start = np.zeros((COUNT, 2))
        for given in (("omega=0.9", f"nu={0.6 / self.largest:.17g}"), ("omega=0.9",), ()):
            summary = self.runs("mlspia", "gamma=0", *given, more=("--initial", "zero", "--stop-relative-gradient", 0))
            omega, gamma, nu = (summary["settings"][name] for name in ("omega", "gamma", "nu"))
            self.assertEqual(gamma, 0)
            self.assertLess(omega - omega / (self.largest * nu), 0)
            control, move, last = start.copy(), None, None
            for _ in range(30):
                delta = nu * self.matrix.T @ (self.data - self.matrix @ control)
                move = omega * delta if move is None else (1 - omega) * move + omega * last
                last = delta
                control = control + move
            found = np.array(json.loads((self.folder / "o.json").read_text())["control_points"])
            self.assertLess(abs(found - control).max(), 1e-10, given)

    def test_the_list_says_ranges_and_defaults(self):
        text = run(self.folder, "methods").stdout
        for words in ("0 < omega < 2", "0 <= eta < 1", "default 0.6", "0 < weight <= 2", "the whole numbers 1 <= memory"):
            self.assertIn(words, text)


if __name__ == "__main__":
    unittest.main()
