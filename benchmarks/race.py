"""batten against SciPy on the same data in one run: interleaved, medians, files read outside the time, residuals compared first."""
import argparse
import json
import pathlib
import platform
import statistics
import subprocess
import tempfile
import time

import numpy as np
from scipy.interpolate import LSQBivariateSpline, make_lsq_spline

ROOT = pathlib.Path(__file__).resolve().parent.parent
SERVER = ROOT / "build" / "release" / "benchmarks" / "race_batten"


def uniform_knots(n):
    return np.concatenate([np.zeros(3), np.linspace(0, 1, n - 2), np.ones(3)])


def peaks(x, y):
    return (3 * (1 - x) ** 2 * np.exp(-x**2 - (y + 1) ** 2) - 10 * (x / 5 - x**3 - y**5) * np.exp(-x**2 - y**2)
            - np.exp(-(x + 1) ** 2 - y**2) / 3)


def grid_points(*shape):
    axes = np.meshgrid(*[np.linspace(-3, 3, m) for m in shape], indexing="ij")
    return np.stack([axes[0], axes[1], peaks(axes[0], axes[1]) + sum(axes[2:], np.zeros(shape))], axis=-1)


def noisy(q):
    """With noise, so that the residual is one: equal residuals then mean equal answers."""
    return q + 1e-3 * np.random.default_rng(3).standard_normal(q.shape)


def lsq_axes(q, t, k):
    """SciPy's tensor fit: make_lsq_spline along one axis after the other."""
    c = q
    for axis in range(len(t)):
        c = np.moveaxis(make_lsq_spline(t[axis], np.moveaxis(c, axis, 0), k[axis], 3).c, 0, axis)
    return c


def rms_axes(c, q, t, k):
    from scipy.interpolate import BSpline
    for axis in range(len(t)):
        c = np.moveaxis(BSpline(k[axis], np.moveaxis(c, axis, 0), 3)(t[axis]), 0, axis)
    return float(np.sqrt(((c - q) ** 2).sum() / q[..., 0].size))


def cases(quick):
    scale = 10 if quick else 1
    m = 10_000_000 // scale
    t = np.linspace(0, 1, m)
    yield "curve 10^7 x 3, 10^4", noisy(np.stack([np.cos(50 * t), np.sin(70 * t), t], axis=1)), [t], [uniform_knots(10_000 // scale)], (12, 25)
    for shape, n, bounds in (((2000, 2000), 200, (6, 12)), ((860, 600), 121, (4, 4))):
        yield f"grid {shape[0]} x {shape[1]} x 3, {n} x {n}", noisy(grid_points(*shape)), [np.linspace(0, 1, s) for s in shape], [uniform_knots(n)] * 2, bounds
    shape = (128, 128, 128)
    yield "volume 128^3 x 1, 40^3", noisy(grid_points(*shape)[..., 2:]), [np.linspace(0, 1, s) for s in shape], [uniform_knots(40)] * 3, (4, 8)


def clouds(quick):
    for m, n, bounds in ((100_000, 40, (60, 150)),) + (() if quick else ((1_000_000, 100, (300, 700)),)):
        rng = np.random.default_rng(7)
        uv = rng.uniform(0, 1, (m, 2))
        yield f"cloud {m} x 1, {n} x {n}", noisy(peaks(6 * uv[:, 0] - 3, 6 * uv[:, 1] - 3)[:, None]), uv, uniform_knots(n), bounds


class Server:
    def __init__(self, folder, axes, kind):
        self.process = subprocess.Popen([SERVER, folder, str(axes), kind], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, word):
        self.process.stdin.write(f"{word}\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().split(None, 2)

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def timed(work):
    start = time.perf_counter()
    result = work()
    return result, 1e3 * (time.perf_counter() - start)


def race(name, server, peer, peer_rms, rounds, bounds, rows, samples, peer_once=None, chord=0):
    answer, first_time = (None, peer_once[1]) if peer_once else timed(peer)
    if peer_once: answer = peer_once[0]
    theirs_rms = peer_rms(answer)
    _, ours_rms, how = server.ask(1)
    ours_rms = float(ours_rms)
    if abs(ours_rms / theirs_rms - 1) > 1e-9:
        raise SystemExit(f"{name}: residuals differ: ours {ours_rms}, SciPy {theirs_rms}")
    _, fit_rms, _ = server.ask("fit 1")
    if abs(float(fit_rms) / theirs_rms - 1) > 1e-9:
        raise SystemExit(f"{name}: residuals differ: fit() {fit_rms}, SciPy {theirs_rms}")
    times = {"read": [], "one": [], "two": [], "scipy": [], "fit": [], "fit_two": [], **({"chord": []} if chord else {})}
    for _ in range(rounds):
        times["fit"].append(float(server.ask("fit 1")[0]))
        times["fit_two"].append(float(server.ask("fit 2")[0]))
        if chord: times["chord"].append(float(server.ask(f"chord 1 {chord}")[0]))
        times["read"].append(float(server.ask("read")[0]))
        times["one"].append(float(server.ask(1)[0]))
        times["two"].append(float(server.ask(2)[0]))
        times["scipy"].append(first_time if peer_once else timed(peer)[1])
    median = {k: statistics.median(v) for k, v in times.items()}
    rows.append({"work": name, "samples": samples, "how": how.strip(), "rms": ours_rms, "scipy_rms": theirs_rms, **{f"{k}_ms": v for k, v in median.items()},
                 "ratio_one": median["scipy"] / median["one"], "ratio_two": median["scipy"] / median["two"],
                 "speedup_two": median["one"] / median["two"], "must": bounds[0], "aim": bounds[1]})
    r = rows[-1]
    print(f"{name:<32}{median['scipy']:>11.2f}{median['one']:>10.2f}{median['two']:>10.2f}{median['read']:>9.2f}"
          f"{r['ratio_one']:>9.1f}{r['ratio_two']:>8.1f}{bounds[0]:>6}{bounds[1]:>6}   {how.strip()}", flush=True)


def whole_calls(rows):
    """fit() from samples to report, deviation included, beside its own kernel and SciPy's solution alone."""
    print(f"\n{'fit(), the whole call':<32}{'1 thread':>10}{'2':>10}{'ns/sample':>11}{'x kernel':>10}{'x SciPy':>9}{'x read':>8}")
    for r in rows:
        for word in ("fit", "chord"):
            if f"{word}_ms" not in r: continue
            one = r[f"{word}_ms"]
            two = f"{r['fit_two_ms']:>10.2f}" if word == "fit" else " " * 10
            print(f"{r['work'] + (', chord' if word == 'chord' else ''):<32}{one:>10.2f}{two}{1e6 * one / r['samples']:>11.1f}"
                  f"{one / r['one_ms']:>10.2f}{r['scipy_ms'] / one:>9.1f}{one / r['read_ms']:>8.1f}")


def small_call():
    """205 samples to 20 control points, microseconds a call."""
    t = np.linspace(0, 1, 205)
    q = noisy(np.stack([np.cos(5 * t), np.sin(7 * t)], axis=1))
    with tempfile.TemporaryDirectory() as folder:
        for name, values in (("q", q), ("t0", t), ("k0", uniform_knots(20))): np.save(f"{folder}/{name}.npy", values)
        server = Server(folder, 1, "ordered")
        calls = statistics.median(1e3 * float(server.ask("chord 1 20 2000")[0]) for _ in range(5))
        server.close()
    peer = statistics.median(timed(lambda: make_lsq_spline(t, q, uniform_knots(20), 3))[1] for _ in range(200))
    print(f"{'205 samples, 20 control points':<32}{calls:>10.1f} microseconds a call, SciPy's solution alone {1e3 * peer:.1f}")
    return {"work": "205 samples, 20 control points", "fit_us": calls, "scipy_us": 1e3 * peer}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="smaller data, for a look")
    parser.add_argument("--json", type=pathlib.Path, default=ROOT / "out" / "race.json")
    options = parser.parse_args()
    rows = []
    print(f"{'milliseconds, medians':<32}{'SciPy':>11}{'1 thread':>10}{'2':>10}{'read':>9}{'x (1)':>9}{'x (2)':>8}{'must':>6}{'aim':>6}")
    for name, q, t, k, bounds in cases(options.quick):
        with tempfile.TemporaryDirectory() as folder:
            np.save(f"{folder}/q.npy", q)
            for axis in range(len(t)):
                np.save(f"{folder}/t{axis}.npy", t[axis])
                np.save(f"{folder}/k{axis}.npy", k[axis])
            server = Server(folder, len(t), "ordered")
            race(name, server, lambda: lsq_axes(q, t, k), lambda c: rms_axes(c, q, t, k), options.rounds, bounds, rows, q[..., 0].size,
                 chord=len(k[0]) - 4 if len(t) == 1 else 0)
            server.close()
    for name, q, uv, k, bounds in clouds(options.quick):
        with tempfile.TemporaryDirectory() as folder:
            np.save(f"{folder}/q.npy", q)
            np.save(f"{folder}/uv.npy", uv)
            np.save(f"{folder}/k0.npy", k)
            np.save(f"{folder}/k1.npy", k)
            server = Server(folder, 2, "scattered")
            def peer():
                return LSQBivariateSpline(uv[:, 0], uv[:, 1], q[:, 0], k[4:-4], k[4:-4], bbox=[0, 1, 0, 1], eps=1e-15)
            def rms(s):
                return float(np.sqrt(((s.ev(uv[:, 0], uv[:, 1]) - q[:, 0]) ** 2).mean()))
            once = timed(peer) if len(q) > 500_000 else None  # a minute: run once
            race(name, server, peer, rms, options.rounds, bounds, rows, len(q), once)
            server.close()
    whole_calls(rows)
    rows.append(small_call())
    machine = {"processor": next((l.split(":")[1].strip() for l in open("/proc/cpuinfo") if l.startswith("model name")), platform.processor()),
               "python": platform.python_version()}
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({"machine": machine, "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()
