"""PIA on closed axes: control point i follows the sample at the peak of its B-spline; rates are those of NumPy's eigenvalues, and above 1 refused."""
import json
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import InFolder


def basis(knots, degree, t, closed):
    """A(j, i) = B_i(t_j) over the free control points."""
    knots = np.asarray(knots)
    low, high = knots[degree], knots[-degree - 1]
    inside = np.clip((t - low) % (high - low) + low if closed else t, low, high)
    full = BSpline.design_matrix(inside, knots, degree).toarray()
    free = full.shape[1] - (degree if closed else 0)
    result = np.zeros((len(t), free))
    for i in range(full.shape[1]):
        result[:, i % free] += full[:, i]
    return result


def round_from_nearest(knots, degree, t):
    """The samples of the control points: the rotation whose samples lie nearest to the B-splines' middles (means of their inner knots)."""
    count = len(t)
    period = knots[-degree - 1] - knots[degree]
    middles = np.array([np.mean(knots[i + 1:i + degree + 1]) for i in range(count)])
    gaps = [np.abs(((middles - np.roll(t, -first)) / period + 0.5) % 1 - 0.5).sum() for first in range(count)]
    return (np.arange(count) + int(np.argmin(gaps))) % count


def rate(matrix, weight=1.0):
    """Spectral radius of I - weight A, and how far rounding may move it (by the eigenvalues' condition numbers)."""
    values, vectors = np.linalg.eig(matrix)
    certain = np.linalg.norm(np.linalg.inv(vectors), axis=1).max() * np.linalg.norm(vectors, axis=0).max()
    return np.abs(1 - weight * values).max(), 1e-14 * certain


class ClosedPia(InFolder):
    def setUp(self):
        super().setUp()
        self.rng = np.random.default_rng(7)

    def parameters(self, count, spread, closed):
        gaps = np.exp(spread * self.rng.uniform(-1, 1, count))
        t = np.concatenate([[0], np.cumsum(gaps)])
        return t[:-1] / t[-1] if closed else t[:-1] / t[-2]

    def curve(self, t):
        f = self.rng.normal(size=(3, 2, 2))
        return sum(np.cos(2 * np.pi * k * t)[:, None] * f[k - 1, 0] + np.sin(2 * np.pi * k * t)[:, None] * f[k - 1, 1] for k in (1, 2, 3))

    def pia(self, data, t, degree, closed, *more):
        np.savetxt(self.folder / "p.csv", data, delimiter=",", fmt="%.17g")
        np.savetxt(self.folder / "t.txt", t, fmt="%.17g")
        done = self.run_batten("fit", "p.csv", "-m", "pia", "-n", len(data), "-p", degree, "--parameters", "t.txt", "-q", "-o", "o.json", "--summary", "s.json",
                               *(["--closed"] if closed else []), *more)
        if done.returncode not in (0, 4):
            return done, None, None
        return done, json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text())

    def test_a_torus_is_interpolated(self):
        self.assertEqual(self.run_batten("generate", "torus", "-o", "t.npy").returncode, 0)
        done = self.run_batten("fit", "t.npy", "-m", "pia", "-n", "60x40", "--closed=0,1", "--max-iterations", 40, "-q", "-o", "o.json", "--summary", "s.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary, spline = json.loads((self.folder / "s.json").read_text()), json.loads((self.folder / "o.json").read_text())
        self.assertLess(summary["max_deviation"], 1e-9)
        self.assertLess(summary["predicted_rate"], 1)
        data = np.load(self.folder / "t.npy")
        control = np.array(spline["control_points"]).reshape(spline["control_shape"] + [3])[:60, :40]
        t = [np.arange(60) / 60, np.arange(40) / 40]  # a torus has the same chords all round
        rows = [basis(k, 3, x, True) for k, x in zip(spline["knots"], t)]
        surface = np.einsum("ai,bj,ijd->abd", *rows, control)
        self.assertLess(np.abs(surface - data).max(), 1e-9)

    def test_control_points_start_at_the_sample_where_their_b_spline_peaks(self):
        for degree in range(1, 10):
            for spread in (0, 0.4):
                t = self.parameters(23, spread, True)
                data = self.curve(t)
                _, spline, _ = self.pia(data, t, degree, True, "--max-iterations", 0)
                control = np.array(spline["control_points"])[:23]
                dense = np.linspace(0, 1, 23 * 400, endpoint=False)
                peaks = dense[basis(spline["knots"][0], degree, dense, True).argmax(axis=0)]
                own = np.abs((peaks[:, None] - t[None] + 0.5) % 1 - 0.5).argmin(axis=1)
                self.assertEqual(sorted(own), list(range(23)), degree)
                self.assertLess(np.abs(control - data[own]).max(), 1e-12, (degree, spread))

    def test_closed_curves_of_every_degree_are_interpolated(self):
        for degree in range(1, 10):
            for spread in (0, 0.5, 1.5):
                count = int(self.rng.integers(degree + 2, 60))
                t = self.parameters(count, spread, True)
                data = self.curve(t)
                done, spline, summary = self.pia(data, t, degree, True, "--stop-relative-gradient", 1e-9, "--max-iterations", 200000)
                self.assertIsNotNone(spline, done.stderr)
                self.assertIn(summary["termination"], ("converged", "stalled") if degree == 1 else ("converged",), (degree, spread))  # degree 1 starts at its limit
                on_curve = basis(spline["knots"][0], degree, t, True) @ np.array(spline["control_points"])[:count]
                self.assertLess(np.abs(on_curve - data).max(), 1e-7, (degree, spread))

    def test_predicted_rates_are_those_of_the_eigenvalues(self):
        compared = 0
        for trial in range(60):
            degree, closed = int(self.rng.integers(2, 10)), bool(trial % 2)
            t = self.parameters(int(self.rng.integers(degree + 2, 90)), self.rng.choice([0, 0.5, 1.5]), closed)
            weight = float(self.rng.choice([1, 0.5, 1.7]))
            done, spline, summary = self.pia(self.curve(t), t, degree, closed, "--max-iterations", 1, "--set", f"weight={weight}")
            self.assertIsNotNone(spline, done.stderr)
            matrix = basis(spline["knots"][0], degree, t, closed)
            if closed:
                matrix = matrix[round_from_nearest(spline["knots"][0], degree, t)]
            expected, doubt = rate(matrix, weight)
            self.assertLess(expected, 1 + 1e-9)
            if doubt < 1e-9:
                compared += 1
                self.assertAlmostEqual(summary["predicted_rate"], expected, delta=1e-6, msg=str((degree, closed, len(t), weight)))
        self.assertGreater(compared, 40)

    def test_grids_with_closed_and_open_axes(self):
        for degrees, closed in (((3, 2), (True, False)), ((4, 5), (True, True)), ((2, 3), (False, True))):
            u = [self.parameters(m, 0.3, c) for m, c in zip((17, 13), closed)]
            data = np.stack(np.meshgrid(*u, indexing="ij"), axis=-1)
            data = np.concatenate([np.cos(2 * np.pi * data), np.sin(2 * np.pi * data[..., :1] + data[..., 1:])], axis=-1)
            np.save(self.folder / "g.npy", data)
            axes = ",".join(str(k) for k in range(2) if closed[k])
            done = self.run_batten("fit", "g.npy", "-m", "pia", "-n", "17x13", "-p", "%d,%d" % degrees, f"--closed={axes}", "--parametrize", "uniform",
                                   "--max-iterations", 3000, "-q", "-o", "o.json", "--summary", "s.json")
            self.assertEqual(done.returncode, 0, done.stderr)
            summary, spline = json.loads((self.folder / "s.json").read_text()), json.loads((self.folder / "o.json").read_text())
            even = [np.arange(m) / (m if c else m - 1) for m, c in zip((17, 13), closed)]
            values = []
            for knots, p, t, c in zip(spline["knots"], degrees, even, closed):
                matrix = basis(knots, p, t, c)
                values.append(np.linalg.eigvals(matrix[round_from_nearest(knots, p, t)] if c else matrix))
            self.assertAlmostEqual(summary["predicted_rate"], np.abs(1 - np.outer(*values)).max(), delta=1e-6)
            self.assertLess(summary["max_deviation"], 1e-6)

    def test_what_diverges_is_refused_and_nothing_else(self):
        refused = taken = 0
        while refused < 15 or taken < 15:
            degree = int(self.rng.integers(1, 6))
            count = int(self.rng.integers(degree + 2, 14))
            t = np.sort(self.rng.random(count))
            t -= t[0]
            cycle = np.sort(self.rng.random(count))
            cycle -= cycle[0]
            knots = np.array([cycle[i % count] + i // count for i in range(-degree, count + degree + 1)])
            matrix = basis(knots, degree, t, True)
            if np.linalg.cond(matrix) > 1e6:
                continue
            expected, doubt = rate(matrix[round_from_nearest(knots, degree, t)])
            if doubt > 1e-9 or 0.9999 < expected < 1.005 or (expected > 1 and refused > 30):
                continue
            np.savetxt(self.folder / "k.txt", knots, fmt="%.17g")
            np.savetxt(self.folder / "p.csv", self.curve(t), delimiter=",", fmt="%.17g")
            np.savetxt(self.folder / "t.txt", t, fmt="%.17g")
            done = self.run_batten("fit", "p.csv", "-m", "pia", "--closed", "--knots", "k.txt", "-p", degree, "--parameters", "t.txt", "-q", "-o", "o.json")
            if expected > 1:
                refused += 1
                self.assertEqual(done.returncode, 2, (expected, degree, count))
                said = float(done.stderr.split("the predicted rate is ")[1].split(",")[0])
                self.assertAlmostEqual(said, expected, delta=1e-5)
                self.assertIn("smaller weight", done.stderr)
            else:
                taken += 1
                self.assertIn(done.returncode, (0, 4), (expected, done.stderr))


if __name__ == "__main__":
    unittest.main()
