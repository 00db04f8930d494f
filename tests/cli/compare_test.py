"""`batten compare` and `batten plot` against distances found by NumPy and SciPy: dense sampling, refined around every low place."""
import itertools
import json
import os
import pathlib
import re
import unittest

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import least_squares, minimize, minimize_scalar

from judge import InFolder

HARD = pathlib.Path(os.environ["BATTEN_ROOT"]).parent / "shared" / "data" / "hard"


def random_axis(rng, degree, pieces, closed):
    """Knots of uneven steps, some repeated; closed ones are periodic and simple."""
    breaks = np.concatenate([[0], np.cumsum(10 ** rng.uniform(-1, 1, max(pieces, degree + 1) if closed else pieces))])
    if closed:
        turns = [breaks[:-1] + turn * breaks[-1] for turn in (-1, 0, 1)]
        return np.concatenate([*turns, [2 * breaks[-1]]])[breaks.size - 1 - degree : 2 * breaks.size - 1 + degree]
    inner = np.repeat(breaks[1:-1], rng.integers(1, degree + 1, breaks.size - 2))
    return np.concatenate([np.repeat(breaks[0], degree + 1), inner, np.repeat(breaks[-1], degree + 1)])


def random_spline(rng, degrees, pieces, closed, dim):
    knots = [random_axis(rng, p, pieces, closed) for p in degrees]
    control = rng.normal(size=[k.size - p - 1 for k, p in zip(knots, degrees)] + [dim])
    if closed:
        for axis, p in enumerate(degrees):
            control = np.moveaxis(control, axis, 0)
            control[-p:] = control[:p]
            control = np.moveaxis(control, 0, axis)
    return {"format": "batten-spline", "version": 1, "degree": list(degrees), "closed": [closed] * len(degrees),
            "knots": [k.tolist() for k in knots], "control_shape": list(control.shape[:-1]), "control_points": control.reshape(-1, dim).tolist()}


def rows_of(spline, axis, t):
    """Values of an axis's B-splines at the parameters."""
    knots, degree = np.array(spline["knots"][axis]), spline["degree"][axis]
    return BSpline.design_matrix(np.clip(t, knots[degree], knots[-degree - 1]), knots, degree).toarray()


def dense_parameters(spline, axis, per_piece):
    knots, degree = np.array(spline["knots"][axis]), spline["degree"][axis]
    breaks = np.unique(knots[degree : knots.size - degree])
    return np.concatenate([np.linspace(a, b, per_piece, endpoint=False) for a, b in zip(breaks, breaks[1:])] + [breaks[-1:]])


def curve_distances(spline, points):
    control = np.array(spline["control_points"])
    t = dense_parameters(spline, 0, 200)
    line = rows_of(spline, 0, t) @ control
    curve = BSpline(np.array(spline["knots"][0]), control, spline["degree"][0])
    result = []
    for q in points:
        square = ((line - q) ** 2).sum(axis=1)
        padded = np.concatenate([[np.inf], square, [np.inf]])
        best = square.min()
        for k in np.flatnonzero((square <= padded[:-2]) & (square <= padded[2:])):
            ends = t[max(k - 1, 0)], t[min(k + 1, t.size - 1)]
            best = min(best, minimize_scalar(lambda s: ((curve(s) - q) ** 2).sum(), bounds=ends, method="bounded", options={"xatol": 1e-12}).fun)
        result.append(np.sqrt(best))
    return np.array(result)


def low_places(square):
    """Indices of a table's entries that no neighbour undercuts, lowest first."""
    padded = np.pad(square, 1, constant_values=np.inf)
    low = (square <= padded[:-2, 1:-1]) & (square <= padded[2:, 1:-1]) & (square <= padded[1:-1, :-2]) & (square <= padded[1:-1, 2:])
    return sorted(zip(*np.nonzero(low)), key=lambda place: square[place])


def surface_distances(spline, points):
    """Piece by piece, since a surface may have a kink between two."""
    control = np.array(spline["control_points"]).reshape(*spline["control_shape"], -1)
    breaks = [dense_parameters(spline, axis, 1) for axis in (0, 1)]

    def gap(s, q):
        return np.einsum("i,j,ijd->d", rows_of(spline, 0, s[:1])[0], rows_of(spline, 1, s[1:])[0], control) - q

    best = np.full(len(points), np.inf)
    for bounds in itertools.product(*(list(zip(b, b[1:])) for b in breaks)):
        t = [np.linspace(*ends, 25) for ends in bounds]
        net = np.einsum("ai,bj,ijd->abd", rows_of(spline, 0, t[0]), rows_of(spline, 1, t[1]), control)
        step = max(np.linalg.norm(np.diff(net, axis=axis), axis=2).max() for axis in (0, 1))
        for k, q in enumerate(points):
            square = ((net - q) ** 2).sum(axis=2)
            best[k] = min(best[k], square.min())
            for i, j in low_places(square)[:3]:
                if np.sqrt(square[i, j]) - step < np.sqrt(best[k]):
                    start = [t[0][np.clip(i, 1, 23)], t[1][np.clip(j, 1, 23)]]
                    found = [minimize(lambda s: (gap(s, q) ** 2).sum(), start, bounds=bounds, method="L-BFGS-B", options={"ftol": 1e-15, "gtol": 1e-12}),
                             least_squares(gap, start, args=(q,), bounds=list(zip(*bounds)), xtol=1e-14, ftol=1e-14, gtol=1e-14)]
                    best[k] = min(best[k], *((gap(f.x, q) ** 2).sum() for f in found))
    return np.sqrt(best)


class Compare(InFolder):
    def run_batten(self, *arguments):
        done = super().run_batten(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def compared(self, spline, points):
        """Largest distance, its sample and the root mean square, as printed."""
        words = self.run_batten("compare", spline, points)
        self.assertIn("distance to the closest point of the spline", words)
        found = re.search(r"largest (\S+) at sample (\d+), rms (\S+)$", words.strip())
        return float(found[1]), int(found[2]), float(found[3])

    def judge(self, spline, points, distances, name):
        (self.folder / "s.json").write_text(json.dumps(spline))
        np.savetxt(self.folder / "p.csv", points, delimiter=",", fmt="%.17g")
        largest, sample, rms = self.compared("s.json", "p.csv")
        self.assertAlmostEqual(largest / distances.max(), 1, 5, name)  # six digits are printed
        self.assertAlmostEqual(largest / distances[sample], 1, 5, name)
        self.assertAlmostEqual(rms / np.sqrt((distances**2).mean()), 1, 5, name)

    def test_random_curves_of_every_degree(self):
        for degree in range(1, 10):
            for closed in (False, True):
                for dim in (1, 2, 3):
                    rng = np.random.default_rng([degree, closed, dim])
                    spline = random_spline(rng, [degree], 6, closed, dim)
                    points = 1.5 * rng.normal(size=(25, dim))
                    self.judge(spline, points, curve_distances(spline, points), f"degree {degree}, closed {closed}, dim {dim}")

    def test_random_surfaces(self):
        for degrees in ((1, 1), (2, 3), (3, 3), (5, 1), (4, 6)):
            for closed in (False, True):
                rng = np.random.default_rng([*degrees, closed])
                spline = random_spline(rng, degrees, 3, closed, 3)
                points = 1.5 * rng.normal(size=(6, 3))
                self.judge(spline, points, surface_distances(spline, points), f"degrees {degrees}, closed {closed}")

    def test_a_point_alone_counts_whichever_branch_it_is_near(self):
        # one at a time: nothing is hidden behind a larger distance
        rng = np.random.default_rng(1)
        spline = random_spline(rng, [3], 12, True, 2)
        points = 0.7 * rng.normal(size=(30, 2))
        distances = curve_distances(spline, points)
        for k in range(points.shape[0]):
            self.judge(spline, points[k : k + 1], distances[k : k + 1], k)

    def test_few_samples_and_few_control_points(self):
        self.run_batten("fit", HARD / "few30.csv", "-n", 4, "-q", "-o", "few.json")
        points = np.loadtxt(HARD / "few30.csv", delimiter=",")
        expected = curve_distances(json.loads((self.folder / "few.json").read_text()), points)
        largest, _, rms = self.compared("few.json", HARD / "few30.csv")
        self.assertAlmostEqual(largest, 0.272, 3)
        self.assertAlmostEqual(largest, expected.max(), 5)
        self.assertAlmostEqual(rms, np.sqrt((expected**2).mean()), 5)

    def test_a_closed_polygon_is_as_near_as_its_fit_says(self):
        self.run_batten("fit", HARD / "closed165.csv", "-t", 0.01, "--closed", "-p", 1, "-q", "-o", "o.json", "--summary", "s.json")
        said = json.loads((self.folder / "s.json").read_text())["max_deviation"]
        largest, _, _ = self.compared("o.json", HARD / "closed165.csv")
        self.assertLessEqual(largest, said * (1 + 1e-5))
        points = np.loadtxt(HARD / "closed165.csv", delimiter=",")
        expected = curve_distances(json.loads((self.folder / "o.json").read_text()), points)
        self.assertAlmostEqual(largest, expected.max(), 6)

    def test_volumes_have_distances_too(self):
        knots = [[0, 0, 1, 1]] * 3  # the unit cube
        corners = [[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
        cube = {"format": "batten-spline", "version": 1, "degree": [1, 1, 1], "knots": knots, "control_shape": [2, 2, 2], "control_points": corners}
        points = np.random.default_rng(3).uniform(-1, 2, size=(200, 3))
        distances = np.linalg.norm(np.maximum(np.maximum(-points, points - 1), 0), axis=1)
        self.judge(cube, points, distances, "cube")

    def test_plot_colours_by_the_closest_distance(self):
        # five samples one unit from the line, beside it and beyond its ends, and one on it
        line = {"format": "batten-spline", "version": 1, "degree": [1], "knots": [[0, 0, 1, 1]], "control_shape": [2], "control_points": [[0, 0], [10, 0]]}
        (self.folder / "line.json").write_text(json.dumps(line))
        np.savetxt(self.folder / "p.csv", [[9, 1], [1, 1], [5, -1], [11, 0], [-1, 0], [5, 0]], delimiter=",")
        self.run_batten("plot", "line.json", "p.csv", "-o", "p.svg")
        groups = re.findall(r'<path class="samples" d="([^"]*)"', (self.folder / "p.svg").read_text())  # one of each colour
        self.assertEqual(sorted(group.count("h 0") for group in groups), [1, 5])


if __name__ == "__main__":
    unittest.main()
