"""What the command's tests judge by: written splines by SciPy alone, distances that a point of the spline proves, and what a test needs to run."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

BATTEN = os.environ["BATTEN"]
ROOT = pathlib.Path(os.environ["BATTEN_ROOT"])
SHARED = ROOT.parent / "shared" / "data"
HAS_CAD = (pathlib.Path(BATTEN).parent / "batten-cad").exists()
# a sanitizer needs address space and threads of its own: what limits them is tested in the other builds
SANITIZED = os.environ.get("BATTEN_SANITIZED") == "1"
GUARD = 1200  # seconds: ends a test that hangs, never one on a busy machine
# before a command: files and folders keep their modes' word, also for root
ORDINARY = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"] if os.geteuid() == 0 else []
for number in (signal.SIGHUP, signal.SIGINT, signal.SIGTERM):
    if signal.getsignal(number) == signal.SIG_IGN:  # under nohup programs would be started as deaf as the tests
        signal.signal(number, signal.SIG_DFL)


def some(cases):
    """All cases; a sanitizer, which is ten times as slow and judges each by itself, gets every sixth of them."""
    cases = list(cases)
    return cases[::6] if SANITIZED else cases


class InFolder(unittest.TestCase):
    """Runs the command in a folder of the test's own."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def run_batten(self, *arguments, stdin=None):
        return subprocess.run([BATTEN, *map(str, arguments)], cwd=self.folder, input=stdin, capture_output=True, text=True, timeout=GUARD)


def lacks(test, what):
    """Ends a test that cannot run: failed where CI is set, else named as not run."""
    if os.environ.get("CI"):
        test.fail(what)
    print(f"NOT RUN: {test.id()}: {what}", file=sys.stderr)
    test.skipTest(what)


def shared(test, name):
    """The path of a file or folder of the shared test data."""
    if not (SHARED / name).exists():
        lacks(test, f"shared data absent: {name}")
    return SHARED / name


def airfoils(test):
    return sorted(shared(test, "airfoils").glob("*.dat"))


def read_spline(path):
    return json.loads(pathlib.Path(path).read_text())


def control_points(spline):
    """(n0 x n1 ... x dim)."""
    return np.array(spline["control_points"]).reshape(*spline["control_shape"], -1)


def curve(spline):
    return BSpline(np.array(spline["knots"][0]), np.array(spline["control_points"]), spline["degree"][0])


def evaluate(spline, *parameters):
    """Points over the grid of the axes' parameters."""
    points = control_points(spline)
    for axis, t in enumerate(parameters):
        one = BSpline(np.array(spline["knots"][axis]), np.moveaxis(points, axis, 0), spline["degree"][axis])
        points = np.moveaxis(one(t), 0, axis)
    return points


def places(spline, axis=0, each=64):
    """Parameters of one axis, `each` to a polynomial piece."""
    knots, degree = np.array(spline["knots"][axis]), spline["degree"][axis]
    breaks = np.unique(knots[degree:-degree])
    return np.concatenate([np.linspace(a, b, each, endpoint=False) for a, b in zip(breaks, breaks[1:])] + [[breaks[-1]]])


def distances(spline, points):
    """The distance of each point from a curve: the four best places of a dense search, each closed in on. Points of the curve prove it: it is
    never too small."""
    line, t = curve(spline), places(spline)
    dense = line(t)
    found = []
    for p in np.array_split(points, max(1, len(points) // 64)):
        square = ((dense - p[:, None]) ** 2).sum(axis=-1)
        beside = np.pad(square, ((0, 0), (1, 1)), constant_values=np.inf)
        lowest = np.where((square <= beside[:, :-2]) & (square <= beside[:, 2:]), square, np.inf).argsort(axis=1)[:, :4]
        low, high = t[np.maximum(lowest - 1, 0)], t[np.minimum(lowest + 1, t.size - 1)]
        for _ in range(16):
            s = low[..., None] + (high - low)[..., None] * np.linspace(0, 1, 9)
            away = ((line(s) - p[:, None, None]) ** 2).sum(axis=-1)
            best = away.argmin(axis=-1)[..., None]
            low = np.take_along_axis(s, np.maximum(best - 1, 0), -1)[..., 0]
            high = np.take_along_axis(s, np.minimum(best + 1, 8), -1)[..., 0]
        found.append(np.sqrt(away.min(axis=(1, 2))))
    return np.concatenate(found)


def largest_distance(spline, points):
    return distances(spline, points).max()


def surface_distances(spline, points, each=8):
    """The distance of each point from a surface: the best place of a dense search, closed in on; never too small."""
    u, v = places(spline, 0, each), places(spline, 1, each)
    dense = evaluate(spline, u, v)
    found = []
    for p in points:
        i, j = np.unravel_index(((dense - p) ** 2).sum(axis=-1).argmin(), dense.shape[:2])
        away = lambda t: evaluate(spline, t[:1], t[1:])[0, 0] - p
        best = least_squares(away, [u[i], v[j]], bounds=([u[0], v[0]], [u[-1], v[-1]]), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        found.append(min(np.linalg.norm(dense[i, j] - p), np.linalg.norm(best.fun)))
    return np.array(found)


def chord(points):
    """Parameters by accumulated chord length."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return length / length[-1]
