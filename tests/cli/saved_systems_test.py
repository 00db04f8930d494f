"""Saved systems: assembled in parts, merged and solved, judged by dense least squares of all samples in SciPy; coarser knots; what is refused;
damaged files."""
import json
import struct
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import InFolder, control_points, some


def collocation(spline, axis, t):
    """(m x free control points)."""
    knots, degree = np.array(spline["knots"][axis]), spline["degree"][axis]
    a = BSpline.design_matrix(np.asarray(t, float), knots, degree).toarray()
    if not spline.get("closed", [False] * 9)[axis]:
        return a
    n = a.shape[1] - degree
    a[:, :degree] += a[:, n:]
    return a[:, :n]


def free(spline):
    """Control points without those that a closed axis repeats: (n0 x n1 ... x dim)."""
    points = control_points(spline)
    for axis, closed in enumerate(spline.get("closed", [False] * len(spline["degree"]))):
        if closed:
            points = np.take(points, np.arange(points.shape[axis] - spline["degree"][axis]), axis=axis)
    return points


class Saved(InFolder):
    def good(self, *arguments):
        done = self.run_batten(*arguments)
        self.assertEqual(done.returncode, 0, (arguments, done.stderr))
        return done.stdout

    def bad(self, status, words, *arguments):
        """One line, the status, nothing written and nothing changed."""
        before = {path.name: path.read_bytes() for path in self.folder.iterdir()}
        done = self.run_batten(*arguments)
        self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (status, 1, ""), (arguments, done.stderr))
        self.assertIn(words, done.stderr)
        self.assertEqual({path.name: path.read_bytes() for path in self.folder.iterdir()}, before)

    def save(self, name, values):
        np.save(self.folder / name, np.ascontiguousarray(values))
        return name

    def json(self, name):
        return json.loads((self.folder / name).read_text())


class Parts:
    """Samples of one kind, in parts with parameters of their own."""

    def __init__(self, rng, kind, dim, degree, size, closed=(), weighted=False):
        self.kind, self.dim, self.size, self.closed, self.weighted = kind, dim, size, closed, weighted
        axes = {"curve": 1, "grid": 2, "volume": 3, "cloud": 2, "cloud3": 3}[kind]
        self.degree = [degree] * axes if np.isscalar(degree) else list(degree)
        self.parts = []
        if kind in ("curve", "cloud", "cloud3"):
            for m in (90, 140, 75) if kind == "curve" else (700, 400, 500):
                t = rng.random((m, axes))
                self.parts.append([np.sort(t[:, 0]) if axes == 1 else t])
            if axes == 1:  # the ends are there
                self.parts[0][0][0], self.parts[2][0][-1] = 0, 1
            else:
                self.parts[1][0][:2] = [[0] * axes, [1] * axes]
        else:
            shared = [np.linspace(0, 1, m) ** 1.2 for m in (17, 12)[:axes - 1]]
            u = np.linspace(0, 1, 40)
            for k in range(3):  # slabs along the first axis
                self.parts.append([u[k::3] if k < 2 else np.sort(np.r_[u[2::3], 0.987]), *shared])
        for part in self.parts:
            scattered = kind in ("cloud", "cloud3")
            places = part[0] if scattered else np.stack(np.meshgrid(*part, indexing="ij"), -1).reshape(-1, axes)
            # parts far apart in space: their centres differ
            q = np.stack([np.sin((2 + d) * places @ np.arange(1, axes + 1) + d) * (1 + d) for d in range(dim)], -1)
            q += 0.05 * rng.normal(size=q.shape) + 3
            w = rng.uniform(0.2, 4, len(q)) if weighted else np.ones(len(q))
            part[:] = [part.copy(), places, q, w]

    def write(self, test, k, part):
        """Arguments of `assemble` for one part."""
        parameters, places, q, w = part
        scattered = self.kind in ("cloud", "cloud3")
        shape = [] if scattered or self.kind == "curve" else [len(t) for t in parameters]
        line = [test.save(f"q{k}.npy", q.reshape(*shape, -1) if shape else q)]
        for a, t in enumerate(parameters):
            line += ["--parameters", test.save(f"t{k}_{a}.npy", t)]
        if self.weighted:
            line += ["--weights", test.save(f"w{k}.npy", w)]
        return line

    def space(self):
        line = ["-p", ",".join(map(str, self.degree)), "-n", "x".join(map(str, self.size))]
        if self.closed:
            line += ["--closed=" + ",".join(map(str, self.closed))] if len(self.degree) > 1 else ["--closed"]
        return line

    def dense(self, spline):
        """The least-squares control points over the spline's knots, the matrix of all samples and these."""
        places, q, w = [np.concatenate([part[k] for part in self.parts]) for k in (1, 2, 3)]
        a = np.ones((len(places), 1))
        for axis in range(places.shape[1]):
            a = (a[:, :, None] * collocation(spline, axis, places[:, axis])[:, None]).reshape(len(places), -1)
        root, shift = np.sqrt(w)[:, None], q.mean(axis=0)
        best = np.linalg.lstsq(root * a, root * (q - shift), rcond=None)[0] + shift
        return best, a, q, w


CASES = [("curve", 1, 3, [35]), ("curve", 2, 1, [35]), ("curve", 2, 2, [34]), ("curve", 3, 3, [35]), ("curve", 4, 4, [24]), ("curve", 2, 5, [21]), ("curve", 3, 6, [22]),
         ("curve", 2, 7, [19]), ("curve", 1, 8, [20]), ("curve", 2, 9, [17]), ("curve", 2, 3, [32], (0,)), ("curve", 3, 2, [24], (0,)), ("curve", 2, 5, [12], (0,)),
         ("curve", 16, 3, [19]), ("grid", 3, 3, [11, 7]), ("grid", 1, [3, 2], [19, 10]), ("grid", 2, [5, 1], [13, 9]), ("grid", 3, 3, [8, 7], (0,)),
         ("volume", 1, 2, [10, 6, 4]), ("volume", 4, [3, 1, 2], [7, 5, 6]), ("cloud", 1, 3, [11, 7]), ("cloud", 3, [2, 4], [10, 12]), ("cloud", 2, 3, [8, 12], (0, 1)),
         ("cloud", 3, 1, [9, 9]), ("cloud3", 2, 2, [6, 6, 4]), ("cloud3", 1, [1, 2, 3], [5, 4, 5], (1,))]


class Sums(Saved):
    def each_case(self):
        for k, case in enumerate(some(CASES)):
            for weighted in (False, True):
                yield case, weighted, Parts(np.random.default_rng(100 * k + weighted), *case, weighted=weighted)

    def agrees(self, spline, dense, weighted, summary, case):
        best, a, q, w = dense
        ours = free(spline).reshape(len(best), -1)
        size = np.abs(q - q.mean(axis=0)).max()
        # the normal equations' digits: what the samples see is exact, control points lose the condition
        condition = np.linalg.cond(np.sqrt(w)[:, None] * a) ** 2
        self.assertLess(np.abs(a @ (ours - best)).max(), 1e-12 * size, case)
        self.assertLess(np.abs(ours - best).max(), max(1e-12, 1e-15 * condition) * size, case)
        rms = np.sqrt((w * ((a @ best - q) ** 2).sum(axis=1)).sum() / w.sum())
        self.assertAlmostEqual(summary["weighted_rms_deviation" if weighted else "rms_deviation"] / rms, 1, 10, case)
        self.assertLess(summary["rms_rounding"], 1e-6 * size)
        self.assertAlmostEqual(summary["data_size"] / np.linalg.norm(np.ptp(q, axis=0)), 1, 14)
        self.assertEqual(summary["samples"], len(q))

    def test_parts_merged_are_the_whole(self):
        for case, weighted, parts in self.each_case():
            with self.subTest(case, weighted=weighted):
                space = [*parts.space(), "--domain", "0..1"]
                lines = [parts.write(self, k, part) for k, part in enumerate(parts.parts)]
                for k, line in enumerate(lines):
                    self.good("assemble", *line, *(space if k == 0 else ["--knots-of", "0.sys"]), "-o", f"{k}.sys")
                self.good("merge", "0.sys", "1.sys", "2.sys", "-o", "all.sys")
                self.good("merge", "2.sys", "1.sys", "-o", "21.sys", "-q")
                self.good("merge", "21.sys", "0.sys", "-o", "210.sys", "-q")
                # all files at once: their points first, then the flags of each
                self.good("assemble", *[line[0] for line in lines], *[x for line in lines for x in line[1:]], *space, "-o", "once.sys", "-q")
                self.assertEqual((self.folder / "all.sys").read_bytes(), (self.folder / "once.sys").read_bytes())
                for name in ("all", "210"):
                    self.good("solve", f"{name}.sys", "-o", "s.json", "--summary", "s.sum.json")
                    spline = self.json("s.json")
                    self.agrees(spline, parts.dense(spline), weighted, self.json("s.sum.json"), case)

    def test_the_same_as_a_fit(self):
        for case, weighted, parts in self.each_case():
            _, places, q, w = parts.parts[1]
            if parts.kind in ("grid", "volume", "curve") and not parts.closed:
                places = places - places.min(axis=0)  # the fit's domain is that of its parameters
                places /= places.max(axis=0)
                parts.parts[1][0][:] = [(t - t[0]) / (t[-1] - t[0]) for t in parts.parts[1][0]]
            with self.subTest(case, weighted=weighted):
                line = parts.write(self, 1, [parts.parts[1][0], places, q, w])
                if max(len(np.unique(t)) for t in parts.parts[1][0]) < max(parts.size):
                    continue  # too few samples of its own
                for more in ([], ["--smooth", 1e-5]) if min(parts.degree) > 1 else ([],):
                    even = [] if parts.kind.startswith("cloud") else ["--knots", "uniform"]
                    self.good("fit", *line, *parts.space(), *even, "-m", "direct", *more, "-q", "-o", "fit.json")
                    self.good("assemble", *line, *parts.space(), "--domain", "0..1", "-o", "a.sys", "-q")
                    self.good("solve", "a.sys", *more, "-q", "-o", "s.json")
                    fit, ours = self.json("fit.json"), self.json("s.json")
                    for x, y in zip(fit["knots"], ours["knots"]):
                        np.testing.assert_allclose(x, y, rtol=0, atol=1e-15)
                    a = collocation(ours, 0, places[:, 0])
                    for axis in range(1, places.shape[1]):
                        a = (a[:, :, None] * collocation(ours, axis, places[:, axis])[:, None]).reshape(len(places), -1)
                    difference = free(fit).reshape(a.shape[1], -1) - free(ours).reshape(a.shape[1], -1)
                    self.assertLess(np.abs(a @ difference).max(), (1e-10 if more else 1e-12) * np.abs(q - q[0]).max(), (case, more))

    def test_coarser_knots(self):
        for case, weighted, parts in self.each_case():
            with self.subTest(case, weighted=weighted):
                space = [*parts.space(), "--domain", "0..1"]
                lines = [parts.write(self, k, part) for k, part in enumerate(parts.parts)]
                self.good("assemble", *[line[0] for line in lines], *[x for line in lines for x in line[1:]], *space, "-o", "all.sys", "-q")
                words = self.run_batten("solve", "all.sys", "-n", "x".join(["999"] * len(parts.size)), "-o", "x.json").stderr
                for axis, n in enumerate(parts.size):
                    closed, p = axis in parts.closed, parts.degree[axis]
                    spans = n if closed else n - p
                    sizes = [spans // k + (0 if closed else p) for k in range(spans, 0, -1) if spans % k == 0]
                    sizes = [s for s in sizes if s > p]
                    if axis == 0:
                        self.assertEqual(words, f"batten: axis 0: 999 control points: their knots are not nested in the saved system's; possible are "
                                                f"{', '.join(map(str, sizes))}\n")
                    for size in sizes[:-1]:
                        wanted = [size if k == axis else m for k, m in enumerate(parts.size)]
                        self.good("solve", "all.sys", "-n", "x".join(map(str, wanted)), "-o", "s.json", "--summary", "s.sum.json")
                        self.good("solve", "all.sys", "-o", "fine.json", "-q")
                        spline, fine = self.json("s.json"), self.json("fine.json")
                        self.assertEqual(list(free(spline).shape[:-1]), wanted)
                        self.assertTrue(set(spline["knots"][axis][p:-p]) <= set(fine["knots"][axis][p:-p]))
                        self.agrees(spline, parts.dense(spline), weighted, self.json("s.sum.json"), (case, wanted))

    def test_any_nested_knots(self):
        rng = np.random.default_rng(5)
        t = np.sort(rng.random(400))
        t[0], t[-1] = 0, 1
        q = np.column_stack([np.cos(5 * t), np.sin(7 * t)]) + 0.01 * rng.normal(size=(400, 2))
        self.save("q.npy", q), self.save("t.npy", t)
        knots = np.sort(np.r_[[0] * 4, rng.random(12), [0.4] * 3, [0.6] * 2, [1] * 4])
        np.savetxt(self.folder / "k.txt", knots, fmt="%.17g")
        self.good("assemble", "q.npy", "--parameters", "t.npy", "--knots", "k.txt", "-o", "a.sys", "-q")
        for seed in range(6):
            inner = knots[4:-4]
            kept = np.sort(np.random.default_rng(seed).choice(inner, 7, replace=False))
            np.savetxt(self.folder / "c.txt", np.r_[[0] * 4, kept, [1] * 4], fmt="%.17g")
            self.good("solve", "a.sys", "--knots", "c.txt", "-o", "s.json", "-q")
            spline = self.json("s.json")
            a = collocation(spline, 0, t)
            best = np.linalg.lstsq(a, q - q[0], rcond=None)[0] + q[0]
            self.assertLess(np.abs(free(spline) - best).max(), 1e-11)
            np.testing.assert_array_equal(spline["knots"][0][4:-4], kept)
        # knots of full multiplicity stay together
        for n in (5, 6):
            done = self.run_batten("solve", "a.sys", "-n", n, "-o", "s.json", "-q")
            if done.returncode == 0:
                kept = self.json("s.json")["knots"][0][4:-4]
                for x in set(kept):
                    self.assertEqual(kept.count(x), list(knots).count(x))

    def test_the_solution_does_not_depend_on_places_far_away(self):
        """Parts that are far from each other in space: exact shifts of the centre, and of a hundred parts."""
        rng = np.random.default_rng(8)
        t = np.linspace(0, 1, 2000)
        q = np.column_stack([1e6 * t, np.sin(9 * t), 1e3 + rng.normal(size=2000)])
        for k in range(100):
            self.save(f"q{k}.npy", q[20 * k:20 * k + 20]), self.save(f"t{k}.npy", t[20 * k:20 * k + 20])
        self.good("assemble", *[f"q{k}.npy" for k in range(100)], *[x for k in range(100) for x in ("--parameters", f"t{k}.npy")], "--domain", "0..1", "-n", 35, "-o", "a.sys")
        self.good("solve", "a.sys", "-o", "s.json", "--summary", "r.json")
        spline = self.json("s.json")
        a = collocation(spline, 0, t)
        shift = q.mean(axis=0)
        best = np.linalg.lstsq(a, q - shift, rcond=None)[0] + shift
        self.assertLess(np.abs(free(spline) - best).max(), 1e-12 * 1e6)
        report = self.json("r.json")
        rms = np.sqrt(((a @ best - q) ** 2).sum() / len(q))
        self.assertLess(abs(report["rms_deviation"] - rms), report["rms_rounding"] ** 2 / rms + 1e-12)

    def test_exact_samples_have_no_rms_to_tell(self):
        t = np.linspace(0, 1, 300)
        self.save("q.npy", np.column_stack([t, t**3]))
        self.save("t.npy", t)
        self.good("assemble", "q.npy", "--parameters", "t.npy", "-n", 19, "--domain", "0..1", "-o", "a.sys")
        words = self.good("solve", "a.sys", "-o", "s.json", "--summary", "r.json")
        report = self.json("r.json")
        self.assertLessEqual(report["rms_deviation"], report["rms_rounding"])
        self.assertLess(report["rms_rounding"], 1e-6)
        self.assertIn("rms below ", words)
        self.assertIn("the largest is not known without the samples", words)


class Clouds(Saved):
    def test_tiles_of_ground(self):
        """A cloud's coordinates are its parameters as they stand."""
        rng = np.random.default_rng(3)
        xy = rng.random((4000, 2)) * [1000, 500] + [5e5, 4e6]
        z = 20 * np.sin((xy[:, 0] - 5e5) / 150) + 10 * np.cos((xy[:, 1] - 4e6) / 90)
        points = np.column_stack([xy, z])
        left = xy[:, 0] < 5e5 + 400
        self.save("1.npy", points[left]), self.save("2.npy", points[~left])
        domain = ["--domain", "500000..501000,4000000..4000500"]
        self.good("assemble", "1.npy", "2.npy", "--project", "xy", *domain, "-n", "19x11", "-o", "a.sys")
        self.good("solve", "a.sys", "-o", "s.json")
        spline = self.json("s.json")
        a = (collocation(spline, 0, xy[:, 0])[:, :, None] * collocation(spline, 1, xy[:, 1])[:, None]).reshape(4000, -1)
        shift = points.mean(axis=0)
        best = np.linalg.lstsq(a, points - shift, rcond=None)[0] + shift
        self.assertLess(np.abs(free(spline).reshape(-1, 3) - best).max(), 5e-9)  # coordinates of 4e6 are told to 5e-10
        self.bad(2, "best plane of its own", "assemble", "1.npy", "2.npy", "--project", "plane", *domain, "-n", "19x11", "-o", "b.sys")
        # one file alone may lie as in a fit
        self.good("assemble", "1.npy", "--project", "xy", "-n", "10x8", "-o", "b.sys", "-q")
        self.good("solve", "b.sys", "-o", "s.json", "-q")
        self.good("fit", "1.npy", "--project", "xy", "-n", "10x8", "-m", "direct", "-o", "fit.json", "-q")
        np.testing.assert_allclose(self.json("s.json")["control_points"], self.json("fit.json")["control_points"], rtol=0, atol=1e-8)

    def test_heights(self):
        h = np.random.default_rng(4).normal(size=(30, 20))
        self.save("h.npy", h)
        self.good("assemble", "h.npy", "--heights", "--spacing", "2,3", "-n", "12x9", "-o", "a.sys", "-q")
        self.good("solve", "a.sys", "-o", "s.json", "-q")
        self.good("fit", "h.npy", "--heights", "--spacing", "2,3", "-n", "12x9", "-o", "fit.json", "-q")
        np.testing.assert_allclose(self.json("s.json")["control_points"], self.json("fit.json")["control_points"], rtol=0, atol=1e-11)


class Refusals(Saved):
    def setUp(self):
        super().setUp()
        t = np.linspace(0, 1, 60)
        self.save("q.npy", np.column_stack([t, np.sin(6 * t)]))
        self.save("r.npy", np.column_stack([t, np.cos(6 * t), t]))
        self.save("t.npy", t)
        self.save("w.npy", np.full(60, 2.0))
        self.save("g.npy", np.random.default_rng(1).normal(size=(12, 9, 2)))
        self.make("a.sys")

    def make(self, name, *more, points="q.npy"):
        space = more or ["-n", 19, "--domain", "0..1"]
        self.good("assemble", points, *space, "-q", "-o", name)
        return name

    def test_assembling(self):
        for words, line in (
                ("neither the number of control points nor knots", ["q.npy"]),
                ("several files share their knots", ["q.npy", "q.npy", "--parameters", "t.npy", "--parameters", "t.npy", "-n", 19]),
                ("every file after the first needs --parameters", ["q.npy", "q.npy", "-n", 19, "--domain", "0..1"]),
                ("--parameters: 1 files given for 2", ["q.npy", "q.npy", "--parameters", "t.npy", "-n", 19, "--domain", "0..1"]),
                ("--weights: 1 given for 2", ["q.npy", "q.npy", "--weights", "w.npy", "-n", 19, "--domain", "0..1"]),
                ("outside the knots' domain", ["q.npy", "--parameters", "t.npy", "-n", 19, "--domain", "0.5..1"]),
                ("--domain 1: 0..1", ["q.npy", "-n", 19, "--domain", "1"]), ("must begin before it ends", ["q.npy", "-n", 19, "--domain", "1..0"]),
                ("a finite number", ["q.npy", "-n", 19, "--domain", "0..inf"]), ("domain: 2 given for 1 axes", ["q.npy", "-n", 19, "--domain", "0..1,0..1"]),
                ("the number of control points over it", ["q.npy", "--knots-of", "a.sys", "--domain", "0..1"]),
                ("evenly spaced", ["q.npy", "-n", 19, "--domain", "0..1", "--closed=C0"]), ("--knots", ["q.npy", "--knots", "t.npy", "--knots-of", "a.sys"]),
                ("--degree", ["q.npy", "-p", 2, "--knots-of", "a.sys"]), ("2 axes", ["g.npy", "--knots-of", "a.sys"]),
                ("only systems over the same knots add up", ["q.npy", "r.npy", "--parameters", "t.npy", "--parameters", "t.npy", "-n", 19, "--domain", "0..1"]),
                ("coordinates are outside 1e-60 to 1e60", [self.save("huge.npy", np.load(self.folder / "q.npy") * 1e90), "-n", 19, "--domain", "0..1"]),
                ("weights from", ["q.npy", "-n", 19, "--domain", "0..1", "--weights", self.save("hw.npy", np.full(60, 1e90))])):
            with self.subTest(words):
                wanted = "excludes" if words in ("--knots", "--degree", "the number of control points over it") else words
                self.bad(2, wanted, "assemble", *line, "-o", "x.sys")
        self.bad(2, "--output is required", "assemble", "q.npy", "-n", 19)
        self.bad(2, "a saved system .sys is written", "assemble", "q.npy", "-n", 19, "-o", "x.json")
        self.bad(2, "a.sys", "assemble", "q.npy", "--knots-of", "a.sys", "-o", "a.sys")
        (self.folder / "link.sys").symlink_to("q.npy")
        self.bad(2, "link.sys", "assemble", "q.npy", "-n", 19, "-o", "link.sys")
        self.bad(3, "no.npy", "assemble", "no.npy", "-n", 19, "-o", "x.sys")

    def test_merging(self):
        domain = ["--domain", "0..1"]
        for words, name in (("axis 0: degree: 3 and 2", self.make("degree.sys", "-p", 2, "-n", 19, *domain)),
                            ("axis 0: control points: 19 and 20", self.make("size.sys", "-n", 20, *domain)),
                            ("axis 0: knot 0: 0 and -1", self.make("knots.sys", "-n", 19, "--domain=-1..1")),
                            ("axis 0: open and closed", self.make("closed.sys", "-n", 19, "--closed", *domain)),
                            ("coordinates of the points: 2 and 3", self.make("dim.sys", points="r.npy")),
                            ("number of axes: 1 and 2", self.make("axes.sys", "-n", "6x6", points="g.npy"))):
            self.bad(2, words, "merge", "a.sys", name, "-o", "x.sys")
            self.bad(2, f"a.sys, {name}: ", "merge", "a.sys", name, "-o", "x.sys")
        self.bad(2, "a.sys", "merge", "a.sys", "size.sys", "-o", "a.sys")
        self.bad(2, "--output is required", "merge", "a.sys", "a.sys")
        self.bad(2, "SYSTEMS", "merge", "a.sys", "-o", "x.sys")
        self.bad(3, "not a saved system", "merge", "a.sys", "q.npy", "-o", "x.sys")

    def test_solving(self):
        self.make("few.sys", "-n", 67, "--domain", "0..2")
        for words, line in (("possible are 4, 5, 7, 11, 19", ["a.sys", "-n", 20]), ("possible are 4, 5, 7, 11, 19", ["a.sys", "-n", 6]),
                            ("control points: 2 values given for 1 axes", ["a.sys", "-n", "7x7"]), ("not nested", ["a.sys", "--knots", "k.txt"]),
                            ("excludes", ["a.sys", "--knots", "k.txt", "-n", 7]), ("cross-validation needs the samples", ["a.sys", "--smooth", "auto"]),
                            ("auto or a positive number", ["a.sys", "--smooth", "-1"]), ("largest factor", ["a.sys", "--smooth", "1e30"]),
                            ("--smooth-order: it needs --smooth", ["a.sys", "--smooth-order", 3]),
                            ("is not determined by the samples; fewer control points or smoothing may do", ["few.sys"])):
            np.savetxt(self.folder / "k.txt", [0, 0, 0, 0, 0.3, 1, 1, 1, 1])
            self.bad(2, words, "solve", *line, "-o", "x.json")
        self.make("linear.sys", "-p", 1, "-n", 17, "--domain", "0..1")
        self.bad(2, "vanishes for degree 1", "solve", "linear.sys", "--smooth", 1, "-o", "x.json")
        self.bad(2, "--output is required", "solve", "a.sys")
        self.bad(2, "unknown extension", "solve", "a.sys", "-o", "x.sys")
        self.bad(2, "k.txt", "solve", "a.sys", "--knots", "k.txt", "-o", "y.json", "--summary", "k.txt")
        self.bad(2, "an .stl holds surfaces", "solve", "a.sys", "-o", "x.stl")
        self.bad(3, "no.sys", "solve", "no.sys", "-o", "x.json")
        # smoothing, or fewer control points, may determine what the samples do not
        self.good("solve", "few.sys", "--smooth", 1e-6, "-o", "x.json", "-q")
        self.good("solve", "few.sys", "-n", 4, "-o", "x.json", "-q")

    def test_files_that_are_no_saved_systems(self):
        whole = (self.folder / "a.sys").read_bytes()
        for words, content in (("not a saved system", b""), ("not a saved system", b"BSYS" + whole[4:]), ("not a saved system", whole.replace(b"\r\n", b"\n", 1)),
                               ("version 2; version 1 is read", whole[:8] + struct.pack("<I", 2) + whole[12:]), ("checksum does not match", whole[:-1] + b"\0"),
                               ("checksum does not match", whole[:200] + b"\1" + whole[201:]), ("cut off", whole[:-9]), ("the file ends at byte 20", whole[:20]),
                               ("left over", whole + b"12345678")):
            (self.folder / "bad.sys").write_bytes(content)
            self.bad(3, words, "solve", "bad.sys", "-o", "x.json")
            self.bad(3, words, "info", "bad.sys")

    def test_every_byte_counts(self):
        """A changed byte, a missing end: always refused in a line, never another spline."""
        self.make("small.sys", "-p", 1, "-n", 3, "--domain", "0..1")
        whole = (self.folder / "small.sys").read_bytes()
        for at in some(range(len(whole))):
            (self.folder / "bad.sys").write_bytes(whole[:at] + bytes([whole[at] ^ (1 << at % 8)]) + whole[at + 1:])
            done = self.run_batten("solve", "bad.sys", "-o", "x.json")
            self.assertEqual((done.returncode, done.stderr.count("\n"), (self.folder / "x.json").exists()), (3, 1, False), (at, done.stderr))
            self.assertTrue(done.stderr.startswith("batten: bad.sys: "), done.stderr)

    def test_the_layout_is_as_documented(self):
        """docs/formats.md, read here by it alone."""
        whole = (self.folder / "a.sys").read_bytes()
        magic, version, kind, axes, dim, samples = struct.unpack_from("<8sIIIIQ", whole)
        self.assertEqual((magic, version, kind, axes, dim, samples), (b"\x89BSYS\r\n\x1a", 1, 1, 1, 2, 60))
        degree, closed, knots = struct.unpack_from("<IIQ", whole, 32)
        self.assertEqual((degree, closed, knots), (3, 0, 23))
        numbers = np.frombuffer(whole[48:-8], "<f8")
        q = np.load(self.folder / "q.npy")
        t = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))])
        t /= t[-1]
        taken = iter(np.split(numbers, np.cumsum([knots, dim, 2 * dim, 1, 1, 19 * dim])))
        knot = next(taken)
        np.testing.assert_allclose(knot, np.r_[[0] * 3, np.linspace(0, 1, 17), [1] * 3], atol=1e-15)
        a = BSpline.design_matrix(t, knot, 3).toarray()
        np.testing.assert_array_equal(next(taken), q[0])
        np.testing.assert_array_equal(next(taken).reshape(2, 2), [q.min(axis=0), q.max(axis=0)])
        self.assertEqual(next(taken), 60)
        np.testing.assert_allclose(next(taken), ((q - q[0]) ** 2).sum(), rtol=1e-14)
        np.testing.assert_allclose(next(taken).reshape(19, 2), a.T @ (q - q[0]), atol=1e-13)
        gram = a.T @ a
        band = next(taken).reshape(19, 4)
        for i in range(19):
            for k in range(4):
                self.assertAlmostEqual(band[i, k], gram[i, i + k] if i + k < 19 else 0, 13)
        crc = ~0 & (1 << 64) - 1
        for byte in whole[:-8]:
            crc ^= byte
            for _ in range(8):
                crc = crc >> 1 ^ (0xC96C5795D7870F42 if crc & 1 else 0)
        self.assertEqual(struct.pack("<Q", ~crc & (1 << 64) - 1), whole[-8:])

    def test_what_is_in_a_file(self):
        self.assertEqual(self.good("info", "a.sys"), "a.sys: system of degree 3, 19 control points: 60 samples in dimension 2, a banded matrix\n")
        self.make("g.sys", "-n", "6x5", points="g.npy")
        self.assertIn("6x5 control points: 108 samples in dimension 2, a product of banded matrices", self.good("info", "g.sys"))
        self.good("assemble", "q.npy", "-n", 19, "-o", "/dev/null")  # a stream needs no extension
        for output in ("s.json", "s.obj", "s.g2", "s.svg", "s.csv", "s.vts", "s.vtu"):
            self.good("solve", "a.sys", "-q", "-o", output)
            self.assertGreater((self.folder / output).stat().st_size, 100)


if __name__ == "__main__":
    unittest.main()
