"""Preconditioned, accelerated, randomised, fairing and monotone LSPIA beside their formulas in NumPy on dense matrices, and their limits."""
import unittest

import numpy as np
from scipy.optimize import nnls

from iteration_cases import STEPS, Cases, Normal, design, roughness
from judge import some


def anderson(normal, control, steps, window=10):
    """[Walker, Ni 2011] of the steps r / (row sum): r is made least in the norm of one over these."""
    sums = normal.sums[:, None]
    moves, changes, norms = [], [], []
    last = None
    for k in range(steps + 1):
        r = normal.gradient(control)
        norms.append(np.linalg.norm(r))
        if k == steps:
            return control, norms
        if last is not None:
            changes = (changes + [r - last])[-window:]
        move = r / sums
        if changes:
            columns = np.column_stack([(change / np.sqrt(sums)).ravel() for change in changes])
            gamma = np.linalg.lstsq(columns, (r / np.sqrt(sums)).ravel(), rcond=None)[0]
            move = move - sum(g * (m + c / sums) for g, m, c in zip(gamma, moves, changes))
        control, last, moves = control + move, r, (moves + [move])[-window:]


def pmlspia(normal, control, steps):
    """[Polyak 1964]: the heavy ball with its best step and momentum."""
    low, high = np.sqrt(normal.eigenvalues[[0, -1]])
    before, norms = control, []
    for k in range(steps + 1):
        r = normal.gradient(control)
        norms.append(np.linalg.norm(r))
        if k < steps:
            step, momentum = 4 / (high + low) ** 2, ((high - low) / (high + low)) ** 2
            before, control = control, control + step * r + momentum * (control - before)
    return control, norms


class Twister:
    """The 64-bit Mersenne twister [Nishimura 2000]."""

    def __init__(self, seed):
        self.state = [seed]
        for k in range(1, 312):
            self.state.append((6364136223846793005 * (self.state[-1] ^ self.state[-1] >> 62) + k) % 2 ** 64)
        self.at = 312

    def __call__(self):
        if self.at == 312:
            for k in range(312):
                x = (self.state[k] >> 31 << 31) | self.state[(k + 1) % 312] % 2 ** 31
                self.state[k] = self.state[(k + 156) % 312] ^ x >> 1 ^ (0xB5026F5AA96619E9 if x % 2 else 0)
            self.at = 0
        x = self.state[self.at]
        self.at += 1
        x ^= x >> 29 & 0x5555555555555555
        x ^= x << 17 & 0x71D67FFFEDA60000
        x ^= x << 37 & 0xFFF7EEE000000000
        return x ^ x >> 43


def rpia(normal, control, steps, block=5, seed=7):
    random, traces = Twister(seed), np.cumsum(np.add.reduceat(np.diag(normal.h), range(0, len(normal.h), block)))
    sums, norms = normal.sums[:, None], []
    for k in range(steps + 1):
        r = normal.gradient(control)
        norms.append(np.linalg.norm(r))
        if k < steps:
            drawn = np.searchsorted(traces, (random() >> 11) * 2.0 ** -53 * traces[-1], side="right")
            longest = np.maximum.reduceat(abs(r / sums).max(axis=1), range(0, len(r), block))
            while longest[drawn] < 1e-3 * longest.max():  # next to nothing to move: the one after it
                drawn = (drawn + 1) % len(longest)
            here = slice(drawn * block, (drawn + 1) * block)
            control = control.copy()
            control[here] += (r / sums)[here]
    return control, norms


def compensated(matrix, band):
    """The middle of the band, the size of what is left out added to the diagonal."""
    near = abs(np.subtract.outer(range(len(matrix)), range(len(matrix)))) <= band
    return np.where(near, matrix, 0) + np.diag(np.where(near, 0, abs(matrix)).sum(axis=1))


def plspia(normal, control, steps, band=1):
    shape, matrix, weights = normal.shape, normal.matrix, normal.weights
    axes = [matrix.reshape(-1, *shape).sum(axis=tuple(1 + j for j in range(len(shape)) if j != k)) for k in range(len(shape))]
    grams = [axis.T * weights @ axis for axis in axes]  # B-splines sum to one
    if normal.factored:
        grams = [compensated(gram, band) for gram in grams]
    m = grams[0]
    for gram in grams[1:]:
        m = np.kron(m, gram) / weights.sum()
    values = np.linalg.eigvals(np.linalg.solve(m, normal.h)).real
    inverse = np.linalg.inv(m)
    norms = []
    for k in range(steps + 1):
        r = normal.gradient(control)
        norms.append(np.linalg.norm(r))
        if k < steps:
            control = control + 2 / (values.min() + values.max()) * inverse @ r
    return control, norms


def fairing_pia(normal, control, steps, w=1e-3, order=2):
    """[Jiang, Lin 2022] with one weight, the samples' in parts of their mean; the norm that is reported is divided by 1 - w."""
    rough = roughness(normal.knots, 3, order) * normal.weights.mean()
    m = (1 - w) * normal.h + w * rough
    norms = []
    for k in range(steps + 1):
        bracket = (1 - w) * normal.gradient(control) - w * rough @ control
        norms.append(np.linalg.norm(bracket) / (1 - w))
        if k < steps:
            control = control + bracket / abs(m).sum(axis=1)[:, None]
    return control, norms


def rising(values):
    """The nearest numbers that do not fall, by their minimax formula."""
    n = len(values)
    sums = np.r_[0, np.cumsum(values)]
    mean = lambda j, k: (sums[k + 1] - sums[j]) / (k + 1 - j)
    return np.array([max(min(mean(j, k) for k in range(i, n)) for j in range(i + 1)) for i in range(n)])


def monotone(normal, control, steps):
    """[Li, Che 2026]: each coordinate kept rising or falling, as the samples' regression line does."""
    mu = 0.99 * 2 / abs(normal.h).sum(axis=1).max()
    project = lambda p: np.column_stack([d * rising(d * c) for d, c in zip(normal.directions, p.T)])
    norms, control = [], project(control)
    for k in range(steps + 1):
        ahead = project(control + mu * normal.gradient(control))
        norms.append(np.linalg.norm(ahead - control) / mu)
        if k < steps:
            control = ahead
    return control, norms


EVERYWHERE = {"anderson": anderson, "pmlspia": pmlspia, "rpia": rpia, "plspia": plspia}
ON_CURVES = {"fairing-pia": fairing_pia, "monotone-lspia": monotone}
SETTINGS = {"pmlspia": ["eigenvalue_tolerance=1e-12"], "plspia": ["eigenvalue_tolerance=1e-12"], "rpia": ["block=5", "seed=7"], "fairing-pia": ["weight=1e-3"]}


class MoreIterations(Cases):
    def settings(self, method):
        return [word for setting in SETTINGS.get(method, []) for word in ("--set", setting)]

    def normal_of(self, name, spline, matrix, points, weights):
        normal = Normal(matrix, points, weights)
        normal.matrix, normal.weights, normal.knots = matrix, weights, spline["knots"][0]
        normal.shape = spline["control_shape"]
        normal.factored = name == "curve" or name == "grid" and (weights == 1).all()
        if name == "curve":
            at = np.load(self.folder / "t.npy")
            normal.directions = [np.sign(np.polyfit(at, column, 1, w=np.sqrt(weights))[0]) for column in points.T]
        return normal

    def test_every_step_is_the_formulas(self):
        for seed in some(range(5)):
            for name, points, arguments, matrix in self.problems(seed):
                count = points.size // points.shape[-1]
                weights = np.random.default_rng(seed).uniform(0.5, 3, count) if seed % 2 else np.ones(count)
                np.savetxt(self.folder / "w.csv", weights, fmt="%.17g")
                for method, formula in (EVERYWHERE | ON_CURVES if name == "curve" else EVERYWHERE).items():
                    spline, summary = self.run_fit(points, *arguments, "-m", method, *self.settings(method), "--weights", "w.csv", "--initial", "zero",
                                                   "--max-iterations", STEPS, "--stop-relative-gradient", 0)
                    normal = self.normal_of(name, spline, matrix(spline), points.reshape(count, -1), weights)
                    control, norms = formula(normal, np.zeros((len(normal.h), points.shape[-1])), STEPS)
                    case = (seed, name, method)
                    mine = [entry["gradient_norm"] for entry in summary["history"]]
                    np.testing.assert_allclose(mine, norms, rtol=1e-7, atol=1e-9 * norms[0], err_msg=str(case))
                    ours = np.array(spline["control_points"]).reshape(control.shape)
                    self.assertLess(abs(ours - control).max(), 1e-9 * abs(control).max(), case)

    def test_the_limit_is_the_direct_answers(self):
        for name, points, arguments, best in self.best_of_all(3):
            for method in EVERYWHERE:
                spline, summary = self.run_fit(points, *arguments, "-m", method, *self.settings(method), "--stop-relative-gradient", 1e-13,
                                               "--max-iterations", 400000)
                self.assertLess(abs(np.array(spline["control_points"]) - best).max(), 1e-9, (name, arguments, method))
                self.assertEqual(summary["settings"].get("setup_products", 0) > 0, method in ("pmlspia", "plspia"), method)

    def test_fairing_of_data_is_smoothing_weighed_otherwise(self):
        for name, points, arguments, _ in self.problems(4):
            count = points.size // points.shape[-1]
            np.savetxt(self.folder / "w.csv", np.random.default_rng(1).uniform(0.5, 3, count), fmt="%.17g")
            for more in ([], ["--weights", "w.csv"], *([["--closed", "--parametrize", "uniform"]] if name == "curve" else [])):
                now = ["-n", 15] if "--closed" in more else arguments
                faired, summary = self.run_fit(points, *now, *more, "-m", "fairing-pia", "--set", "weight=1e-5", "--set", "order=3", "--stop-relative-gradient", 1e-13,
                                               "--max-iterations", 400000)
                best, _ = self.run_fit(points, *now, *more, "-m", "direct", "--smooth", repr(summary["settings"]["smoothing"]), "--smooth-order", 3)
                off = abs(np.array(faired["control_points"]) - np.array(best["control_points"])).max()
                self.assertLess(off, 1e-9, (name, more))

    def test_bands_from_none_to_all(self):
        """No diagonals are lin2018's steps, all of them the solution in one."""
        name, points, arguments, _ = next(self.problems(2))
        best, _ = self.run_fit(points, *arguments, "-m", "direct")
        counts = []
        for band in range(4):
            spline, summary = self.run_fit(points, *arguments, "-m", "plspia", "--set", f"band={band}")
            self.assertLess(abs(np.array(spline["control_points"]) - np.array(best["control_points"])).max(), 1e-8)
            counts.append(summary["iterations"])
        self.assertEqual(counts, sorted(counts, reverse=True))
        self.assertLessEqual(counts[3], 2)
        ones = [self.run_fit(points, *arguments, *more, "--max-iterations", 9)[0]["control_points"] for more in
                (["-m", "plspia", "--set", "band=0", "--set", "relaxation=1"], ["-m", "lin2018"])]
        np.testing.assert_allclose(*ones, rtol=0, atol=1e-13)
        refused = self.run_batten("fit", "q.npy", *arguments, "-m", "plspia", "--set", "relaxation=2.1", "-o", "x.json")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("0 < relaxation < 2", refused.stderr)

    def test_control_points_without_samples_stay(self):
        t = np.r_[np.linspace(0, 0.4, 60), np.linspace(0.7, 1, 50)]
        np.save(self.folder / "t.npy", t)
        points = np.column_stack([np.cos(4 * t), np.sin(6 * t)])
        knots = np.r_[np.zeros(3), np.linspace(0, 1, 21), np.ones(3)]
        np.savetxt(self.folder / "k.txt", knots, fmt="%.17g")
        matrix = design(knots, 3, t)
        seen = matrix.sum(axis=0) > 0
        least = np.linalg.norm(points - matrix @ np.linalg.lstsq(matrix, points, rcond=None)[0])
        for method in ("anderson", "rpia", "plspia"):
            spline, _ = self.run_fit(points, "--parameters", "t.npy", "--knots", "k.txt", "-m", method, "--initial", "zero", "--stop-relative-gradient", 1e-9,
                                     "--max-iterations", 100000)
            control = np.array(spline["control_points"])
            self.assertTrue((control[~seen] == 0).all(), method)
            self.assertLess(np.linalg.norm(matrix.T @ (points - matrix @ control)), 1e-6, method)
            self.assertLess(np.linalg.norm(points - matrix @ control), 1.001 * least, method)

    def test_blocks_are_as_the_seed_draws_them(self):
        _, points, arguments, _ = next(self.problems(6))
        runs = [self.run_fit(points, *arguments, "-m", "rpia", "--set", f"seed={seed}", "--max-iterations", 30)[0] for seed in (1, 1, 2)]
        self.assertEqual(runs[0], runs[1])
        self.assertNotEqual(runs[0], runs[2])

    def test_what_the_spectrum_costs_is_told(self):
        _, points, arguments, _ = next(self.problems(6))
        for method in ("lspia", "mlspia", "clspia", "chebyshev", "nesterov", "alspia", "nmlspia", "pmlspia", "plspia"):
            coarse, fine = (self.run_fit(points, *arguments, "-m", method, "--max-iterations", 3, "--set", f"eigenvalue_tolerance={tolerance}")[1]["settings"]
                            for tolerance in (0.5, 1e-12))
            self.assertGreaterEqual(coarse["setup_products"], 2, method)
            self.assertGreaterEqual(fine["setup_products"], coarse["setup_products"], method)
        for method in ("cg", "salspia", "barzilai-borwein", "lin2018", "anderson", "rpia"):
            self.assertNotIn("setup_products", self.run_fit(points, *arguments, "-m", method, "--max-iterations", 3)[1]["settings"], method)


class Monotone(Cases):
    def optimum(self, matrix, values, weights, sign):
        """Least squares among coefficients that do not turn back: non-negative steps and a first value of either sign."""
        n = matrix.shape[1]
        steps = np.tril(np.ones((n, n))) * sign
        steps[:, 0] = 1
        root = np.sqrt(weights)[:, None]
        columns = root * (matrix @ steps)
        x = nnls(np.column_stack([columns, -columns[:, 0]]), root[:, 0] * values, maxiter=10000)[0]
        x[0] -= x[-1]
        return steps @ x[:-1]

    def test_the_limit_is_the_quadratic_programs(self):
        for seed in some(range(8)):
            rng = np.random.default_rng(seed)
            x = np.sort(rng.random(120))
            x[[0, -1]] = 0, 1
            sign = -1 if seed % 2 else 1
            y = sign * (np.tanh(8 * (x - 0.5)) + 0.15 * rng.normal(size=x.size))
            weights = rng.uniform(0.5, 3, x.size) if seed % 3 else np.ones(x.size)
            np.save(self.folder / "t.npy", x)
            np.savetxt(self.folder / "w.csv", weights, fmt="%.17g")
            spline, summary = self.run_fit(np.column_stack([x, y]), "-n", 14, "--parameters", "t.npy", "-m", "monotone-lspia", "--weights", "w.csv",
                                           "--stop-relative-gradient", 1e-13, "--max-iterations", 400000)
            ours = np.array(spline["control_points"])
            self.assertTrue((sign * np.diff(ours[:, 1]) >= 0).all() and (np.diff(ours[:, 0]) >= 0).all(), seed)
            best = self.optimum(design(spline["knots"][0], 3, x), y, weights, sign)
            self.assertTrue((sign * np.diff(best) < 1e-9).any(), "the data ask nothing of the constraint")
            self.assertLess(abs(ours[:, 1] - best).max(), 1e-9, seed)
            self.assertEqual(summary["termination"], "converged")

    def test_one_coordinate_and_a_stated_direction(self):
        rng = np.random.default_rng(3)
        t = np.linspace(0, 1, 90)
        points = np.column_stack([np.sin(7 * t), t + 0.1 * rng.normal(size=t.size)])
        np.save(self.folder / "t.npy", t)
        free, _ = self.run_fit(points, "-n", 12, "--parameters", "t.npy", "-m", "direct")
        one, _ = self.run_fit(points, "-n", 12, "--parameters", "t.npy", "-m", "monotone-lspia", "--set", "coordinate=1", "--set", "direction=-1",
                              "--stop-relative-gradient", 1e-13, "--max-iterations", 400000)
        one, free = (np.array(s["control_points"]) for s in (one, free))
        self.assertLess(abs(one[:, 0] - free[:, 0]).max(), 1e-9)
        self.assertTrue((np.diff(one[:, 1]) <= 0).all())
        self.assertLess(np.ptp(one[:, 1]), 0.05)  # the nearest falling function of what rises is flat

    def test_refusals(self):
        np.save(self.folder / "q.npy", np.random.default_rng(1).random((50, 2)))
        np.save(self.folder / "g.npy", np.random.default_rng(1).random((9, 9, 3)))
        for arguments, words in ((["q.npy", "-n", 10, "--closed"], "close an axis"), (["q.npy", "-n", 10, "--smooth", "1e-3"], "smooth"),
                                 (["g.npy", "-n", "5x5"], "cannot fit a grid"), (["q.npy", "-n", 10, "--set", "coordinate=2"], "2 coordinates"),
                                 (["q.npy", "-n", 10, "--set", "mu=9"], "its region of convergence"),
                                 (["q.npy", "-n", 10, "--set", "direction=2"], "-1 <= direction <= 1")):
            done = self.run_batten("fit", *arguments, "-m", "monotone-lspia", "-o", "x.json")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), (arguments, done.stderr))
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
