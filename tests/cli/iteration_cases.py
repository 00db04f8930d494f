"""What the tests of iterations share: samples of a curve, a grid and a cloud with the dense matrices that a fit of them has."""
import json
import subprocess

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD, InFolder

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


def roughness(knots, degree, order):
    """Integrals of products of the B-splines' derivatives, Gauss's rule on each span."""
    knots = np.array(knots)
    count = len(knots) - degree - 1
    nodes, factors = np.polynomial.legendre.leggauss(degree + 1)
    result = np.zeros((count, count))
    for a, b in zip(knots[degree:count], knots[degree + 1:count + 1]):
        if b > a:
            rows = BSpline(knots, np.eye(count), degree)((a + b) / 2 + (b - a) / 2 * nodes, nu=order)
            result += rows.T * (factors * (b - a) / 2) @ rows
    return result


def by_factors(normal, control, steps, factor):
    norms = []
    for k in range(steps + 1):
        r = normal.gradient(control)
        norms.append(np.linalg.norm(r))
        if k < steps:
            control = control + factor(k) * r
    return control, norms


class Cases(InFolder):
    def run_fit(self, points, *arguments):
        np.save(self.folder / "q.npy", points)
        done = subprocess.run([BATTEN, "fit", "q.npy", *map(str, arguments), "--history", "-q", "-o", "o.json", "--summary", "s.json"], cwd=self.folder,
                              capture_output=True, text=True, timeout=GUARD)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        return [json.loads((self.folder / name).read_text()) for name in ("o.json", "s.json")]

    def best_of_all(self, seed):
        """Name, samples, arguments and the direct answer's control points: as they are, weighted, smoothed, closed."""
        for name, points, arguments, _ in self.problems(seed):
            np.savetxt(self.folder / "w.csv", np.random.default_rng(1).uniform(0.5, 3, points.size // points.shape[-1]), fmt="%.17g")
            cases = [arguments, [*arguments, "--weights", "w.csv"], [*arguments, "--smooth", "1e-4"]]
            if name == "curve":
                cases.append(["-n", 15, "--closed"])
            for case in cases:
                yield name, points, case, np.array(self.run_fit(points, *case, "-m", "direct")[0]["control_points"])

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
