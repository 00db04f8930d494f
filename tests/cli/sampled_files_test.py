"""Sampled files keep the chord tolerance both ways, and what encloses something is closed: judged by SciPy's B-splines over generated splines."""
import base64
import json
import os
import struct
import unittest
import xml.etree.ElementTree as ElementTree

import numpy as np
from scipy.interpolate import BSpline

from judge import InFolder, control_points, evaluate, places, some

SEED, CASES = int(os.environ.get("SEED", 7)), int(os.environ.get("CASES", 17))
FLOAT = 2.0 ** -24  # relative rounding of single precision


def knots_of(rng, degree, spans, kind):
    """Knots of so many spans; `uneven` ones differ by up to 10^6."""
    length = 10 ** rng.uniform(-6, 0, spans) if "uneven" in kind else np.ones(spans)
    breaks = np.concatenate([[0], np.cumsum(length)]) / length.sum()
    if "closed" not in kind:
        return np.concatenate([np.zeros(degree), breaks, np.ones(degree)])
    around = np.concatenate([breaks[:-1] + turn for turn in range(-degree, degree + 2)])  # any number of periods of spans
    first = int(np.searchsorted(around, 0)) - degree
    return around[first:first + spans + 2 * degree + 1]


def around(kind):
    return kind.split()[0] in ("closed", "met")


def make(rng, axes, dim, kinds, poles=False, mirrored=False):
    """A spline of the given kinds of axes, of a size near 1: closed ones and those whose open ends have met go around, poles end the second axis in
    points."""
    degree = [int(rng.integers(1, 8)) for _ in range(axes)]
    if poles and degree[1] < 2:
        degree[1] = 2
    spans = [int(max(p + 1 if "closed" in kind else 1, rng.integers(1, 6))) for p, kind in zip(degree, kinds)]
    for axis, (p, kind) in enumerate(zip(degree, kinds)):
        if around(kind):
            spans[axis] = max(spans[axis], 4 - p if "met" in kind else 3)
    knots = [knots_of(rng, p, n, kind) for p, n, kind in zip(degree, spans, kinds)]
    free = [len(k) - p - 1 - {"closed": p, "met": 1}.get(kind.split()[0], 0) for k, p, kind in zip(knots, degree, kinds)]
    g = np.meshgrid(*[np.arange(n) / (n if around(kind) else n - 1) for n, kind in zip(free, kinds)], indexing="ij")
    u, v, w = (g + [np.zeros(g[0].shape)] * 2)[:3]
    if axes == 1:
        turn = 2 * np.pi * u
        points = np.stack([np.cos(turn), np.sin(turn), u], axis=-1)[..., :dim] if "closed" in kinds[0] else np.stack([u, 0 * u, 0 * u], axis=-1)[..., :dim]
    elif not around(kinds[0]):
        points = np.stack([u, v, w], axis=-1)
    else:
        turn, r = 2 * np.pi * u, 0.3 * (1 + 0.5 * w)
        if around(kinds[1]):
            points = np.stack([(1 + r * np.cos(2 * np.pi * v)) * np.cos(turn), (1 + r * np.cos(2 * np.pi * v)) * np.sin(turn), r * np.sin(2 * np.pi * v)], axis=-1)
        else:
            width = r * (np.sin(np.pi * v) if poles else 1)
            height = -r * np.cos(np.pi * v) if poles and axes == 3 else v
            points = np.stack([width * np.cos(turn), width * np.sin(turn), height], axis=-1)
    wild = 0.02 if axes == 3 else 0.08
    moved = rng.normal(0, wild, points.shape)
    if poles:
        moved[:, 0] = moved[0, 0]
        moved[:, -1] = moved[0, -1]
    points = points + moved
    if mirrored:
        points[..., 0] *= -1
    for axis, (p, kind) in enumerate(zip(degree, kinds)):
        if around(kind):
            points = np.concatenate([points, np.take(points, range(p if "closed" in kind else 1), axis=axis)], axis=axis)
    return {"format": "batten-spline", "version": 1, "degree": degree, "closed": ["closed" in kind for kind in kinds], "knots": [k.tolist() for k in knots],
            "control_shape": list(points.shape[:-1]), "control_points": points.reshape(-1, points.shape[-1]).tolist()}


def placed(spline, size, offset):
    spline["control_points"] = (size * np.array(spline["control_points"]) + offset).tolist()
    return spline


def faces(spline):
    """The surfaces that a mesh shows: the spline, or the skin of a volume: no ends of closed axes, none that are a line."""
    if len(spline["degree"]) < 3:
        return [spline]
    control = control_points(spline)
    found = []
    for axis in range(3):
        if spline["closed"][axis] or (np.take(control, 0, axis=axis) == np.take(control, -1, axis=axis)).all():
            continue
        rest = [k for k in range(3) if k != axis]
        for end in (0, -1):
            net = np.take(control, end, axis=axis)
            if any(np.ptp(net, axis=k).max() < 1e-12 * size_of(spline) for k in (0, 1)):
                continue
            found.append({"degree": [spline["degree"][k] for k in rest], "knots": [spline["knots"][k] for k in rest],
                          "control_shape": list(net.shape[:-1]), "control_points": net.reshape(-1, net.shape[-1])})
    return found


def inside(spline, count, rng):
    """Points of the spline over a random grid of its parameters, some in every piece, the ends of pieces among them."""
    t = []
    for axis in range(len(spline["degree"])):
        p = places(spline, axis, 1)
        within = np.concatenate([np.sort(rng.uniform(a, b, count)) for a, b in zip(p, p[1:])])
        t.append(np.sort(np.concatenate([p, within])))
    return evaluate(spline, *t).reshape(-1, len(spline["control_points"][0]))


def to_triangles(points, corners):
    """Distance of each point from the nearest of the triangles: in a triangle's plane, or from its edges."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    n = np.cross(b - a, c - a)
    square = (n ** 2).sum(axis=1)
    found = np.full(len(points), np.inf)
    for part in np.array_split(np.arange(len(points)), max(1, len(points) * len(corners) // 400_000)):
        p = points[part, None]
        nearest = np.full((len(part), len(corners)), np.inf)
        inner = np.ones(nearest.shape, bool)
        for start, end in ((a, b), (b, c), (c, a)):
            along = end - start
            f = ((p - start) * along).sum(axis=-1) / np.maximum((along ** 2).sum(axis=-1), 1e-300)
            nearest = np.minimum(nearest, np.linalg.norm(p - start - np.clip(f, 0, 1)[..., None] * along, axis=-1))
            inner &= (np.cross(along, p - start) * n).sum(axis=-1) > 0
        with np.errstate(invalid="ignore", divide="ignore"):
            height = abs(((p - a) * n).sum(axis=-1)) / np.sqrt(square)
        found[part] = np.where(inner & (square > 0), np.minimum(nearest, height), nearest).min(axis=1)
    return found


def to_lines(points, ends):
    along = ends[:, 1] - ends[:, 0]
    f = ((points[:, None] - ends[:, 0]) * along).sum(axis=-1) / np.maximum((along ** 2).sum(axis=-1), 1e-300)
    return np.linalg.norm(points[:, None] - ends[:, 0] - np.clip(f, 0, 1)[..., None] * along, axis=-1).min(axis=1)


def scattered(spline, at, derived=None):
    """Points, or derivatives along one axis, at rows of one parameter per axis."""
    values = control_points(spline)
    for k, (knots, degree, count) in enumerate(zip(spline["knots"], spline["degree"], spline["control_shape"])):
        basis = BSpline(np.array(knots), np.eye(count), degree)
        row = (basis.derivative() if k == derived else basis)(at[:, k])
        values = np.einsum("mn,n...->m...", row, values) if k == 0 else np.einsum("mn,mn...->m...", row, values)
    return values


def to_spline(points, spline, finer=1):
    """Distance of each point from a curve or surface: from the nearest of dense places in the nearest pieces by damped Gauss-Newton steps
    within each piece. A point of the spline proves it: it is never too small."""
    axes = range(len(spline["degree"]))
    control = control_points(spline)
    breaks = [places(spline, k, 1) for k in axes]
    each = [finer * max(40 if len(axes) == 1 else 20, 100 // (len(t) - 1)) for t in breaks]
    inner = [np.concatenate([a + (b - a) * (np.arange(n) + 0.5) / n for a, b in zip(t, t[1:])]) for t, n in zip(breaks, each)]
    dense = evaluate(spline, *inner)
    index = [i.ravel() for i in np.indices(dense.shape[:-1])]
    piece = np.ravel_multi_index([i // n for i, n in zip(index, each)], [len(t) - 1 for t in breaks])
    by_piece = np.argsort(piece, kind="stable").reshape(piece.max() + 1, -1)
    square = ((dense.reshape(-1, control.shape[-1])[by_piece][None] - points[:, None, None]) ** 2).sum(axis=-1)
    starts = min(12, square.shape[1])  # tiny pieces crowd
    nearest = square.min(axis=2).argsort(axis=1)[:, :starts]
    start = by_piece[nearest, np.take_along_axis(square.argmin(axis=2), nearest, 1)].ravel()
    at = np.stack([inner[k][index[k][start]] for k in axes], axis=-1)
    low, high = (np.stack([breaks[k][index[k][start] // each[k] + end] for k in axes], axis=-1) for end in (0, 1))
    points = np.repeat(points, starts, axis=0)
    point = lambda at, derived=None: scattered(spline, at, derived)
    away, damping = np.linalg.norm(points - point(at), axis=-1), np.full(len(points), 1e-3)
    for _ in range(30):
        rest = points - point(at)
        jacobian = np.stack([point(at, k) for k in axes], axis=-1) * (high - low)[:, None, :]  # in parts of the piece
        slope = np.einsum("mdk,md->mk", jacobian, rest)
        jacobian = np.where(((at <= low) & (slope < 0) | (at >= high) & (slope > 0))[:, None, :], 0, jacobian)  # not out of the piece
        normal = np.einsum("mdi,mdj->mij", jacobian, jacobian)
        more = damping * np.trace(normal, axis1=1, axis2=2) + 1e-200
        move = np.linalg.solve(normal + more[:, None, None] * np.eye(len(axes)), np.einsum("mdk,md->mk", jacobian, rest)[..., None])[..., 0]
        there = np.clip(at + move * (high - low), low, high)
        now = np.linalg.norm(points - point(there), axis=-1)
        better = now < away
        at[better], away[better] = there[better], now[better]
        damping *= np.where(better, 0.1, 5)
    return away.reshape(-1, starts).min(axis=1)


def read_stl(path):
    data = path.read_bytes()
    count, = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count
    records = np.frombuffer(data, np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("more", "<u2")]), offset=84)
    return records["normal"].astype(float), records["corners"].astype(float).reshape(-1, 3, 3)


def read_vtu(path):
    """Points, the values of their arrays, and the cells that show the spline as (type, points)."""
    piece = ElementTree.parse(path).getroot().find(".//Piece")
    numbers = lambda element, kind: np.array((element.text or "").split(), dtype=kind)
    data = {a.get("Name"): numbers(a, float) for a in piece.find("PointData")}
    points = numbers(piece.find("Points/DataArray"), float).reshape(-1, 3)
    cells = {a.get("Name"): numbers(a, int) for a in piece.find("Cells")}
    split = np.split(cells["connectivity"], cells["offsets"][:-1]) if cells["offsets"].size else []
    shown = [(kind, c) for kind, c in zip(cells["types"], split) if (data["part"][c] == 2).all()]
    return points, data, shown


def boundary(hexahedra):
    """The quadrilaterals that only one hexahedron has, repeated corners left out."""
    sides = {}
    for c in hexahedra:
        for side in ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)):
            quad = [c[k] for k in side]
            quad = [x for k, x in enumerate(quad) if x != quad[k - 1]]
            if len(set(quad)) > 2:
                sides.setdefault(tuple(sorted(quad)), []).append(quad)
    return [quads[0] for quads in sides.values() if len(quads) == 1]


def fans(polygons, turned):
    """Triangles of polygons, a quadrilateral's by one diagonal or, turned, the other."""
    found = []
    for c in polygons:
        c = list(c[1:]) + [c[0]] if turned and len(c) == 4 else list(c)
        found += [(c[0], c[k], c[k + 1]) for k in range(1, len(c) - 1)]
    return np.array(found)


def edge_uses(triangles):
    """How often each edge is used one way and the other."""
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    turned = directed[:, 0] > directed[:, 1]
    edges, of = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    of = of.ravel()
    return np.bincount(of[~turned], minlength=len(edges)), np.bincount(of[turned], minlength=len(edges))


def signed_volume(corners):
    local = corners - corners.mean(axis=(0, 1))
    return np.einsum("ij,ij->i", local[:, 0], np.cross(local[:, 1], local[:, 2])).sum() / 6


KINDS = (  # axes, their kinds, poles
    (1, ("even",), False), (1, ("uneven",), False), (1, ("closed",), False), (1, ("closed uneven",), False),
    (2, ("even", "even"), False), (2, ("uneven", "uneven"), False), (2, ("closed", "uneven"), False), (2, ("closed", "closed"), False),
    (2, ("closed uneven", "closed"), False), (2, ("met", "met uneven"), False), (3, ("met", "even", "closed"), False), (2, ("closed", "even"), True), (2, ("closed uneven", "uneven"), True),
    (3, ("even", "uneven", "even"), False), (3, ("closed", "even", "even"), False), (3, ("closed", "closed", "even"), False), (3, ("closed", "even", "even"), True))


class SampledFiles(InFolder):
    def cases(self):
        for k in range(CASES):
            rng = np.random.default_rng([SEED, k])
            axes, kinds, poles = KINDS[k % len(KINDS)]
            size, offset = (1e-6, 1, 1e6)[(k + k // len(KINDS)) % 3], (0, 0, 1e6)[int(rng.integers(3))]
            spline = placed(make(rng, axes, int(rng.integers(2, 4)) if axes == 1 else 3, kinds, poles, mirrored=bool(k % 2)), size, offset)
            chord = size * 10 ** rng.uniform(-2.5, -1.5 if axes < 3 else -1)
            yield k, rng, spline, kinds, poles, chord, f"case {k} of seed {SEED}: {kinds}, poles {poles}, degrees {spline['degree']}, size {size}, offset {offset}, chord {chord:.3g}"

    def write(self, spline):
        """The spline about its first control point, which is judged: the place of the original takes digits from whoever evaluates it."""
        (self.folder / "s.json").write_text(json.dumps(spline))
        control = np.array(spline["control_points"])
        self.centre = control[0]
        self.rounding = 2.0 ** -52 * abs(control).max()
        return {**spline, "control_points": (control - self.centre).tolist()}

    def convert(self, name, *arguments, status=0):
        done = self.run_batten("convert", "s.json", "-o", name, *arguments)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def judge_mesh(self, spline, corners, allowed, rng, what):
        """Dense points are near the facets, points of facets near the spline; the largest of these distances in parts of what is allowed."""
        shown = faces(spline)
        dense = np.concatenate([inside(face, 3, rng) for face in shown])
        dense = dense[rng.permutation(len(dense))[:max(20, min(250, 1_500_000 // len(corners)))]]
        out = to_triangles(dense, corners).max()
        some_of = corners[rng.permutation(len(corners))[:60]]
        weights = rng.dirichlet([1, 1, 1], len(some_of))
        weights[::3] = (0.5, 0, 0.5)  # diagonals, where a twist shows most
        on = np.einsum("ik,ikd->id", weights, some_of)
        back = np.min([to_spline(on, face) for face in shown], axis=0)
        if (far := back > allowed).any():  # or the search was too coarse for a fold
            back[far] = np.min([to_spline(on[far], face, finer=4) for face in shown], axis=0)
        back = back.max()
        self.assertLessEqual(out, allowed, what)
        self.assertLessEqual(back, allowed, what)
        return max(out, back) / allowed

    def test_what_is_promised_holds(self):
        parts = {}
        for k, rng, spline, kinds, poles, chord, what in some(self.cases()):
            spline = self.write(spline)
            self.convert("s.vtu", "--chord-tolerance", chord)
            points, data, cells = read_vtu(self.folder / "s.vtu")
            points = points[:, :len(self.centre)] - self.centre
            allowed = chord + self.rounding
            if len(kinds) == 1:
                ends = points[np.array([c for _, c in cells])]
                dense = inside(spline, 40, rng)
                share = rng.uniform(0, 1, (len(ends), 1))
                away = max(to_lines(dense, ends).max(), to_spline(share * ends[:, 0] + (1 - share) * ends[:, 1], spline).max())
                self.assertLessEqual(away, allowed, what)
                parts.setdefault("curve", []).append(away / chord)
                self.judge_places(spline, chord, what)
                continue
            solid = len(kinds) == 3
            polygons = boundary([c for _, c in cells]) if solid else [c for _, c in cells]
            for turned in (False, True):
                triangles = fans(polygons, turned)
                if turned or k % 3 == 0:
                    parts.setdefault("volume" if solid else "surface", []).append(self.judge_mesh(spline, points[triangles], allowed, rng, what))
            encloses = solid or (around(kinds[0]) and (poles or around(kinds[1])))
            if encloses:
                one, other = edge_uses(triangles)
                self.assertEqual((set(one), set(other)), ({1}, {1}), what)
            self.judge_places(spline, chord, what)
            self.judge_stl(spline, chord, encloses, rng, what, parts)
        print("\nlargest distance in parts of the tolerance, mean and worst: " + "; ".join(f"{name} {np.mean(p):.2f} {max(p):.3f}" for name, p in parts.items()))

    def judge_places(self, spline, chord, what):
        """The grid of a .vts is that of the .csv: the spline's points at its parameters."""
        self.convert("s.vts", "-o", "s.csv", "--chord-tolerance", chord)
        axes, dim = len(spline["degree"]), len(spline["control_points"][0])
        table = np.loadtxt(self.folder / "s.csv", delimiter=",", skiprows=1, ndmin=2)
        t = [np.unique(table[:, k]) for k in range(axes)]
        points = evaluate(spline, *t).reshape(-1, dim)
        self.assertLess(abs(table[:, axes:] - self.centre - points).max(), 1e-11 * size_of(spline) + self.rounding, what)
        piece = ElementTree.parse(self.folder / "s.vts").getroot().find(".//Piece")
        extent = np.array(piece.get("Extent").split(), dtype=int).reshape(3, 2)
        self.assertEqual([x.size for x in reversed(t)] + [1] * (3 - axes), (extent[:, 1] + 1).tolist(), what)
        grid = np.array(piece.find("Points/DataArray").text.split(), dtype=float).reshape(-1, 3)
        self.assertLess(abs(grid[:, :dim] - table[:, axes:]).max(), 1e-300, what)

    def judge_stl(self, spline, chord, encloses, rng, what, parts):
        moved = FLOAT * np.linalg.norm(abs(np.array(spline["control_points"]) + self.centre).max(axis=0))
        if moved > size_of(spline) / 20:  # hardly a point is left apart
            return
        said = self.convert("s.stl", "--chord-tolerance", chord)
        self.assertEqual("single precision" in said, moved > chord / 2, (what, said))
        normal, corners = read_stl(self.folder / "s.stl")
        corners -= self.centre
        parts.setdefault("stl", []).append(self.judge_mesh(spline, corners, max(chord, chord / 2 + moved), rng, what))
        _, vertex = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
        triangles = vertex.reshape(-1, 3)
        self.assertTrue((triangles != np.roll(triangles, 1, axis=1)).all(), what)
        if encloses:
            one, other = edge_uses(triangles)
            self.assertEqual(one.tolist(), other.tolist(), what)
            if moved < chord / 100 and "uneven" not in what:  # else rounding may make two edges one
                self.assertEqual(set(one), {1}, what)
                self.assertGreater(signed_volume(corners), 0, what)

    def test_a_saddle_is_more_than_two_triangles(self):
        """Bilinear, degree raised or not: only its twist bends it, and the bound is met closely."""
        for degree, n in ((1, 2), (3, 4)):
            t = np.linspace(0, 1, n)
            knots = [0] * (degree + 1) + [1] * (degree + 1)
            control = [[10 * a, 10 * b, 10 * a * b] for a in t for b in t]
            spline = self.write({"format": "batten-spline", "version": 1, "degree": [degree] * 2, "knots": [knots] * 2, "control_shape": [n, n], "control_points": control})
            self.convert("s.stl", "--chord-tolerance", 0.01)
            _, corners = read_stl(self.folder / "s.stl")
            middle = (corners[:, 0] + corners[:, 2]) / 2  # of the diagonals
            away = abs(middle[:, 2] - middle[:, 0] * middle[:, 1] / 10)
            self.assertLess(away.max(), 0.01)
            self.assertLess(len(corners), 2 * 16.5 ** 2)  # a quarter of the twist of n x n cells: 10 / (4 n^2) is 0.01 at n = 15.8

    def test_functions_are_drawn_over_their_parameters(self):
        rng = np.random.default_rng(3)
        for axes in (1, 2, 3):
            knots = [[0, 0, 0, 0.3, 2, 2, 2], [5, 5, 5, 6, 7, 7, 7], [0, 0, 0, 1, 3, 3, 3]][:axes]
            spline = {"format": "batten-spline", "version": 1, "degree": [2] * axes, "knots": knots, "control_shape": [4] * axes,
                      "control_points": rng.normal(0, 100, (4 ** axes, 1)).tolist()}
            (self.folder / "s.json").write_text(json.dumps(spline))
            self.convert("s.vtu", "-o", "s.vts", "--chord-tolerance", 5)
            value = lambda at: scattered(spline, at)[:, 0]
            points, data, cells = read_vtu(self.folder / "s.vtu")
            shown = points[data["part"] == 2]
            self.assertLess(abs(data["value"][data["part"] == 2] - value(shown)).max(), 1e-10)
            if axes < 3:
                self.assertLess(abs(shown[:, axes] - value(shown)).max(), 1e-10)
            middles = np.array([points[c].mean(axis=0) for _, c in cells])
            means = np.array([data["value"][c].mean() for _, c in cells])
            self.assertLess(abs(value(middles) - means).max(), 5 + 1e-9)
            self.assertGreater(abs(value(middles) - means).max(), 0.5)
            piece = ElementTree.parse(self.folder / "s.vts").getroot().find(".//Piece")
            grid = np.array(piece.find("Points/DataArray").text.split(), dtype=float).reshape(-1, 3)
            listed = np.array(piece.find("PointData/DataArray").text.split(), dtype=float)
            self.assertLess(abs(listed - value(grid)).max(), 1e-10)
            if axes == 3:
                self.assertIn("functions of one and two variables", self.convert("s.svg", status=2))
                continue
            self.convert("s.svg", "-o", "s.obj")
            words = [line.split() for line in (self.folder / "s.obj").read_text().splitlines()]
            net = np.array([w[1:] for w in words if w[0] == "v"], dtype=float)
            order = np.arange(4 ** axes).reshape([4] * axes).T.ravel()  # its first axis is the fastest
            drawn = {**spline, "control_points": net[np.argsort(order)]}
            t = [np.linspace(k[0], k[-1], 9) for k in knots]
            at = np.stack(np.meshgrid(*t, indexing="ij"), axis=-1).reshape(-1, axes)
            self.assertLess(abs(evaluate(drawn, *t).reshape(-1, 3)[:, :axes + 1] - np.column_stack([at, value(at)])).max(), 1e-10)

    def test_a_page_shows_a_function_as_its_graph(self):
        """What the page draws, its stretch taken back: samples over their parameters on the spline's values, control points over the means of knots."""
        t = np.linspace(0, 1, 40)
        heights = 1e-6 * np.sin(6 * t) + 3
        np.savetxt(self.folder / "f.csv", heights)
        done = self.run_batten("fit", "f.csv", "--parametrize", "uniform", "-n", 12, "-q", "-o", "s.json", "--report", "f.html", "-o", "f.vtu")
        self.assertEqual(done.returncode, 0, done.stderr)
        spline = json.loads((self.folder / "s.json").read_text())
        page = (self.folder / "f.html").read_text()
        data = json.loads(page.split('id="batten-data"', 1)[1].split(">", 1)[1].split("</script>", 1)[0])
        drawn = lambda text: np.frombuffer(base64.b64decode(text), "<f4").reshape(-1, 2) / data["stretch"] + data["centre"]
        self.assertTrue(data["graph"])
        self.assertLess(abs((drawn(data["samples"]) - np.column_stack([t, heights])) / [1, 1e-6]).max(), 1e-6)
        knots = np.array(spline["knots"][0])
        means = [knots[k + 1:k + 4].mean() for k in range(12)]
        expected = np.column_stack([means, np.array(spline["control_points"])[:, 0]])
        self.assertLess(abs((drawn(data["spline"]["control"]) - expected) / [1, 1e-6]).max(), 1e-6)
        points, values, _ = read_vtu(self.folder / "f.vtu")
        self.assertLess(abs(points[values["part"] == 0][:, :2] - np.column_stack([t, heights])).max(), 1e-14)

    def test_a_spline_that_is_one_point(self):
        for axes in (1, 2, 3):
            for degree in (2, 5):
                n = degree + 2
                knots = [0] * (degree + 1) + [0.4] + [1] * (degree + 1)
                spline = {"format": "batten-spline", "version": 1, "degree": [degree] * axes, "knots": [knots] * axes, "control_shape": [n] * axes,
                          "control_points": [[0.1, 2e5, 3.7]] * n ** axes}
                (self.folder / "s.json").write_text(json.dumps(spline))
                self.convert("s.vtu", "-o", "s.vts", "-o", "s.csv", "-o", "s.svg")
                points, data, cells = read_vtu(self.folder / "s.vtu")
                self.assertEqual([(kind, points[c].tolist()) for kind, c in cells], [(1, [[0.1, 2e5, 3.7]])])
                self.assertIn("<path", (self.folder / "s.svg").read_text())
                self.assertNotIn("nan", (self.folder / "s.svg").read_text())
                self.assertEqual((self.folder / "s.csv").read_text().splitlines()[1:], [",".join(["0"] * axes + ["0.1", "200000", "3.7"])])
                words = "has 1 axis" if axes == 1 else "has none: its points lie on a line"
                said = self.convert("s.stl", status=2)
                self.assertIn(words, said)
                self.assertEqual(said.count("\n"), 1)

    def test_what_cannot_be_kept_is_said_at_once(self):
        t = np.linspace(0, 1, 4)
        spline = {"format": "batten-spline", "version": 1, "degree": [3, 3], "knots": [[0] * 4 + [1] * 4] * 2, "control_shape": [4, 4],
                  "control_points": [[a, b, 1e6 + a * b] for a in t for b in t]}
        (self.folder / "s.json").write_text(json.dumps(spline))
        self.assertIn("single precision moves points by up to 0.06", self.convert("s.stl", "--chord-tolerance", 0.01))
        self.assertIn(b"rounded by up to 0.06", (self.folder / "s.stl").read_bytes()[:80])
        self.assertEqual(self.convert("s.stl", "--chord-tolerance", 0.5), "")
        self.assertIn("double precision moves these points by up to", self.convert("s.vtu", "--chord-tolerance", 1e-12, status=2))
        self.assertEqual(self.convert("s.vtu", "--chord-tolerance", 1e-8, status=2), "batten: chord tolerance 1e-08: more than 1e+07 points would be needed\n")

    def test_a_graph_beyond_single_precision_is_no_stl(self):
        heights = {"format": "batten-spline", "version": 1, "degree": [1, 1], "knots": [[0, 0, 1e39, 1e39]] * 2, "control_shape": [2, 2],
                   "control_points": [[0], [1], [2], [4]]}
        (self.folder / "s.json").write_text(json.dumps(heights))
        self.assertEqual(self.convert("s.stl", status=2), "batten: an .stl holds single precision, a coordinate of 1e+39 is beyond it\n")
        self.assertFalse((self.folder / "s.stl").exists())

    def test_a_volume_closed_along_all_axes_is_no_curve(self):
        n, degree = 4, 2
        knots = [k / n for k in range(-degree, n + degree + 1)]
        free = np.random.default_rng(1).random((n, n, n, 3))
        control = np.pad(free, [(0, degree)] * 3 + [(0, 0)], mode="wrap")
        spline = {"format": "batten-spline", "version": 1, "degree": [degree] * 3, "closed": [True] * 3, "knots": [knots] * 3,
                  "control_shape": [n + degree] * 3, "control_points": control.reshape(-1, 3).tolist()}
        (self.folder / "s.json").write_text(json.dumps(spline))
        self.convert("s.svg")
        self.assertNotIn('class="curve"', (self.folder / "s.svg").read_text())


def size_of(spline):
    return np.ptp(np.array(spline["control_points"]), axis=0).max()


if __name__ == "__main__":
    unittest.main()
