"""A given spline made fairer: the iteration step by step beside its formulas in NumPy, its limit, what it does to the energy, and refusals."""
import itertools
import json
import math
import unittest

import numpy as np

from iteration_cases import roughness
from judge import InFolder, some


def thin_plate(spline, order):
    """Over axes stretched to [0, 1]: derivatives of total order `order`, in as many ways as they can be taken; of the free control points."""
    factors = []
    for knots, degree, closed in zip(spline["knots"], spline["degree"], spline.get("closed", [False] * len(spline["knots"]))):
        length = knots[-degree - 1] - knots[degree]
        some_order = []
        for r in range(order + 1):
            matrix = roughness(knots, degree, r) * length ** (2 * r - 1)
            if closed:  # the last control points repeat the first
                n = len(matrix) - degree
                fold = np.vstack([np.eye(n), np.eye(n)[:degree]])
                matrix = fold.T @ matrix @ fold
            some_order.append(matrix)
        factors.append(some_order)
    total = 0
    for orders in itertools.product(range(order + 1), repeat=len(factors)):
        if sum(orders) == order:
            term = np.ones((1, 1))
            for factor, r in zip(factors, orders):
                term = np.kron(term, factor[r])
            total = total + math.factorial(order) / np.prod([math.factorial(r) for r in orders]) * term
    return total


class Fairing(InFolder):
    def splines(self, seed):
        """Name and a wavy spline: control points of a fit moved at random."""
        rng = np.random.default_rng(seed)
        t = np.linspace(0, 1, 120)
        u, v = np.meshgrid(np.linspace(0, 1, 20), np.linspace(0, 1, 16), indexing="ij")
        x = np.stack(np.meshgrid(*[np.linspace(0, 1, 7)] * 3, indexing="ij"), axis=-1)
        shapes = {"curve": (np.column_stack([np.cos(4 * t), np.sin(6 * t)]), ["-n", 25]),
                  "closed curve": (np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])[:-1], ["-n", 20, "--closed"]),
                  "surface": (np.stack([u, v, np.sin(5 * u) * np.cos(4 * v)], axis=-1), ["-n", "9x8"]),
                  "tube": (np.stack([np.cos(2 * np.pi * u), np.sin(2 * np.pi * u), 2 * v], axis=-1)[:-1], ["-n", "8x7", "--closed=0"]),
                  "volume": (x, ["-n", "5x4x4"])}
        for name, (points, arguments) in shapes.items():
            np.save(self.folder / "q.npy", points)
            done = self.run_batten("fit", "q.npy", *arguments, "--parametrize", "uniform", "-q", "-o", "smooth.json")
            self.assertEqual(done.returncode, 0, (name, done.stderr))
            spline = json.loads((self.folder / "smooth.json").read_text())
            control, kept = self.free(spline)
            self.store(spline, control + 0.02 * rng.normal(size=control.shape), kept)
            yield name, spline

    def free(self, spline):
        """Free control points, and where the stored ones are among them."""
        shape = spline["control_shape"]
        closed = spline.get("closed", [False] * len(shape))
        free = [n - p if c else n for n, p, c in zip(shape, spline["degree"], closed)]
        kept = np.arange(np.prod(free)).reshape(free)
        for axis, (n, f) in enumerate(zip(shape, free)):
            kept = np.take(kept, np.arange(n) % f, axis=axis)
        kept = kept.ravel()
        first = [int(np.flatnonzero(kept == i)[0]) for i in range(int(np.prod(free)))]
        return np.array(spline["control_points"])[first], kept

    def store(self, spline, control, kept):
        spline["control_points"] = control[kept].tolist()
        (self.folder / "wavy.json").write_text(json.dumps(spline))

    def fair(self, *arguments):
        done = self.run_batten("fair", "wavy.json", *arguments, "-o", "fair.json", "--summary", "s.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        spline, summary = [json.loads((self.folder / name).read_text()) for name in ("fair.json", "s.json")]
        return self.free(spline)[0], summary

    def inner(self, spline):
        shape = spline["control_shape"]
        closed = spline.get("closed", [False] * len(shape))
        free = [n - p if c else n for n, p, c in zip(shape, spline["degree"], closed)]
        inside = np.ones(free, bool)
        for axis, c in enumerate(closed):
            if not c:
                inside[tuple(slice(None) if k != axis else [0, -1] for k in range(len(free)))] = False
        return np.flatnonzero(inside.ravel())

    def limit(self, d, control, weights, moving):
        """The moving ones' part of (I - W + W D) P = (I - W) P0."""
        m = np.diag(1 - weights) + weights[:, None] * d
        rest = np.setdiff1d(np.arange(len(control)), moving)
        result = control.copy()
        right = ((1 - weights)[:, None] * control)[moving] - m[np.ix_(moving, rest)] @ control[rest]
        result[moving] = np.linalg.solve(m[np.ix_(moving, moving)], right)
        return result

    def test_steps_and_limit(self):
        for seed in some(range(3)):
            for name, spline in self.splines(seed):
                order = 1 + seed
                d = thin_plate(spline, order)
                control, _ = self.free(spline)
                rng = np.random.default_rng(seed)
                scale = 1 / np.diag(d).max()
                weights = np.minimum(rng.choice([0, 0.3, 3], len(control)) * scale, 0.9)
                np.savetxt(self.folder / "w.csv", weights, fmt="%.17g")
                inner = self.inner(spline)
                moving = inner[weights[inner] > 0]
                common = ["--order", order, "--weights", "w.csv"]
                m = np.diag(1 - weights) + weights[:, None] * d
                mine = control.copy()
                free_part = m[np.ix_(moving, moving)]
                step = 1 / abs(free_part).sum(axis=1)
                for _ in range(10):
                    bracket = (1 - weights)[:, None] * (control - mine) - weights[:, None] * (d @ mine)
                    mine[moving] += step[:, None] * bracket[moving]
                ten, summary = self.fair(*common, "-m", "lin2018", "--max-iterations", 10)
                size = np.ptp(control)
                self.assertLess(abs(ten - mine).max(), 1e-11 * size, (name, seed))
                self.assertEqual(summary["moving"], inner.tolist())
                best = self.limit(d, control, weights, moving)
                for more in (["-m", "direct"], ["-m", "lin2018", "--stop-relative-gradient", 1e-13, "--max-iterations", 100000],
                             ["-m", "cg", "--stop-relative-gradient", 1e-13], []):
                    ours, summary = self.fair(*common, *more)
                    self.assertLess(abs(ours - best).max(), 1e-9 * size, (name, seed, more))
                    for key, points in (("energy_before", control), ("energy_after", best)):
                        energy = (points * (d @ points)).sum()
                        self.assertLess(abs(summary[key] - energy), 1e-9 * (control * (d @ control)).sum(), (name, seed, key))
                    self.assertLess(summary["energy_after"], summary["energy_before"])
                    self.assertAlmostEqual(summary["largest_move"], np.linalg.norm(best - control, axis=1).max(), delta=1e-9 * size)

    def test_only_stated_points_move_ends_too(self):
        name, spline = next(self.splines(4))
        d, (control, _) = thin_plate(spline, 2), self.free(spline)
        moving = np.array([0, 3, 4])
        ours, summary = self.fair("--weight", 1e-6, "--points", "4,0,3")
        self.assertEqual(summary["moving"], moving.tolist())
        self.assertLess(abs(ours - self.limit(d, control, np.full(len(control), 1e-6), moving)).max(), 1e-9)
        np.savetxt(self.folder / "p.csv", moving, fmt="%d")
        again, _ = self.fair("--weight", 1e-6, "--points", "p.csv")
        np.testing.assert_array_equal(ours, again)

    def test_the_chosen_points_gain_most(self):
        for name, spline in self.splines(5):
            d, (control, _) = thin_plate(spline, 2), self.free(spline)
            gains = {}
            for i in self.inner(spline):
                others = np.delete(np.arange(len(control)), i)
                alone = control.copy()
                alone[i] = -d[i, others] @ control[others] / d[i, i]
                gains[i] = (control * (d @ control)).sum() - (alone * (d @ alone)).sum()
            top = sorted(sorted(gains, key=gains.get)[-3:])
            _, summary = self.fair("--automatic", 3)
            self.assertEqual(summary["moving"], top, name)

    def test_a_domain_of_any_length_and_place(self):
        name, spline = next(self.splines(6))
        ours, _ = self.fair("--weight", 1e-5)
        spline["knots"] = [[5 + 40 * k for k in spline["knots"][0]]]
        (self.folder / "wavy.json").write_text(json.dumps(spline))
        again, _ = self.fair("--weight", 1e-5)
        np.testing.assert_allclose(ours, again, rtol=0, atol=1e-10)

    def test_weight_nothing_leaves_all_where_it_is(self):
        for name, spline in self.splines(7):
            ours, _ = self.fair("--weight", 0)
            np.testing.assert_array_equal(ours, self.free(spline)[0])

    def test_refusals(self):
        next(self.splines(8))
        np.savetxt(self.folder / "w.csv", np.ones(3))
        for arguments, words in ((["--weight", 1], "0 <= weight < 1"), (["--weight", "-0.1"], "0 <= weight < 1"), (["--weight", "nan"], "0 <= weight < 1"),
                                 (["--weights", "w.csv"], "3 weights for 25"), (["--order", 4], "1 to 3"), (["--order", 0], "1 to 3"),
                                 (["--points", "25"], "there are 25"), (["--points", "3,3"], "named twice"), (["--points", "1-5"], "a list like"),
                                 (["--automatic", 0], "--automatic"), (["--automatic", 2, "--points", "1"], "--points"),
                                 (["-m", "pia"], "no iteration on the normal equations"), (["-m", "fairing-pia"], "is for samples"),
                                 (["-m", "nothing"], "unknown method"), (["--set", "mu=1"], "has no settings"), (["-m", "lspia", "--set", "mu=-1"], "0 < mu"),
                                 (["--max-iterations", "-1", "-m", "cg"], "max_iterations"), (["-o", "wavy.json"], "wavy.json")):
            done = self.run_batten("fair", "wavy.json", "-o", "x.json", *arguments)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), (arguments, done.stderr))
            self.assertIn(words, done.stderr)
            self.assertFalse((self.folder / "x.json").exists())

    def test_weights_that_hold_nothing(self):
        t = np.linspace(0, 2 * np.pi, 100)[:-1]
        np.save(self.folder / "q.npy", np.column_stack([np.cos(t), np.sin(t)]))
        self.assertEqual(self.run_batten("fit", "q.npy", "-n", 20, "--closed", "-q", "-o", "circle.json").returncode, 0)
        done = self.run_batten("fair", "circle.json", "--weight", "0.999999999999999", "-o", "x.json")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("weights so near 1", done.stderr)

    def test_a_straight_curve_of_degree_one(self):
        (self.folder / "wavy.json").write_text(json.dumps({"format": "batten-spline", "version": 1, "degree": [1], "knots": [[0, 0, 0.5, 1, 1]], "control_shape": [3],
                                                           "control_points": [[0, 0], [5, 1], [1, 0]]}))
        ours, _ = self.fair("--order", 1, "--weight", 0.999999999)
        np.testing.assert_allclose(ours, [[0, 0], [0.5, 0], [1, 0]], atol=1e-6)
        done = self.run_batten("fair", "wavy.json", "-o", "x.json")
        self.assertIn("above the degree 1", done.stderr)


if __name__ == "__main__":
    unittest.main()
