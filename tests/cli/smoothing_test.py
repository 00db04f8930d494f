"""Smoothing judged by the stacked least-squares problem in extended precision: rows of B-splines by their recursion, Householder's reflections with sorted
rows and pivoted columns. Cases are generated: units of the parameters, factors, weights and orders over many decades."""
import json
import unittest

import numpy as np
from scipy.interpolate import BSpline
from scipy.sparse import csr_matrix, kron, vstack
from scipy.sparse.linalg import spsolve

from judge import InFolder, some

EXTENDED = np.longdouble


def basis(knots, degree, t, order=0):
    """Derivatives of the B-splines, (t x controls), by the recursion of Cox and de Boor."""
    k, t = np.asarray(knots, EXTENDED), np.asarray(t, EXTENDED)
    last = np.nonzero(k[:-1] < k[1:])[0].max()
    b = np.zeros((t.size, k.size - 1), EXTENDED)
    b[np.arange(t.size), np.clip(np.searchsorted(k, t, side="right") - 1, degree, last)] = 1
    for q in range(1, degree + 1):
        n = b.shape[1] - 1
        span = k[q:q + n + 1] - k[:n + 1]
        inverse = np.where(span > 0, 1 / np.where(span > 0, span, 1), 0)
        if q <= degree - order:
            b = (t[:, None] - k[:n]) * inverse[:n] * b[:, :n] + (k[q + 1:q + 1 + n] - t[:, None]) * inverse[1:] * b[:, 1:]
        else:
            b = q * (inverse[:n] * b[:, :n] - inverse[1:] * b[:, 1:])
    return b


def rough_rows(knots, degree, order):
    """Rows whose squares sum to the integral of the squared derivative, the domain stretched to [0, 1]."""
    node, weight = np.polynomial.legendre.leggauss(degree - order + 1)
    breaks = np.unique(np.array(knots)[degree:len(knots) - degree]).astype(EXTENDED)
    half = np.diff(breaks)[:, None] / 2
    stretch = (breaks[-1] - breaks[0]) ** (2 * order - 1)
    return np.sqrt(stretch * (half * weight).ravel())[:, None] * basis(knots, degree, (breaks[:-1, None] + half * (1 + node)).ravel(), order)


def stacked(knots, degree, t, points, weights, factor, order):
    """Rows and right-hand sides of mean square plus factor times roughness."""
    root = np.sqrt(weights.astype(EXTENDED) / weights.astype(EXTENDED).sum())[:, None]
    rough = np.sqrt(EXTENDED(factor)) * rough_rows(knots, degree, order)
    zero = np.zeros((len(rough), points.shape[1]), EXTENDED)
    return np.concatenate([root * basis(knots, degree, t), rough]), np.concatenate([root * points, zero])


def least_squares(a, b):
    sort = np.argsort(-abs(a).max(axis=1), kind="stable")
    a, b, n = a[sort], b[sort], a.shape[1]
    places = np.arange(n)
    for j in range(n):
        column = j + int(((a[j:, j:] ** 2).sum(axis=0)).argmax())
        a[:, [j, column]], places[[j, column]] = a[:, [column, j]], places[[column, j]]
        row = j + int(abs(a[j:, j]).argmax())
        a[[j, row]], b[[j, row]] = a[[row, j]], b[[row, j]]
        v = a[j:, j].copy()
        v[0] += np.copysign(np.sqrt((v ** 2).sum()), v[0])
        scale = 2 / (v ** 2).sum()
        a[j:, j:] -= np.outer(v, scale * (v @ a[j:, j:]))
        b[j:] -= np.outer(v, scale * (v @ b[j:]))
    x = np.zeros((n, b.shape[1]), EXTENDED)
    for j in range(n - 1, -1, -1):
        x[j] = (b[j] - a[j, j + 1:] @ x[j + 1:]) / a[j, j]
    result = np.empty_like(x)
    result[places] = x
    return result


def squares(a, b, x):
    return ((a @ x - b) ** 2).sum()


class Smoothing(InFolder):
    def attempt(self, points, *arguments, t=None, weights=None):
        np.save(self.folder / "p.npy", points)
        arguments = list(arguments)
        for flag, values in (("--parameters", t), ("--weights", weights)):
            if values is not None:
                np.savetxt(self.folder / f"{flag[2:]}.txt", np.ravel(values), fmt="%.17g")
                arguments += [flag, f"{flag[2:]}.txt"]
        return self.run_batten("fit", "p.npy", *arguments, "-q", "-o", "o.json", "--summary", "s.json")

    def fit(self, points, *arguments, **given):
        done = self.attempt(points, *arguments, **given)
        self.assertIn(done.returncode, (0, 4), done.stderr)
        return json.loads((self.folder / "o.json").read_text()), json.loads((self.folder / "s.json").read_text())

    def judge(self, spline, t, points, weights, factor, order, closed=False):
        """The functional is at its minimum, as far as rounded control points can be."""
        knots, degree = spline["knots"][0], spline["degree"][0]
        a, b = stacked(knots, degree, t, points, weights, factor, order)
        control = np.array(spline["control_points"]).astype(EXTENDED)
        if closed:  # the last control points are the first ones again
            a[:, :degree] += a[:, -degree:]
            a, control = a[:, :-degree], control[:-degree]
        best = least_squares(a, b)
        reached = squares(a, b, control)
        self.assertLessEqual(reached, (1 + 1e-8) * max(squares(a, b, best), squares(a, b, best.astype(float).astype(EXTENDED))))

    def test_the_functional_is_at_its_minimum(self):
        for seed in some(range(36)):
            rng = np.random.default_rng(seed)
            count, order, degree = int(rng.integers(60, 200)), int(rng.integers(2, 4)), int(rng.integers(3, 6))
            size = max(int(rng.integers(8, 50)), degree + 1)
            unit, factor = 10.0 ** rng.uniform(-6, 6), 10.0 ** rng.uniform(-14, 6)
            place = np.sort(rng.random(count))
            points = np.column_stack([place, np.sin(9 * place)]) + rng.normal(0, 0.02, (count, 2))
            weights = 10.0 ** rng.uniform(-7.5, 7.5, count) if seed % 2 else np.ones(count)
            spline, _ = self.fit(points, "--smooth", repr(factor), "--smooth-order", order, "-n", size, "-p", degree, t=place * unit, weights=weights)
            with self.subTest(seed=seed, order=order, unit=unit, factor=factor):
                self.judge(spline, place * unit, points, weights, factor, order)

    def test_closed_curves_too(self):
        for seed in some(range(12)):
            rng = np.random.default_rng(300 + seed)
            count, order, degree = int(rng.integers(60, 200)), int(rng.integers(2, 4)), int(rng.integers(3, 6))
            t = np.sort(rng.random(count))
            points = np.column_stack([np.cos(2 * np.pi * t), np.sin(4 * np.pi * t)]) + rng.normal(0, 0.02, (count, 2))
            weights = 10.0 ** rng.uniform(-5, 5, count) if seed % 2 else np.ones(count)
            factor = "auto" if seed % 3 == 0 else 10.0 ** rng.uniform(-14, 4)
            size = int(rng.integers(degree + 1, 40))
            spline, summary = self.fit(points, "--closed", "--smooth", factor, "--smooth-order", order, "-n", size, "-p", degree, t=t, weights=weights)
            with self.subTest(seed=seed, order=order, factor=factor):
                self.judge(spline, t, points, weights, summary["smoothing"], order, closed=True)

    def test_weights_may_be_far_apart(self):
        for seed in some(range(18)):
            rng = np.random.default_rng(100 + seed)
            count, degree = int(rng.integers(60, 200)), int(rng.integers(2, 6))
            place = np.sort(rng.random(count))
            points = np.column_stack([place, np.sin(9 * place)]) + rng.normal(0, 0.02, (count, 2))
            weights = 10.0 ** rng.uniform(-7.5, 7.5, count)
            spline, _ = self.fit(points, "-n", int(rng.integers(degree + 1, count // 3)), "-p", degree, t=place, weights=weights)
            with self.subTest(seed=seed, degree=degree):
                self.judge(spline, place, points, weights, 0, min(degree, 2))

    def test_cross_validation_comes_near_the_best_factor(self):
        ratios = []
        for seed in some(range(18)):
            rng = np.random.default_rng(200 + seed)
            count, order = int(rng.integers(50, 200)), int(rng.integers(2, 4))
            t = (np.sort(rng.random(count)) if seed % 2 else np.linspace(0, 1, count)) * 10.0 ** rng.uniform(-6, 6)
            turns = rng.uniform(3, count / 3) / np.ptp(t)
            clean = np.column_stack([np.sin(turns * t), rng.normal() * np.cos(turns * t / 2)])
            points = clean + rng.normal(0, 10 ** rng.uniform(-2.5, -0.5), clean.shape)
            spline, summary = self.fit(points, "--smooth", "auto", "--smooth-order", order, t=t)
            knots = spline["knots"][0]
            values = basis(knots, 3, t).astype(float)
            error = lambda control: np.sqrt(((values @ control - clean) ** 2).mean())
            errors = []
            for decades in np.arange(-8, 8.1, 0.5):
                a, b = stacked(knots, 3, t, points, np.ones(count), summary["smoothing"] * 10 ** decades, order)
                scale = np.sqrt((a ** 2).sum(axis=0)).astype(float)
                errors.append(error(np.linalg.lstsq(a.astype(float) / scale, b.astype(float), rcond=None)[0] / scale[:, None]))
            ratios.append(error(np.array(spline["control_points"])) / min(errors))
        self.assertLess(np.median(ratios), 1.05)
        self.assertLess(max(ratios), 2.5)

    def test_a_clouds_factor_comes_near_the_best_one(self):
        ratios = []
        for seed in some(range(6)):
            rng = np.random.default_rng(400 + seed)
            count, noise = 20000, 10.0 ** rng.uniform(-3, -0.5)
            place = [rng.random((count, 2)), rng.random((count, 2)) ** 2, rng.normal(0, 0.2, (2 * count, 2)) % 1][seed % 3]
            if seed % 3 == 2:  # a hole
                place = place[np.hypot(*(place.T - 0.4)) > 0.15][:count]
            x, y = (place.T - 0.5) * (4 if seed < 3 else 20)
            clean = x * np.exp(-x * x - y * y)
            points = np.column_stack([place, clean + rng.normal(0, noise, clean.size)])
            spline, summary = self.fit(points, "--project", "xy", "--smooth", "auto", "-n", "72x75")
            knots = [np.array(k) for k in spline["knots"]]
            a, b = (BSpline.design_matrix(np.clip(t, k[3], k[-4]), k, 3).toarray() for t, k in zip(place.T, knots))
            rows = vstack(
                [csr_matrix(np.einsum("ki,kj->kij", a[s:s + 500], b[s:s + 500]).reshape(-1, a.shape[1] * b.shape[1])) for s in range(0, clean.size, 500)])
            gram = lambda r: r.T @ r
            rough = [csr_matrix(gram(rough_rows(k, 3, 2)).astype(float)) for k in knots]
            mass = [csr_matrix(gram(rough_rows(k, 3, 0)).astype(float)) for k in knots]
            penalty = kron(rough[0], mass[1]) + kron(mass[0], rough[1])
            error = lambda heights: np.sqrt(((rows @ heights - clean) ** 2).mean())
            errors = []
            for decades in np.arange(-2, 2.1, 0.5):
                system = rows.T @ rows / clean.size + summary["smoothing"] * 10 ** decades * penalty
                errors.append(error(spsolve(system.tocsc(), rows.T @ points[:, 2] / clean.size)))
            ratios.append(error(np.array(spline["control_points"])[:, 2]) / min(errors))
        self.assertLess(np.median(ratios), 1.05)
        self.assertLess(max(ratios), 2.5)

    def test_a_large_net_through_few_samples_is_smoothed_too(self):
        for count in (8, 50):
            place = np.random.default_rng(14).random((count, 2))
            spline, _ = self.fit(np.column_stack([place, np.sin(5 * place[:, 0])]), "--project", "xy", "--smooth", "auto", "-n", "72x75")
            self.assertTrue(np.isfinite(spline["control_points"]).all())

    def sheet(self):
        rng = np.random.default_rng(11)
        place = rng.random((900, 2))
        u, v = np.linspace(0, 1, 20), np.linspace(0, 1, 24)
        grid = np.stack([*np.meshgrid(u, v, indexing="ij"), np.sin(5 * u)[:, None] * np.cos(4 * v) + rng.normal(0, 0.05, (20, 24))], axis=-1)
        t = np.linspace(0, 1, 80)
        return ((np.column_stack([t, np.sin(7 * t) + rng.normal(0, 0.05, 80)]), ("-n", 12)), (grid, ("-n", "8x9")),
                (np.column_stack([place, np.sin(5 * place[:, 0]) * place[:, 1] + rng.normal(0, 0.05, 900)]), ("--project", "xy", "-n", "7x8")))

    def test_weights_count_by_their_ratios(self):
        for points, arguments in self.sheet():
            count = points.size // points.shape[-1]
            uneven = 10.0 ** np.random.default_rng(12).uniform(-2, 2, count)
            for method in ("direct", "cg", "lspia", "mlspia", "clspia", "chebyshev", "nesterov", "barzilai-borwein"):
                for smoothing in ((), ("--smooth", "auto"), ("--smooth", 1e-6)):
                    def control(weights):
                        return np.array(self.fit(points, *arguments, "-m", method, "--max-iterations", 300, *smoothing, weights=weights)[0]["control_points"])
                    plain, usual = control(None), control(uneven)
                    with self.subTest(method=method, smoothing=smoothing, arguments=arguments):
                        for weight in (2, 7, 1e-200, 1e200):  # alike: as none
                            np.testing.assert_array_equal(control(np.full(count, weight)), plain)
                        for factor in (2.0 ** -7, 2.0 ** 660, 2.0 ** -660):
                            np.testing.assert_array_equal(control(uneven * factor), usual)
                        if method == "direct":
                            self.assertLess(abs(control(uneven * 1e-200) - usual).max(), 1e-10)

    def test_the_size_of_weights_is_in_gradients_alone(self):
        points, arguments = self.sheet()[0]
        reports = [self.fit(points, *arguments, "-m", "lspia", "--stop-gradient", 1e-6 * weight, weights=np.full(80, weight))[1] for weight in (1, 8)]
        self.assertEqual(reports[0]["iterations"], reports[1]["iterations"])
        self.assertEqual(8 * reports[0]["gradient_norm"], reports[1]["gradient_norm"])
        self.assertEqual(reports[0]["settings"]["mu"], 8 * reports[1]["settings"]["mu"])
        done = self.attempt(points, *arguments, weights=np.where(np.arange(80) == 3, 1e-200, 1e200))
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("weights: 1e-200 and 1e+200 are too far apart", done.stderr)
        done = self.attempt(points, "-m", "pia", weights=np.full(80, 3))
        self.assertEqual(done.returncode, 2)
        self.assertIn("method pia cannot weigh samples", done.stderr)

    def test_weights_of_extreme_size_leave_the_functional_at_its_minimum(self):
        rng = np.random.default_rng(13)
        t = np.sort(rng.random(100))
        points = np.column_stack([t, np.sin(9 * t)]) + rng.normal(0, 0.02, (100, 2))
        for size in (1e-200, 1e200):
            weights = size * 10.0 ** rng.uniform(-1, 1, 100)
            for method in ("direct", "cg"):
                spline, _ = self.fit(points, "-m", method, "--smooth", 1e-6, "-n", 20, t=t, weights=weights)
                self.judge(spline, t, points, weights / size, 1e-6, 2)

    def test_a_factor_beyond_rounding_is_refused_with_the_largest_one(self):
        for points, arguments in self.sheet():
            count = points.size // points.shape[-1]
            for weights in (None, np.linspace(1, 2, count)):
                for order in (2, 3):
                    for method in ("auto", "direct", "cg"):
                        smooth = lambda factor: self.attempt(points, *arguments, "-m", method, "--smooth", factor, "--smooth-order", order, weights=weights)
                        done = smooth(1e300)
                        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
                        self.assertRegex(done.stderr, "the largest factor that method .* can tell from an infinite one here is")
                        largest = 0.9 * float(done.stderr.split()[-1])
                        # an iteration may say that it did not come to the minimum there
                        self.assertIn(smooth(largest).returncode, (0, 4) if method == "cg" else (0,), smooth(largest).stderr)

    def test_places_on_a_line_determine_no_surface(self):
        t = np.random.default_rng(1).random(230)
        np.savetxt(self.folder / "line.csv", np.column_stack([t, t]), delimiter=",", fmt="%.17g")
        np.savetxt(self.folder / "height.csv", np.sin(5 * t) + t * t, fmt="%.17g")
        for factor in ("auto", 0.5):
            done = self.run_batten("fit", "height.csv", "--parameters", "line.csv", "-n", "14x11", "--smooth", str(factor), "--smooth-order", "3")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("no factor does", done.stderr)

    def test_an_iteration_that_ends_before_the_minimum_missed_it(self):
        rng = np.random.default_rng(3)
        at = rng.random((3000, 3))
        np.save(self.folder / "at.npy", at)
        np.save(self.folder / "q.npy", (np.sin(5 * at[:, 0]) * np.cos(4 * at[:, 1]) + at[:, 2] + rng.normal(0, 0.01, 3000))[:, None])
        fit = lambda *more: self.run_batten("fit", "q.npy", "--parameters", "at.npy", "-n", "8x8x8", "--smooth", "10", *more)
        self.assertEqual(fit("-m", "direct").returncode, 0)
        short = fit("-m", "cg")
        self.assertEqual(short.returncode, 4, short.stdout)
        self.assertIn("missed      relative gradient", short.stdout)
        self.assertEqual(fit("-m", "cg", "--max-iterations", "50").returncode, 0)  # as many as were asked for

    def test_an_iteration_whose_gradient_says_too_little_missed_the_minimum(self):
        rng = np.random.default_rng(495)
        t = np.sort(rng.random(40))
        np.save(self.folder / "q.npy", np.column_stack([3 * t, np.sin(7 * t) + 0.05 * rng.normal(size=40)]))
        np.save(self.folder / "u.npy", t)
        fit = lambda size, method: self.run_batten("fit", "q.npy", "--parameters", "u.npy", "-n", size, "--degree", "5", "--smooth-order", "3",
                                                   "--smooth", "1e-8", "-m", method)
        self.assertEqual([fit(12, "cg").returncode, fit(30, "direct").returncode], [0, 0])
        short = fit(30, "cg")
        self.assertEqual(short.returncode, 4, short.stdout)
        self.assertIn("missed      least functional: stated 1e-08", short.stdout)

    def test_no_unit_counts(self):
        rng = np.random.default_rng(5)
        t = np.sort(rng.random(300))
        points = np.column_stack([np.sin(6 * t * (1 + t)), np.cos(5 * t)]) + rng.normal(0, 0.1, (300, 2))
        for order, degree in ((2, 3), (3, 4)):
            for factor in ("auto", 1e-8):
                def control(unit):
                    return np.array(self.fit(points, "--smooth", factor, "--smooth-order", order, "-p", degree, t=t * unit)[0]["control_points"])
                usual = control(1)
                for exponent in (-20, -3, 1, 17):
                    np.testing.assert_array_equal(control(2.0 ** exponent), usual)
                for unit in (1e-6, 1000, 3.7e5):
                    self.assertLess(abs(control(unit) - usual).max(), 1e-9, (order, factor, unit))
        place = np.arange(400)
        wave = np.sin(place / 60)
        noise = rng.normal(0, 0.02, 400)
        for spacing in (1, 1000, 10000, 1e8):  # a coordinate so much larger than the noise
            spline, summary = self.fit(np.column_stack([place * spacing, wave + noise]), "--smooth", "auto", t=place)
            height = BSpline(np.array(spline["knots"][0]), np.array(spline["control_points"])[:, 1], 3)(place)
            self.assertLess(np.sqrt(((height - wave) ** 2).mean()), 0.006)
            self.assertLess(abs(summary["noise_level"] / 0.02 - 1), 0.1)

    def test_the_size_follows_from_the_samples(self):
        rng = np.random.default_rng(6)
        t = np.linspace(0, 1, 2000)
        for periods, noise, most in ((120, 0.05, 0.04), (3, 0.05, 0.01)):
            clean = np.sin(2 * np.pi * periods * t)
            spline, summary = self.fit(np.column_stack([t, clean + rng.normal(0, noise, t.size)]), "--smooth", "auto", t=t)
            height = BSpline(np.array(spline["knots"][0]), np.array(spline["control_points"])[:, 1], 3)(t)
            self.assertLess(np.sqrt(((height - clean) ** 2).mean()), most)
            self.assertNotIn("sought with", str(summary.get("notes")))
            self.assertLess(spline["control_shape"][0], 10 * summary["degrees_of_freedom"] + 10)
        t = np.linspace(0, 1, 5000)
        _, summary = self.fit(np.column_stack([t, np.sin(9 * t) + rng.normal(0, 0.05, t.size)]), "--smooth", "auto", t=t)
        self.assertIn("the smooth spline was sought with 2000 control points", str(summary["notes"]))

    def test_parameters_may_repeat(self):
        rng = np.random.default_rng(7)
        for times in (2, 20):
            t = np.repeat(np.linspace(0, 1, 60), times)
            points = np.column_stack([t, np.sin(9 * t) + rng.normal(0, 0.1, t.size)])
            for arguments in (["auto"], [1e-6], ["auto", "-n", 40], ["auto", "-n", 100], ["auto", "--smooth-order", 3]):
                spline, summary = self.fit(points, "--smooth", *arguments, t=t)
                order = 3 if 3 in arguments else 2
                self.judge(spline, t, points, np.ones(t.size), summary["smoothing"], order)
                height = BSpline(np.array(spline["knots"][0]), np.array(spline["control_points"])[:, 1], 3)(t)
                self.assertLess(np.sqrt(((height - np.sin(9 * t)) ** 2).mean()), 0.05)

    def test_a_grid_has_one_functional_with_weights_and_without(self):
        rng = np.random.default_rng(8)
        u, v = np.linspace(0, 1, 20), np.linspace(0, 1, 24)
        heights = np.sin(5 * u)[:, None] * np.cos(4 * v) + rng.normal(0, 0.05, (20, 24))
        np.save(self.folder / "h.npy", heights)
        for weights in (np.ones(480), 10.0 ** rng.uniform(-1, 1, 480)):
            np.savetxt(self.folder / "w.txt", weights, fmt="%.17g")
            for factor, order in ((1e-6, 2), (1e-3, 2), (1e-8, 3)):
                done = self.run_batten("fit", "h.npy", "--heights", "--smooth", factor, "--smooth-order", order, "-n", "9x10", "--weights", "w.txt", "-q", "-o", "o.json")
                self.assertEqual(done.returncode, 0, done.stderr)
                spline = json.loads((self.folder / "o.json").read_text())
                a, r = [], []
                for axis, t in enumerate((u, v)):
                    knots = spline["knots"][axis]
                    a.append(basis(knots, 3, t))
                    r.append(np.sqrt(EXTENDED(factor)) * rough_rows(knots, 3, order))
                mean = [x / np.sqrt(EXTENDED(len(x))) for x in a]
                root = np.sqrt(weights.astype(EXTENDED) / weights.sum())[:, None]
                rows = np.concatenate([root * np.kron(*a), np.kron(r[0], mean[1]), np.kron(mean[0], r[1]), np.kron(*r)])
                right = np.zeros((len(rows), 1), EXTENDED)
                right[:480] = root * heights.reshape(-1, 1)
                best = least_squares(rows, right)
                reached = np.array(spline["control_points"])[:, 2:].astype(EXTENDED)
                self.assertLessEqual(squares(rows, right, reached), (1 + 1e-8) * squares(rows, right, best))

    def test_the_report_is_of_the_fit_as_it_is(self):
        rng = np.random.default_rng(9)
        t = np.linspace(0, 1, 120)
        points = np.column_stack([t, np.sin(9 * t) + rng.normal(0, 0.1, 120)])
        for exact in ([], [0, 60, 119]):
            for weight in (1, 1e6):
                held = ["--interpolate", ",".join(map(str, exact))] if exact else []
                spline, summary = self.fit(points, "--smooth", "auto", "-n", 30, *held, t=t, weights=np.full(120, weight))
                a, _ = stacked(spline["knots"][0], 3, t, points, np.ones(120), summary["smoothing"], 2)
                a = a.astype(float)
                inverse = np.linalg.inv(a.T @ a)
                hat = inverse @ a[:120].T @ a[:120]
                if exact:
                    c = a[exact]
                    hat -= inverse @ c.T @ np.linalg.solve(c @ inverse @ c.T, c @ hat)
                self.assertAlmostEqual(summary["degrees_of_freedom"], np.trace(hat), 6)
                rest = points - np.sqrt(120) * a[:120] @ np.array(spline["control_points"])
                self.assertAlmostEqual(summary["noise_level"], np.sqrt((rest ** 2).sum() / (120 - np.trace(hat))), 9)

    def test_what_has_no_effect_is_refused(self):
        t = np.linspace(0, 1, 60)
        points = np.column_stack([t, np.sin(9 * t)])
        for words, *arguments in (("method pia cannot smooth", "-m", "pia"), ("cannot limit the number of control points", "--max-control-points", 10)):
            done = self.attempt(points, "--smooth", "auto", *arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
