"""The newer iterations, step by step beside their formulas in NumPy on dense matrices; their limits; and the tables that print them."""
import json
import re
import subprocess
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD, InFolder, some, shared

STEPS = 12


def design(knots, degree, at):
    return BSpline.design_matrix(at, np.array(knots), degree).toarray()


class Normal:
    """H = A^T W A and the gradient A^T W (Q - A P)."""

    def __init__(self, matrix, points, weights):
        self.h = matrix.T * weights @ matrix
        self.right = matrix.T * weights @ points
        self.sums = self.h.sum(axis=1)  # of a basis function over the samples
        self.eigenvalues = np.linalg.eigvalsh(self.h)

    def gradient(self, control):
        return self.right - self.h @ control


def salspia(normal, control, steps, memory=10, kind=0):
    """[Peng, Li 2026]: control points after so many steps and the norms of the gradients on the way."""
    bound, norms, values = normal.sums.max(), [], [0.0]
    last = alpha = None
    value = 0.0
    for k in range(steps + 1):
        r = normal.gradient(control)
        rho = (r * r).sum()
        norms.append(np.sqrt(rho))
        if k == steps:
            return control, norms
        curvature = (r * (normal.h @ r)).sum()
        if last is None:
            alpha = 1 / bound
        else:
            before, zeta = (last * last).sum(), (last * r).sum()
            b, c = (before - zeta) / alpha, (before - 2 * zeta + rho) / alpha ** 2
            w = max(1 - np.clip(b / (bound * before), 0, 1), 1e-8)
            if kind == 0 and w > 1e-8:
                alpha = max(np.roots([(1 - w) * c, (2 * w - 1) * b, -w * before]).real) if w < 1 else before / b
            else:
                alpha = before / b if kind == 1 else b / c
            while value - alpha * rho + alpha ** 2 / 2 * curvature > max(values) - 1e-4 * alpha * rho:
                alpha /= 2
        value += alpha ** 2 / 2 * curvature - alpha * rho
        values = (values + [value])[-memory:]
        control, last = control + alpha * r, r


def by_factors(normal, control, steps, factor):
    norms = []
    for k in range(steps + 1):
        r = normal.gradient(control)
        norms.append(np.linalg.norm(r))
        if k < steps:
            control = control + factor(k) * r
    return control, norms


def alspia(normal, control, steps, cycle=16):
    low, high = normal.eigenvalues[[0, -1]]
    root = lambda k: np.cos((2 * (k % cycle) + 1) * np.pi / (2 * cycle))
    return by_factors(normal, control, steps, lambda k: 2 / (high + low + (high - low) * root(k)))


def lin2018(normal, control, steps):
    return by_factors(normal, control, steps, lambda k: 1 / normal.sums[:, None])


def nmlspia(normal, control, steps):
    low, high = np.sqrt(normal.eigenvalues[[0, -1]])
    before, norms = control, []
    for k in range(steps + 1):
        norms.append(np.linalg.norm(normal.gradient(control)))
        if k < steps:
            ahead = control + (high - low) / (high + low) * (control - before)
            before, control = control, ahead + normal.gradient(ahead) / high ** 2
    return control, norms


FORMULAS = {"salspia": salspia, "alspia": alspia, "nmlspia": nmlspia, "lin2018": lin2018}


class Iterations(InFolder):
    def run_fit(self, points, *arguments):
        np.save(self.folder / "q.npy", points)
        done = subprocess.run([BATTEN, "fit", "q.npy", *map(str, arguments), "--history", "-q", "-o", "o.json", "--summary", "s.json"], cwd=self.folder,
                              capture_output=True, text=True, timeout=GUARD)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        return [json.loads((self.folder / name).read_text()) for name in ("o.json", "s.json")]

    def problems(self, seed):
        """Name, samples, arguments, and the matrix of a spline's knots at the samples' parameters."""
        rng = np.random.default_rng(seed)
        t = np.sort(rng.random(80))
        t[[0, -1]] = 0, 1
        np.save(self.folder / "t.npy", t)
        curve = np.column_stack([np.cos(4 * t), np.sin(6 * t), t]) + 0.01 * rng.normal(size=(80, 3))
        yield "curve", curve, ["-n", 15, "--parameters", "t.npy"], lambda s: design(s["knots"][0], 3, t)
        u, v = np.linspace(0, 1, 14), np.linspace(0, 1, 11)
        grid = np.stack([*np.meshgrid(u, v, indexing="ij"), np.sin(5 * u[:, None]) * np.cos(4 * v)], axis=-1)
        grid[..., 2] += 0.1 * rng.normal(size=(14, 11))
        yield "grid", grid, ["-n", "8x7", "--parametrize", "uniform"], lambda s: np.kron(design(s["knots"][0], 3, u), design(s["knots"][1], 3, v))
        at = np.vstack([rng.random((300, 2)), [[0, 0], [1, 1]]])
        np.save(self.folder / "at.npy", at)
        cloud = np.column_stack([at, np.sin(5 * at[:, 0]) * np.cos(4 * at[:, 1])])
        rows = lambda s: np.einsum("ij,ik->ijk", design(s["knots"][0], 3, at[:, 0]), design(s["knots"][1], 3, at[:, 1])).reshape(302, -1)
        yield "cloud", cloud, ["-n", "7x6", "--parameters", "at.npy"], rows

    def test_every_step_is_the_formulas(self):
        for seed in some(range(5)):
            for name, points, arguments, matrix in self.problems(seed):
                count = points.size // points.shape[-1]
                weights = np.random.default_rng(seed).uniform(0.5, 3, count) if seed % 2 else np.ones(count)
                np.savetxt(self.folder / "w.csv", weights, fmt="%.17g")
                for method, formula in FORMULAS.items():
                    exact = ["--set", "eigenvalue_tolerance=1e-12"] if method in ("alspia", "nmlspia") else []
                    spline, summary = self.run_fit(points, *arguments, "-m", method, *exact, "--weights", "w.csv", "--initial", "zero", "--max-iterations", STEPS,
                                                   "--stop-relative-gradient", 0)
                    normal = Normal(matrix(spline), points.reshape(count, -1), weights)
                    control, norms = formula(normal, np.zeros((len(normal.h), points.shape[-1])), STEPS)
                    mine = [entry["gradient_norm"] for entry in summary["history"]]
                    case = (seed, name, method)
                    np.testing.assert_allclose(mine, norms, rtol=1e-8, atol=1e-10 * norms[0], err_msg=str(case))
                    ours = np.array(spline["control_points"]).reshape(control.shape)
                    self.assertLess(abs(ours - control).max(), 1e-9 * abs(control).max(), case)

    def test_the_ablations_of_the_step(self):
        _, points, arguments, matrix = next(self.problems(7))
        for kind in (1, 2):
            spline, _ = self.run_fit(points, *arguments, "-m", "salspia", "--set", f"step={kind}", "--set", "memory=3", "--initial", "zero", "--max-iterations",
                                     STEPS, "--stop-relative-gradient", 0)
            normal = Normal(matrix(spline), points, np.ones(len(points)))
            control, _ = salspia(normal, np.zeros((15, 3)), STEPS, 3, kind)
            self.assertLess(abs(np.array(spline["control_points"]) - control).max(), 1e-9)

    def test_the_limit_is_the_direct_answers(self):
        for name, points, arguments, _ in self.problems(3):
            count = points.size // points.shape[-1]
            np.savetxt(self.folder / "w.csv", np.random.default_rng(1).uniform(0.5, 3, count), fmt="%.17g")
            cases = [[], ["--weights", "w.csv"], ["--smooth", "1e-4"]]
            if name == "curve":
                cases.append(["--closed"])
            for more in cases:
                arguments_now = ["-n", 15] if "--closed" in more else arguments
                best, _ = self.run_fit(points, *arguments_now, *more, "-m", "direct")
                for method in FORMULAS:
                    spline, _ = self.run_fit(points, *arguments_now, *more, "-m", method, "--stop-relative-gradient", 1e-13, "--max-iterations", 200000)
                    off = abs(np.array(spline["control_points"]) - np.array(best["control_points"])).max()
                    self.assertLess(off, 1e-9, (name, more, method))

    def test_control_points_without_samples_stay(self):
        t = np.r_[np.linspace(0, 0.4, 60), np.linspace(0.7, 1, 50)]
        np.save(self.folder / "t.npy", t)
        points = np.column_stack([np.cos(4 * t), np.sin(6 * t)])
        knots = np.r_[np.zeros(3), np.linspace(0, 1, 21), np.ones(3)]
        np.savetxt(self.folder / "k.txt", knots, fmt="%.17g")
        matrix = design(knots, 3, t)
        seen = matrix.sum(axis=0) > 0
        for method in ("lin2018", "salspia"):
            spline, _ = self.run_fit(points, "--parameters", "t.npy", "--knots", "k.txt", "-m", method, "--initial", "zero", "--stop-relative-gradient", 1e-9,
                                     "--max-iterations", 100000)
            control = np.array(spline["control_points"])
            self.assertTrue((control[~seen] == 0).all(), method)
            self.assertLess(np.linalg.norm(matrix.T @ (points - matrix @ control)), 1e-7, method)

    def test_lspia_over_a_hole_takes_steps_that_get_somewhere(self):
        t = np.r_[np.linspace(0, 0.4, 300), np.linspace(0.6, 1, 200)]
        points = np.column_stack([np.cos(4 * t), np.sin(6 * t)]) + 0.001 * np.random.default_rng(1).normal(size=(500, 2))
        knots = np.r_[np.zeros(3), np.linspace(0, 1, 60), np.ones(3)]
        np.save(self.folder / "t.npy", t)
        np.savetxt(self.folder / "k.txt", knots, fmt="%.17g")
        matrix = design(knots, 3, t)
        best = np.linalg.norm(points - matrix @ np.linalg.lstsq(matrix, points, rcond=None)[0])
        spline, summary = self.run_fit(points, "--parameters", "t.npy", "--knots", "k.txt", "-m", "lspia", "--max-iterations", 2000)
        self.assertLess(np.linalg.norm(points - matrix @ np.array(spline["control_points"])), 1.01 * best)
        self.assertIn("Lin, Cao, Zhang", " ".join(summary["notes"]))

    def test_peng_and_lis_tables_come_out(self):
        done = subprocess.run([BATTEN, "reproduce", "salspia", "--folder", "r"], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        verdicts = dict(re.findall(r"^  salspia  (\S.*?) {2,}(.*)$", done.stdout, re.M))
        for full in ("4.1 blob", "4.2 helix", "4.4 Dini", "4.5 peaks"):
            self.assertEqual(verdicts[full], "to the digit, 20 figures")
        for holes in ("4.1 with holes", "4.2 with holes"):
            self.assertEqual(verdicts[holes], "to the digit, 12 figures")
        self.assertEqual(verdicts["Ablation of the step, 4.2"], "to the digit, 6 figures")
        self.assertEqual(verdicts["Lengths of the memory, 4.5"], "to the digit, 10 figures")
        self.assertTrue(verdicts["4.3 reindeer"].startswith("not run: "))
        rows = re.findall(r"^    (\S.*?) {2,}(\S+) +(\S+) +\S+$", done.stdout, re.M)
        printed = [(what, float(a), float(b)) for what, a, b in rows if a not in ("-", "published")]
        self.assertGreater(len(printed), 110)
        counts = [(a, b) for what, a, b in printed if "iterations" in what]
        self.assertLessEqual(sum(a != b for a, b in counts), 1)  # of Franke's start, which is not unique

    def test_mount_eden_comes_out_as_recomputed(self):
        # the figures of an independent program on the same heights, another resampling than the paper's
        data = shared(self, "mteden860x600.npy").parent
        done = subprocess.run([BATTEN, "reproduce", "salspia", "--folder", "r", "--data", data], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        table = done.stdout.split("4.6 terrain: ")[1].split("\n\n")[0]
        figures = {what: float(value) for what, value in re.findall(r"^    (\S.*?) {2,}\S+ +(\S+) +\S+$", table, re.M) if value != "computed"}
        for method, iterations, error in (("alspia", 34, 9.4085), ("mlspia", 114, 9.0170), ("nmlspia", 23, 9.8498), ("salspia", 13, 4.7566)):
            self.assertEqual(figures[f"{method}: iterations"], iterations)
            self.assertAlmostEqual(figures[f"{method}: E in 1e-7"], error, delta=1e-4)
        self.assertAlmostEqual(figures["salspia: rms"], 0.103436, delta=1e-6)
        self.assertAlmostEqual(figures["salspia: largest"], 1.00551, delta=1e-5)

class Clspia(InFolder):
    def summary(self, *arguments):
        rng = np.random.default_rng(5)
        t = np.linspace(0, 1, 200)
        np.save(self.folder / "q.npy", np.column_stack([t, np.sin(9 * t)]) + 0.02 * rng.normal(size=(200, 2)))
        done = subprocess.run([BATTEN, "fit", "q.npy", "-n", "20", "-m", "clspia", "--interpolate", "0,20,40,60,80,100,120,140,160,180,199", "--summary", "s.json",
                               *arguments], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.folder / "s.json").read_text()), done.stdout

    def test_the_chosen_steps_take_a_third_of_scalar_ones(self):
        chosen, words = self.summary()
        self.assertNotIn("lambda:", words)
        settings = chosen["settings"]
        self.assertGreater(settings["outer_iterations"], 10)
        printed = self.summary("--set", f"mu={1 / settings['beta_max']}", "--set", f"mu_1={settings['gamma_max']}")[0]
        self.assertLess(3 * chosen["iterations"], printed["iterations"])
        self.assertLess(chosen["iterations"], 1000)

    def exact(self, points, control, count, *arguments):
        """What is missed of `count` exact samples, in parts of the data's size."""
        np.save(self.folder / "q.npy", points)
        flat = points.reshape(-1, points.shape[-1])
        exact = np.sort(np.random.default_rng(2).choice(len(flat), count, replace=False))
        done = subprocess.run([BATTEN, "fit", "q.npy", "-n", control, "-m", "clspia", "--interpolate", ",".join(map(str, exact)), "--summary", "s.json", *arguments],
                              cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        goals = json.loads((self.folder / "s.json").read_text())["goals"]
        return max(g["reached"] for g in goals if g["goal"] == "exact samples") / np.ptp(flat, axis=0).max()

    def test_many_exact_samples_of_grids_and_clouds_hold_within_the_default_limit(self):
        rng = np.random.default_rng(1)
        height = lambda u, v: np.sin(5 * u) * np.cos(4 * v) + 0.01 * rng.normal(size=u.shape)
        u, v = np.meshgrid(np.linspace(0, 1, 45), np.linspace(0, 1, 40), indexing="ij")
        self.assertLess(self.exact(np.stack([u, v, height(u, v)], -1), "10x9", 60), 1e-8)
        places = rng.random((12505, 2))
        np.save(self.folder / "t.npy", places)
        self.assertLess(self.exact(np.column_stack([places, height(*places.T)]), "35x30", 60, "--parameters", "t.npy"), 1e-8)

    def test_multipliers_that_start_elsewhere_are_noted(self):
        one, words = self.summary("--set", "lambda=1")
        self.assertIn("lambda: multipliers that start from another number than 0", words)
        self.assertNotEqual(one["iterations"], self.summary()[0]["iterations"])

    def test_a_kept_shape_refuses_steps_before_it(self):
        np.save(self.folder / "q.npy", np.random.default_rng(1).random((50, 2)))
        done = subprocess.run([BATTEN, "fit", "q.npy", "-n", "10", "-m", "clspia", "--interpolate", "ends", "--preserve", "inflections", "--set", "warm_start=2"],
                              cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("warm_start", done.stderr)


if __name__ == "__main__":
    unittest.main()
