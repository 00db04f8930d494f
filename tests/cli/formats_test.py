"""Files for and from other programs: each is read or made by something else (SciPy, meshio, ElementTree, struct) and numbers agree."""
import json
import struct
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD, HAS_CAD, InFolder, lacks, surface_distances


def evaluate(knots, control, degree, parameters):
    """Points over the grid of parameters by SciPy; control of shape n0 x n1 ... x dim."""
    for axis, t in enumerate(parameters):
        control = np.moveaxis(BSpline(np.array(knots[axis]), np.moveaxis(control, axis, 0), degree[axis])(t), 0, axis)
    return control


class Formats(InFolder):
    def batten(self, *arguments, status=0):
        done = subprocess.run([BATTEN, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=GUARD)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout if status == 0 else done.stderr

    def fits(self):
        """A closed curve, a surface and a volume, with their JSON."""
        self.batten("generate", "helix", "-o", "helix.csv")
        self.batten("generate", "naca2412", "-o", "wing.csv")
        self.batten("generate", "peaks", "-o", "peaks.npy")
        u = np.linspace(0, 1, 9)
        x, y, z = np.meshgrid(u, u, u, indexing="ij")
        np.save(self.folder / "block.npy", np.stack([x, y + 0.2 * x * x, z + 0.1 * np.sin(3 * y)], axis=-1))
        self.batten("fit", "helix.csv", "-t", "1e-2", "-q", "-o", "helix.json")
        self.batten("fit", "wing.csv", "-t", "1e-3", "--closed", "-q", "-o", "wing.json")
        self.batten("fit", "peaks.npy", "-n", "20x25", "-q", "-o", "peaks.json")
        self.batten("fit", "block.npy", "-n", "5x5x5", "-q", "-o", "block.json")
        return {name: json.loads((self.folder / f"{name}.json").read_text()) for name in ("helix", "wing", "peaks", "block")}

    def points(self, spline, count=17):
        knots, degree = spline["knots"], spline["degree"]
        t = [np.linspace(k[p], k[-p - 1], count) for k, p in zip(knots, degree)]
        return evaluate(knots, np.array(spline["control_points"]).reshape(*spline["control_shape"], -1), degree, t)

    def test_what_a_format_cannot_hold_is_said_before_the_fit(self):
        """In the words that a conversion has, though the fit would fail at once for another reason."""
        extensions = [".json", ".svg", ".obj", ".g2", ".stl", ".vts", ".vtu", ".csv"] + ([".step", ".igs"] if HAS_CAD else [])
        refused = 0
        for axes in (1, 2, 3):
            for dim in (1, 2, 3, 4, 5):
                points = np.random.default_rng(10 * axes + dim).random((7,) * axes + (dim,))
                np.save(self.folder / "q.npy", points.cumsum(axis=0))
                fit = ["fit", "q.npy", "-n", "x".join("5" * axes), "--parametrize", "uniform", "-q"]
                self.batten(*fit, "-o", "q.json")
                for extension in extensions:
                    converted = self.run_batten("convert", "q.json", "-o", f"c{extension}")
                    before = self.run_batten(*fit, "--interpolate", "99999", "-o", f"f{extension}")
                    self.assertEqual(before.returncode, 2)
                    if converted.returncode:
                        refused += 1
                        self.assertEqual((converted.returncode, before.stderr), (2, converted.stderr), (axes, dim, extension))
                    else:
                        self.assertIn("99999", before.stderr)
                    self.assertFalse((self.folder / f"f{extension}").exists())
        self.assertGreater(refused, 40)

    def test_wavefront_free_form(self):
        for name, spline in self.fits().items():
            if name == "block":
                self.assertEqual(self.batten("convert", "block.json", "-o", "b.obj", status=2),
                                 "batten: an .obj holds curves and surfaces in space, this spline has 3 axes in dimension 3\n")
                continue
            self.batten("convert", f"{name}.json", "-o", f"{name}.obj")
            words = [line.split() for line in (self.folder / f"{name}.obj").read_text().splitlines()]
            vertices = np.array([[float(x) for x in w[1:]] for w in words if w[0] == "v"])
            knots = {w[1]: [float(x) for x in w[2:]] for w in words if w[0] == "parm"}
            degree = [int(x) for w in words if w[0] == "deg" for x in w[1:]]
            (kind, *rest), = [w for w in words if w[0] in ("curv", "surf")]
            indices = [int(x) - 1 for x in rest[2 if kind == "curv" else 4:]]
            axes = [knots[a] for a in "uv" if a in knots]
            shape = [len(k) - p - 1 for k, p in zip(axes, degree)]
            control = vertices[indices].reshape(*shape[::-1], 3)  # the first axis is fastest
            control = np.moveaxis(control, list(range(len(shape))), list(range(len(shape)))[::-1])
            ours = self.points(spline)
            t = [np.linspace(k[p], k[-p - 1], 17) for k, p in zip(axes, degree)]
            theirs = evaluate(axes, control, degree, t)[..., :ours.shape[-1]]
            self.assertLess(abs(ours - theirs).max(), 1e-12)

    def test_go_tools(self):
        for name, spline in self.fits().items():
            self.batten("convert", f"{name}.json", "-o", f"{name}.g2")
            numbers = iter((self.folder / f"{name}.g2").read_text().split())
            take = lambda count, kind=float: [kind(next(numbers)) for _ in range(count)]
            kind, *_ = take(4, int)
            axes = {100: 1, 200: 2, 700: 3}[kind]
            dim, rational = take(2, int)
            self.assertEqual((axes, dim, rational), (len(spline["degree"]), len(spline["control_points"][0]), 0))
            knots, degree, shape = [], [], []
            for _ in range(axes):
                count, order = take(2, int)
                shape.append(count)
                degree.append(order - 1)
                knots.append(take(count + order))
            control = np.array(take(int(np.prod(shape)) * dim)).reshape(*shape[::-1], dim)
            control = np.moveaxis(control, list(range(axes)), list(range(axes))[::-1])
            t = [np.linspace(k[p], k[-p - 1], 17) for k, p in zip(knots, degree)]
            self.assertLess(abs(self.points(spline) - evaluate(knots, control, degree, t)).max(), 1e-12)

    def test_triangles_stay_within_the_chord(self):
        import meshio
        splines = self.fits()
        for name in ("peaks", "block"):
            self.batten("convert", f"{name}.json", "-o", f"{name}.stl", "--chord-tolerance", 0.02)
            mesh = meshio.read(self.folder / f"{name}.stl")
            corners = mesh.points[mesh.cells_dict["triangle"]]
            if name == "peaks":  # corners lie on the surface, to the file's float, and the middles within the chord
                some = corners[::max(1, len(corners) // 200)]
                self.assertLess(surface_distances(splines[name], some[:, 0]).max(), 1e-5)
                away = surface_distances(splines[name], some.mean(axis=1)).max()
                self.assertLess(away, 0.02)
                self.assertGreater(away, 0.02 / 50)  # and not far finer than asked
            else:  # a closed shell: its volume is the sum of signed tetrahedra
                volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
                self.assertLess(abs(volume - 1), 0.05)  # sheared, so of unit volume; facing out
        self.assertEqual(self.batten("convert", "helix.json", "-o", "h.stl", status=2), "batten: an .stl holds surfaces in space, this spline has 1 axis in dimension 3\n")

    def test_vtk_and_evaluated_points(self):
        import meshio
        splines = self.fits()
        self.batten("fit", "peaks.npy", "-n", "20x25", "-q", "-o", "p.vtu", "-o", "p.vts", "-o", "p.csv", "--summary", "s.json")
        mesh = meshio.read(self.folder / "p.vtu")
        part = mesh.point_data["part"].ravel()
        samples = np.load(self.folder / "peaks.npy").reshape(-1, 3)
        self.assertLess(abs(mesh.points[part == 0] - samples).max(), 1e-12)
        summary = json.loads((self.folder / "s.json").read_text())
        deviation = mesh.point_data["deviation"].ravel()
        self.assertEqual(deviation[part == 0].argmax(), summary["worst_sample"])
        self.assertAlmostEqual(deviation.max(), summary["max_deviation"], 12)
        self.assertLess(abs(mesh.points[part == 1] - np.array(splines["peaks"]["control_points"])).max(), 1e-12)
        table = np.genfromtxt(self.folder / "p.csv", delimiter=",", names=True)
        u, v = np.unique(table["u"]), np.unique(table["v"])
        spline = splines["peaks"]
        expected = evaluate(spline["knots"], np.array(spline["control_points"]).reshape(20, 25, 3), [3, 3], [u, v])
        got = np.stack([table[c] for c in "xyz"], axis=-1).reshape(u.size, v.size, 3)
        self.assertLess(abs(expected - got).max(), 1e-12)
        piece = ElementTree.parse(self.folder / "p.vts").find(".//Piece")
        extent = [int(x) for x in piece.get("Extent").split()]
        self.assertEqual((extent[1] + 1, extent[3] + 1), (v.size, u.size))
        grid = np.array(piece.find("Points/DataArray").text.split(), dtype=float).reshape(u.size, v.size, 3)
        self.assertLess(abs(expected - grid).max(), 1e-12)

    def cloud(self):
        rng = np.random.default_rng(4)
        place = rng.random((300, 2))
        return np.column_stack([place, 0.3 * np.sin(3 * place[:, 0])])

    def read_back(self, name):
        self.batten("fit", name, "--project", "xy", "-n", "5x5", "-q", "-o", "back.vtu")
        import meshio
        mesh = meshio.read(self.folder / "back.vtu")
        return mesh.points[mesh.point_data["part"].ravel() == 0]

    def test_ply_in_every_encoding(self):
        points = self.cloud()
        for encoding, order in (("ascii", None), ("binary_little_endian", "<"), ("binary_big_endian", ">")):
            for kind, letter in (("float", "f"), ("double", "d")):
                head = (f"ply\nformat {encoding} 1.0\ncomment <x>\nelement extra 2\nproperty list uchar int many\n"
                        f"element vertex {len(points)}\nproperty uchar red\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nproperty short q\nend_header\n")
                if order is None:
                    body = ("2 5 6\n0\n" + "".join(f"7 {x!r} {y!r} {z!r} -3\n" for x, y, z in points.tolist())).encode()
                else:
                    body = struct.pack(order + "BiiB", 2, 5, 6, 0) + b"".join(struct.pack(f"{order}B3{letter}h", 7, *p, -3) for p in points)
                (self.folder / "c.ply").write_bytes(head.encode() + body)
                self.assertLess(abs(self.read_back("c.ply") - points).max(), 1e-12 if kind == "double" or order is None else 1e-7, (encoding, kind))
        whole = (self.folder / "c.ply").read_bytes()
        (self.folder / "short.ply").write_bytes(whole[:-5])
        self.assertRegex(self.batten("info", "short.ply", status=3), f"^batten: short.ply: the file ends at byte {len(whole) - 5}, vertex 299 needs [0-9]+\n$")
        (self.folder / "huge.ply").write_bytes(whole.replace(b"vertex 300", b"vertex 99999999999999"))
        self.assertRegex(self.batten("info", "huge.ply", status=3), "batten: huge.ply: 99999999999999 elements 'vertex' are stated, [0-9]+ bytes are there")
        for text, message in (("plx", "not a PLY file: its first line is not 'ply'"), ("ply\nformat ascii 1.0\n", "the file ends inside the header"),
                              ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "the vertices have no property y"),
                              ("ply\nformat odd 1.0\n", "header line 2: 'format odd 1.0' is not understood"),
                              ("ply\nformat ascii 1.0\nend_header\n", "there are no vertices in the file")):
            (self.folder / "bad.ply").write_text(text)
            self.assertEqual(self.batten("info", "bad.ply", status=3), f"batten: bad.ply: {message}\n")

    def las(self, points, minor, compressed=False, count=None):
        header = bytearray(375 if minor == 4 else 227)
        header[:4] = b"LASF"
        header[24:26] = bytes((1, minor))
        struct.pack_into("<HI", header, 94, len(header), len(header) + 11)
        struct.pack_into("<BHI", header, 104, 1 | (0x80 if compressed else 0), 28, 0 if minor == 4 else len(points) if count is None else count)
        struct.pack_into("<6d", header, 131, 1e-4, 1e-4, 1e-5, 100, 200, -5)
        if minor == 4:
            struct.pack_into("<Q", header, 247, len(points))
        raw = np.round((points - [100, 200, -5]) / [1e-4, 1e-4, 1e-5]).astype(int)
        return bytes(header) + bytes(11) + b"".join(struct.pack("<3i16x", *p) for p in raw.tolist())

    def test_las(self):
        points = self.cloud() * [50, 50, 10] + [100, 200, -5]
        for minor in (2, 3, 4):
            (self.folder / "c.las").write_bytes(self.las(points, minor))
            self.assertLess(abs(self.read_back("c.las") - points).max(), 1e-4)
        for content, message in ((self.las(points, 2)[:-1], "300 points of 28 bytes are stated, 8399 bytes are there after byte 238"),
                                 (self.las(points, 2, count=4_000_000_000), "4000000000 points of 28 bytes are stated, 8400 bytes are there after byte 238"),
                                 (self.las(points, 3, compressed=True), "the points are compressed (LAZ); only plain LAS is read"),
                                 (self.las(points, 2)[:100], "the file ends at byte 100, the header needs 104"),
                                 (b"LASX", "not a LAS file: its first bytes are not LASF"),
                                 (self.las(points, 2).replace(b"\x01\x02", b"\x01\x09", 1), "LAS version 1.9 is outside 1.2 to 1.4")):
            (self.folder / "bad.las").write_bytes(content)
            self.assertEqual(self.batten("info", "bad.las", status=3), f"batten: bad.las: {message}\n")

    def test_vertices_of_meshes(self):
        import meshio
        points = self.cloud()
        triangles = np.arange(300).reshape(-1, 3)
        meshio.write(self.folder / "m.obj", meshio.Mesh(points, [("triangle", triangles)]))
        self.assertLess(abs(self.read_back("m.obj") - points).max(), 1e-6)
        for binary in (True, False):
            meshio.write(self.folder / "m.stl", meshio.Mesh(points, [("triangle", triangles)]), binary=binary)
            self.assertLess(abs(self.read_back("m.stl") - points).max(), 1e-6)
        whole = (self.folder / "m.stl").read_bytes()
        meshio.write(self.folder / "m.stl", meshio.Mesh(points, [("triangle", triangles)]), binary=True)
        whole = (self.folder / "m.stl").read_bytes()
        (self.folder / "short.stl").write_bytes(whole[:-1])
        self.assertEqual(self.batten("info", "short.stl", status=3), f"batten: short.stl: the file ends at byte {len(whole) - 1}, 100 facets need {len(whole)}\n")
        (self.folder / "bad.obj").write_text("v 1 2 3\nv 1 two 3\n")
        self.assertEqual(self.batten("info", "bad.obj", status=3), "batten: bad.obj:2: a vertex needs three numbers\n")
        (self.folder / "none.obj").write_text("f 1 2 3\n")
        self.assertEqual(self.batten("info", "none.obj", status=3), "batten: none.obj: there are no vertices in the file\n")

    def test_clouds_need_no_knob(self):
        points = self.cloud() * [50, 50, 10] + [100, 200, -5]
        (self.folder / "c.las").write_bytes(self.las(points, 2))
        self.batten("fit", "c.las", "-t", "0.05", "-q", "-o", "c.json", "--summary", "s.json")
        summary = json.loads((self.folder / "s.json").read_text())
        self.assertEqual((summary["kind"], summary["termination"]), ("surface", "tolerance_met"))

    def test_cad_is_loaded_only_when_used(self):
        linked = subprocess.run(["ldd", BATTEN], capture_output=True, text=True).stdout
        self.assertNotIn("libTK", linked)

    def test_step_and_iges_go_through_the_command(self):
        if not HAS_CAD:
            lacks(self, "built without the CAD module")
        splines = self.fits()
        self.batten("convert", "helix.json", "peaks.json", "-o", "all.step", "--unit", "in")
        self.assertEqual(self.batten("info", "all.step").count("B-spline"), 2)
        self.batten("fit", "wing.csv", "-t", "1e-3", "--interpolate", "ends", "-q", "-o", "w.step", "-o", "w.igs", "-o", "w.json")
        wing = json.loads((self.folder / "w.json").read_text())
        for name in ("w.step", "w.igs"):
            self.batten("convert", name, "-o", "back.json")
            back = json.loads((self.folder / "back.json").read_text())
            self.assertLess(abs(np.array(back["control_points"])[:, :2] - np.array(wing["control_points"])).max(), 1e-9)
            self.assertLess(abs(np.array(back["knots"]) - np.array(wing["knots"])).max(), 1e-9)
        self.assertIn("largest 0.000", self.batten("compare", "w.step", "wing.csv"))  # points of the plane beside a curve of space
        first = (self.folder / "w.step").read_bytes()
        self.assertEqual(self.batten("fit", "wing.csv", "-t", "1e-3", "--interpolate", "ends", "-q", "-o", "w.step"), "")
        self.assertTrue(first == (self.folder / "w.step").read_bytes())
        self.assertEqual(self.batten("convert", "block.json", "-o", "b.step", status=2),
                         "batten: a CAD file holds curves and surfaces in space, this spline has 3 axes in dimension 3\n")
        (self.folder / "bad.step").write_text("no\n")
        self.assertEqual(self.batten("info", "bad.step", status=3), "batten: bad.step: not a STEP file that can be read\n")
        self.assertEqual(self.batten("convert", "helix.json", "peaks.json", "-o", "two.svg", status=2), "batten: two.svg: .svg files hold one spline, got 2\n")

    def test_pictures(self):
        self.fits()
        for name in ("helix", "wing", "peaks", "block"):
            svg = ElementTree.fromstring(self.batten("plot", f"{name}.json"))
            self.assertTrue(svg.tag.endswith("svg"))
            self.assertGreater(len(list(svg.iter("{http://www.w3.org/2000/svg}path"))), 1)
        self.batten("plot", "peaks.json", "peaks.npy", "-o", "p.svg")
        np.save(self.folder / "heights.npy", np.load(self.folder / "peaks.npy")[..., 2])
        self.batten("fit", "heights.npy", "--heights", "--spacing", "0.05,0.066", "-n", "20x25", "-q", "-o", "h.json")
        self.assertIn("14641 points", self.batten("compare", "h.json", "heights.npy", "--heights", "--spacing", "0.05,0.066"))
        self.assertIn("deviation", (self.folder / "p.svg").read_text())
        self.assertEqual(self.batten("plot", "peaks.json", "-o", "p.png", status=2), "batten: plot: p.png: a picture .svg is written\n")

    def test_nothing_half_written(self):
        self.fits()
        for name in ("x.obj", "x.vtu", "x.csv", "x.svg") + (("x.step",) if HAS_CAD else ()):
            self.assertEqual(self.batten("convert", "helix.json", "-o", f"none/{name}", status=3), f"batten: none/{name}: the folder none does not exist\n")
        before = sorted(p.name for p in self.folder.iterdir())
        self.assertEqual("batten: none/r.html: the folder none does not exist\n", self.batten("fit", "wing.csv", "-t", "1e-3", "--report", "none/r.html", status=3))
        self.assertEqual(before, sorted(p.name for p in self.folder.iterdir()))


if __name__ == "__main__":
    unittest.main()
