"""Control points within a stated distance: batten against Open CASCADE, SISL and FITPACK on the same files in one run. Writes docs/tolerance.md."""
import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np
from scipy.interpolate import splev, splprep

ROOT = pathlib.Path(__file__).resolve().parent.parent
BATTEN = ROOT / "build" / "release" / "batten"
PEERS = ROOT / "build" / "release" / "benchmarks" / "race_peers"
TOLERANCES = (1e-2, 1e-3, 1e-4)


def fitpack(points, tolerance):
    """splprep with s found by bisection so that the largest parametric distance is just within the tolerance."""
    keep = np.concatenate([[True], np.linalg.norm(np.diff(points, axis=0), axis=1) > 0])
    q = points[keep]
    start = time.perf_counter()
    low, high, best = 0.0, len(q) * (10 * tolerance) ** 2, None
    for _ in range(24):
        s = (low + high) / 2
        try:
            tck, u = splprep(q.T, s=s, k=3)
        except Exception:
            break
        distance = np.linalg.norm(np.array(splev(u, tck)).T - q, axis=1).max()
        if distance <= tolerance:
            low, best = s, len(tck[0]) - 4
        else:
            high = s
    return best, 1e3 * (time.perf_counter() - start)


def batten(path, tolerance, folder, *more):
    summary = folder / "s.json"
    subprocess.run([BATTEN, "fit", path, "--tolerance", str(tolerance), "-q", "--summary", summary, *more], check=False)
    s = json.loads(summary.read_text())
    count = int(np.prod(s["control_shape"]))
    return count, 1e3 * s["seconds"]["total"], s["termination"] == "tolerance_met", s


class Peer:
    """The peers' program on one file; started again when a peer brings it down."""

    def __init__(self, path):
        self.path = path
        self.start()

    def start(self):
        self.process = subprocess.Popen([PEERS, self.path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    def ask(self, line):
        self.process.stdin.write(line)
        self.process.stdin.flush()
        answer = self.process.stdout.readline().split()
        if not answer:
            self.start()
        return answer

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def peer(server, name, tolerance):
    answer = server.ask(f"{name} {tolerance}\n")
    if not answer or answer[0] == "failed":
        return None, None, None
    return int(np.prod([int(n) for n in answer[1].split("x")])), float(answer[0]), float(answer[2])


def cell(count, time_ms, kept=True):
    if count is None:
        return "failed or crashed"
    return f"{count}{'' if kept else ' (not kept)'}, {time_ms:.0f} ms"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data", help="folder of the measured files")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    lines = ["# Fits to a tolerance, beside the peers", "",
             "Written by `benchmarks/race tolerance`: control points at a maximum distance T over all samples, cubic, and the median time of the call in one run.",
             "FITPACK is `splprep` with s found by bisection (its distance is parametric, its time is the whole bisection's), Open CASCADE is `GeomAPI_PointsToBSpline`",
             "and `...Surface` (C2), SISL is `s1961`. *Not kept*: the result is farther than T from a sample by closest points (curves).", "",
             "| data | T | batten | FITPACK | Open CASCADE | SISL |", "|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for data in ("profile205.csv", "glyph273.csv", "glyph577.csv", "rose", "helix", "naca2412"):
            path = options.data / data
            if not data.endswith(".csv"):
                path = folder / f"{data}.csv"
                subprocess.run([BATTEN, "generate", data, "-o", path], check=True)
            elif not path.exists():
                continue
            points = np.loadtxt(path, delimiter=",", skiprows=1 if data.endswith(".csv") else 0)
            server = Peer(path)
            peer(server, "occ", 1e-1)  # the first call pays for loading
            for tolerance in TOLERANCES:
                ours, occ, sisl = [], [], []
                for _ in range(options.rounds):
                    ours.append(batten(path, tolerance, folder))
                    occ.append(peer(server, "occ", tolerance))
                    sisl.append(peer(server, "sisl", tolerance))
                median = lambda rows: statistics.median(r[1] for r in rows) if rows[0][0] is not None else None
                theirs = fitpack(points, tolerance)
                lines.append(f"| {data} | {tolerance:g} | {cell(ours[0][0], median(ours), ours[0][2])} | {cell(*theirs)} | "
                             f"{cell(occ[0][0], median(occ), occ[0][0] is not None and occ[0][2] <= tolerance)} | "
                             f"{cell(sisl[0][0], median(sisl), sisl[0][0] is not None and sisl[0][2] <= tolerance)} |")
                print(lines[-1], flush=True)
            server.close()
        lines += ["", "Surfaces, control points in all (heights over a regular grid; terrain spacing 60):", "", "| data | T | batten | Open CASCADE |", "|---|---|---|---|"]
        subprocess.run([BATTEN, "generate", "peaks", "-o", folder / "peaks.npy"], check=True)
        np.save(folder / "heights.npy", np.load(folder / "peaks.npy")[..., 2])
        jobs = [("peaks 121 x 121", folder / "heights.npy", folder / "peaks.npy", (0.1, 0.01, 0.001), "1,1")]
        terrain = options.data / "terrain344x403.npy"
        if terrain.exists():
            h = np.load(terrain)
            i, j = np.meshgrid(60.0 * np.arange(h.shape[0]), 60.0 * np.arange(h.shape[1]), indexing="ij")
            np.save(folder / "terrain.npy", np.stack([i, j, h], axis=-1))
            jobs.append(("terrain 344 x 403", terrain, folder / "terrain.npy", (20, 10, 5), "60,60"))
        for name, heights, grid, tolerances, spacing in jobs:
            server = Peer(grid)
            for tolerance in tolerances:
                ours = [batten(heights, tolerance, folder, "--heights", "--spacing", spacing) for _ in range(3)]
                occ = [peer(server, "occ", tolerance) for _ in range(3 if "peaks" in name else 1)]
                shape = "x".join(map(str, ours[0][3]["control_shape"]))
                lines.append(f"| {name} | {tolerance:g} | {shape} = {cell(ours[0][0], statistics.median(o[1] for o in ours), ours[0][2])} | "
                             f"{cell(occ[0][0], statistics.median(o[1] for o in occ))} |")
                print(lines[-1], flush=True)
            server.close()
    (ROOT / "docs" / "tolerance.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
