"""What every option and every method costs beside the plain fit of the same data and size, at three sizes each: seconds of user time,
exponent in the number of samples, ratio to the plain fit. Goal: no exponent above 1.2, no ratio above 20 without a sentence in
docs/performance.md that says why."""
import argparse
import itertools
import json
import math
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXPONENT, RATIO = 1.2, 20
TOLD = 0.03  # seconds from which on a time is told by ticks of the clock that counts user time

# What `batten fit --help` has and no row, and why.
NOT_A_ROW = {
    "help": "ends at once", "unit": "a word in a file", "date": "a word in a file", "max-control-points": "a limit", "set": "a number of a method",
    "tolerance": "a search for the size: docs/tolerance.md", "tolerances": "a search for the size: docs/tolerance.md", "corners": "with --tolerance",
    "chord-tolerance": "how dense a sampled file is", "control-points": "the plain fit", "max-iterations": "a stop", "stop-gradient": "a stop",
    "stop-relative-gradient": "a stop", "stop-deviation": "a stop", "smooth-order": "with --smooth", "threads": "a number of cores", "quiet": "says nothing",
    "output": "rows of its own, one a format", "method": "rows of its own, one a method", "grid": "the shape of a file", "spacing": "with --heights",
    "initial": "with an iteration", "before": "with an iteration", "moving": "with PIA",
}


class Data:
    """Sequences, grids and clouds of a size, and the files that options take, made when asked for."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def file(self, name, make):
        path = self.folder / name
        if not path.exists():
            made = make()
            if path.suffix == ".npy":
                np.save(path, made)
            else:
                path.write_text(made)
        return path

    def numbers(self, name, make):
        return self.file(name, lambda: "\n".join(" ".join(map(repr, np.atleast_1d(row).tolist())) for row in make()) + "\n")

    def curve(self, m):
        def make():
            t = np.linspace(0, 1, m)
            q = np.stack([np.cos(6 * t) + t, np.sin(9 * t)], axis=1)
            return q + 1e-3 * np.random.default_rng(1).standard_normal(q.shape)
        return self.file(f"curve{m}.npy", make)

    def smooth_curve(self, m):
        """Without noise: chords that follow the curve."""
        def make():
            t = np.linspace(0, 1, m)
            return np.stack([np.cos(6 * t) + t, np.sin(9 * t)], axis=1)
        return self.file(f"smooth{m}.npy", make)

    def arc(self, m):
        """Half a circle, with so little noise that the polygon through some of its samples is convex."""
        def make():
            t = np.linspace(0, np.pi, m)
            return np.stack([np.cos(t), np.sin(t)], axis=1) + 1e-9 * np.random.default_rng(1).standard_normal((m, 2))
        return self.file(f"arc{m}.npy", make)

    def rising(self, m):
        def make():
            t = np.linspace(0, 1, m)
            return np.stack([t, t**3 + 1e-3 * np.random.default_rng(1).standard_normal(m)], axis=1)
        return self.file(f"rising{m}.npy", make)

    @staticmethod
    def height(u, v):
        return np.sin(5 * u) * np.cos(4 * v) + 0.3 * np.sin(11 * u * v)

    def grid(self, m):
        k = round(math.sqrt(m))
        def make():
            u, v = np.meshgrid(np.linspace(0, 1, k), np.linspace(0, 1, k), indexing="ij")
            return np.stack([u, v, self.height(u, v) + 1e-3 * np.random.default_rng(1).standard_normal((k, k))], axis=-1)
        return self.file(f"grid{k}.npy", make)

    def heights(self, m):
        k = round(math.sqrt(m))
        return self.file(f"heights{k}.npy", lambda: np.load(self.grid(m))[..., 2])

    def scattered(self, m):
        return np.random.default_rng(2).random((m, 2))

    def cloud(self, m):
        def make():
            u = self.scattered(m)
            return np.column_stack([u, self.height(*u.T) + 1e-3 * np.random.default_rng(3).standard_normal(m)])
        return self.file(f"cloud{m}.npy", make)

    def places(self, m):
        return self.file(f"places{m}.npy", lambda: self.scattered(m))

    def weights(self, m):
        return self.file(f"weights{m}.npy", lambda: np.random.default_rng(4).uniform(0.5, 2, m))

    def even(self, m):
        return self.file(f"even{m}.npy", lambda: np.linspace(0, 1, m))

    def exact(self, m, k, kind="s"):
        """Samples spread evenly; of a grid every so many along both axes."""
        def make():
            if kind != "g":
                return np.linspace(0, m - 1, k).astype(int)[:, None]
            side = round(math.sqrt(m))
            at = np.linspace(0, side - 1, round(math.sqrt(k))).astype(int)
            return (side * at[:, None] + at[None, :]).reshape(-1, 1)
        return self.numbers(f"exact_{kind}{m}_{k}.txt", make)


def shape(kind, m, per=10):
    """Control points: a tenth of the samples."""
    n = m // per
    if kind == "s":
        return str(n)
    side = round(math.sqrt(n))
    return f"{side}x{side}"


def base(data, kind, m, per=10):
    if kind == "s":
        return [data.curve(m), "-n", shape(kind, m, per)]
    if kind == "g":
        return [data.grid(m), "-n", shape(kind, m, per)]
    return [data.cloud(m), "--parameters", data.places(m), "-n", shape(kind, m, per)]


SIZES = {"s": (30_000, 100_000, 300_000), "g": (10_000, 40_000, 160_000), "c": (10_000, 40_000, 160_000)}
KINDS = {"s": "curve", "g": "grid", "c": "cloud"}
STEPS = ["--max-iterations", "30", "--stop-relative-gradient", "1e-6"]


class Row:
    """One option: `work` and the `plain` fit beside it as functions of the number of samples."""

    def __init__(self, name, kind, work, plain=None, sizes=None):
        self.name = f"{name}, {KINDS[kind]}"
        self.work = lambda data, m: ["fit", *base(data, kind, m), *work(data, m)] if plain is None else work(data, m)
        self.plain = plain or (lambda data, m: ["fit", *base(data, kind, m)])
        self.sizes = sizes or SIZES[kind]


def options_rows():
    def fit(kind, *more, per=10):
        return lambda data, m: ["fit", *base(data, kind, m, per), *more]

    for kind in "sgc":
        yield Row("--smooth auto", kind, lambda data, m: ["--smooth", "auto"])
        yield Row("--smooth 1e-9", kind, lambda data, m: ["--smooth", "1e-9"])
        yield Row("--weights", kind, lambda data, m: ["--weights", data.weights(m)])
        yield Row("--robust", kind, lambda data, m: ["--robust"])
        yield Row("--history", kind, lambda data, m: ["--history", "--summary", data.folder / "summary.json", "-m", "lspia", *STEPS])
        yield Row("--degree 5", kind, lambda data, m: ["-p", "5"])
        # every hundredth sample: the number of exact samples grows with the data
        yield Row("--interpolate m/100", kind, lambda data, m, kind=kind: ["--interpolate", data.exact(m, m // 100, kind)])
        yield Row("--report", kind, lambda data, m: ["--report", data.folder / "page.html"])
        yield Row("--summary", kind, lambda data, m: ["--summary", data.folder / "summary.json"])
    yield Row("--closed", "s", lambda data, m: ["--closed"])
    yield Row("--parametrize centripetal", "s", lambda data, m: ["--parametrize", "centripetal"])
    yield Row("--parameters", "s", lambda data, m: ["--parameters", data.even(m)])
    yield Row("--knots uniform", "s", lambda data, m: ["--knots", "uniform"])
    yield Row("--knots uniform", "g", lambda data, m: ["--knots", "uniform"])
    yield Row("--interpolate ends", "s", lambda data, m: ["--interpolate", "ends"])
    yield Row("--preserve inflections", "s", lambda data, m: ["--preserve", "inflections"])
    yield Row("--preserve convexity", "s", lambda data, m: ["fit", data.arc(m), "-n", shape("s", m, 100), "--preserve", "convexity"],
              plain=lambda data, m: ["fit", data.arc(m), "-n", shape("s", m, 100)])
    for word, width in (("tangents", 1), ("derivatives", 3)):
        def held(data, m, word=word, width=width):
            def rows():
                for i in np.linspace(0, m - 1, m // 100).astype(int):
                    t = i / (m - 1)
                    d = np.array([1 - 6 * math.sin(6 * t), 9 * math.cos(9 * t)])
                    yield np.array([i, *d]) if width else d
            path = data.folder / f"{word}{m}.csv"
            if not path.exists():
                path.write_text("\n".join(f"{int(r[0])},{float(r[1])!r},{float(r[2])!r}" for r in rows()) + "\n")
            return ["fit", data.smooth_curve(m), "-n", shape("s", m), f"--{word}", path]
        yield Row(f"--{word} m/100", "s", held, plain=lambda data, m: ["fit", data.smooth_curve(m), "-n", shape("s", m)])
    yield Row("--boundary", "g", boundary)
    yield Row("--project xy", "c", lambda data, m: ["fit", data.cloud(m), "--project", "xy", "-n", shape("c", m)], plain=fit("c"))
    # heights: nearly as many control points as samples along each axis
    yield Row("--heights, n = 0.9 per axis", "g",
              lambda data, m: ["fit", data.heights(m), "--heights", "-n", "x".join([str(round(0.9 * math.sqrt(m)))] * 2)],
              plain=lambda data, m: ["fit", data.grid(m), "-n", "x".join([str(round(0.8 * math.sqrt(m)))] * 2)], sizes=(40_000, 250_000, 1_000_000))
    for name in ("json", "step", "iges", "svg", "obj", "g2", "stl", "vtu", "vts", "csv"):
        for kind in "sg" if name != "stl" else "g":
            yield Row(f"-o .{name}", kind, lambda data, m, name=name: ["-o", data.folder / f"out.{name}"])
    for command in ("compare", "plot"):
        for kind in "sg":
            for few in (False, True):
                def work(data, m, command=command, kind=kind, few=few):
                    spline = data.folder / f"spline_{kind}{m}{'few' if few else ''}.json"
                    if not spline.exists():
                        size = ["-n", "1000" if kind == "s" else "30x30"] if few else []
                        run(["fit", *base(data, kind, m), *size, "-q", "-o", spline] if not few else
                            ["fit", base(data, kind, m)[0], *size, "-q", "-o", spline])
                    return [command, spline, base(data, kind, m)[0]] + (["-o", os.devnull] if command == "plot" else [])
                yield Row(f"{command}{', n fixed' if few else ''}", kind, work, plain=fit(kind))
    yield Row("fair", "s", lambda data, m: ["fair", spline_of(data, "s", m), "-o", data.folder / "fair.json"], plain=fit("s"))
    yield Row("fair", "g", lambda data, m: ["fair", spline_of(data, "g", m), "-o", data.folder / "fair.json"], plain=fit("g"))


def spline_of(data, kind, m):
    path = data.folder / f"spline_{kind}{m}.json"
    if not path.exists():
        run(["fit", *base(data, kind, m), "-q", "-o", path])
    return path


def boundary(data, m):
    """The first row of the grid as a spline of its own."""
    k = round(math.sqrt(m))
    path = data.folder / f"edge{k}.json"
    if not path.exists():
        edge = data.file(f"edge{k}.npy", lambda: np.load(data.grid(m))[0])
        run(["fit", edge, "-n", str(round(math.sqrt(m // 10))), "-q", "-o", path])
    return ["--boundary", f"u0={path}"]


def method_rows(names):
    for name in names:
        if name in ("auto", "search"):
            continue
        for kind in "sgc":
            def work(data, m, name=name, kind=kind):
                if name == "pia":
                    if kind == "s":
                        return ["fit", data.smooth_curve(m), "-m", "pia", "--max-iterations", "30"]
                    return ["fit", data.grid(m), "-m", "pia", "--max-iterations", "30"]
                if name == "epia" and kind != "c":
                    return ["fit", base(data, kind, m)[0], "-m", "epia", "-t", "0.02"]
                if name == "monotone-lspia":
                    return ["fit", data.rising(m), "-n", shape(kind, m), "-m", name, *STEPS]
                if name == "clspia":
                    return ["fit", *base(data, kind, m), "-m", name, "--interpolate", data.exact(m, 16, kind), *STEPS]
                steps = [] if name in ("direct", "cg", "epia") else STEPS
                return ["fit", *base(data, kind, m), "-m", name, *steps]
            if (name == "pia" and kind == "c") or (name == "monotone-lspia" and kind != "s"):
                continue
            yield Row(f"-m {name}", kind, work, plain=lambda data, m, kind=kind: ["fit", *base(data, kind, m)])


BATTEN = os.environ.get("BATTEN", str(ROOT / "build" / "release" / "batten"))


def run(words, guard=600):
    """User seconds, mebibytes and exit status of one run of the command; none where it takes longer than the guard."""
    process = subprocess.Popen([BATTEN, *map(str, words)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (guard, guard + 5)))
    error = process.stderr.read().decode()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = 0
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL):
        return None
    code = os.waitstatus_to_exitcode(status)
    if code not in (0, 4):
        raise RuntimeError(f"{' '.join(map(str, words))}: exit status {code}: {error.strip().splitlines()[-1:]}")
    return usage.ru_utime, usage.ru_maxrss / 1024


def least(words, guard):
    """The least of a few short runs."""
    best = run(words, guard)
    for _ in range(2):
        if best is None or best[0] > 0.3:
            break
        best = min(best, run(words, guard))
    return best


def measure(row, data, guard, start):
    """One row's figures; what is stopped at a size is not tried at larger ones."""
    times, memory, plain = [], [], []
    for m in row.sizes:
        work, beside = row.work(data, m), row.plain(data, m)
        got = least(work, guard)
        if got is None:
            break
        times.append(got[0])
        memory.append(got[1])
        plain.append(least(beside, 600)[0])
    told = [(m, t - start) for m, t in zip(row.sizes, times) if t - start >= TOLD]
    exponent = math.log(told[-1][1] / told[0][1]) / math.log(told[-1][0] / told[0][0]) if len(told) > 1 else math.nan
    ratio = times[-1] / max(plain[-1], 0.01) if times else math.nan
    return {"name": row.name, "sizes": row.sizes, "seconds": times, "stopped": len(times) < len(row.sizes), "plain": plain, "exponent": exponent,
            "ratio": ratio, "mebibytes": max(memory, default=math.nan)}


def missing_options():
    """Options of `batten fit` that have neither a row nor a reason."""
    words = subprocess.run([BATTEN, "fit", "--help"], capture_output=True, text=True, check=True).stdout
    known = " ".join(row.name for row in options_rows())
    return [o for o in re.findall(r"^  (?:-\w,)?--([a-z-]+)", words, re.M) if o not in NOT_A_ROW and not re.search(rf"--{o}\b", known)]


def method_names():
    words = subprocess.run([BATTEN, "methods"], capture_output=True, text=True, check=True).stdout
    return [line.split()[0] for line in words.splitlines() if line and not line[0].isspace() and not line.startswith("every ")]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rows", nargs="*", help="only rows whose name has one of these in it")
    parser.add_argument("--guard", type=int, default=20, help="seconds of processor time after which a run is stopped")
    parser.add_argument("--folder", help="where the data are kept")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    if missing := missing_options():
        sys.exit(f"no row for --{', --'.join(missing)}: add one to {pathlib.Path(__file__).name}")
    rows = [r for r in itertools.chain(options_rows(), method_rows(method_names()))
            if not options.rows or any(part in r.name for part in options.rows)]
    if options.list:
        print("\n".join(r.name for r in rows))
        return
    done, bad = [], 0
    with tempfile.TemporaryDirectory() as folder:
        data = Data(options.folder or folder)
        start = least(["methods"], 60)[0]
        print("| option | samples | user seconds | plain | exponent | ratio | MiB | |\n|---|---|---|---|---|---|---|---|")
        for row in rows:
            try:
                r = measure(row, data, options.guard, start)
            except RuntimeError as error:
                print(f"| {row.name} | refused: {error} |", flush=True)
                bad += 1
                continue
            done.append(r)
            much = r["stopped"] or r["exponent"] > EXPONENT or r["ratio"] > RATIO
            seconds = ", ".join(f"{t:.2f}" for t in r["seconds"]) + (f", > {options.guard}" if r["stopped"] else "")
            print(f"| {r['name']} | {', '.join(f'{m:.0e}'.replace('e+0', 'e') for m in r['sizes'])} | {seconds} | {', '.join(f'{t:.2f}' for t in r['plain'])} "
                  f"| {r['exponent']:.2f} | {r['ratio']:.1f} | {r['mebibytes']:.0f} | {'*' if much else ''} |", flush=True)
            bad += much
    if options.json:
        options.json.write_text(json.dumps(done, indent=1))
    print(f"\n{len(done)} rows, {bad} beyond exponent {EXPONENT} or ratio {RATIO}")


if __name__ == "__main__":
    main()
