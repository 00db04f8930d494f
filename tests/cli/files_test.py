"""Files as outputs and inputs: what is replaced, what is written into, what is refused, and that nothing is lost on the way."""
import gzip
import json
import os
import resource
import shutil
import socket
import stat
import subprocess
import threading
import unittest

import numpy as np

from judge import BATTEN, GUARD, InFolder, SANITIZED, lacks


class Files(InFolder):
    def setUp(self):
        super().setUp()
        t = np.linspace(0, 3, 60)
        np.savetxt(self.folder / "p.csv", np.c_[np.cos(t), np.sin(2 * t)], delimiter=",")
        self.good("fit", "p.csv", "-n", 8, "-q", "-o", "s.json")
        self.good("assemble", "p.csv", "-n", 8, "-q", "-o", "s.sys")

    def run_batten(self, *arguments, **how):
        how = {"capture_output": True, "stdin": subprocess.DEVNULL, **how}
        return subprocess.run([BATTEN, *map(str, arguments)], cwd=self.folder, timeout=GUARD, **how)

    def good(self, *arguments, **how):
        done = self.run_batten(*arguments, **how)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def bad(self, status, message, *arguments, **how):
        """One line on standard error, the status, and every file as it was."""
        before = self.state()
        done = self.run_batten(*arguments, **how)
        self.assertEqual(done.stderr.decode(), f"batten: {message}\n")
        self.assertEqual(done.returncode, status)
        self.assertEqual(self.state(), before)

    def state(self):
        """Everything in the folder: contents of files, targets of links, kinds of the rest."""
        def of(path):
            kind = path.lstat().st_mode
            return os.readlink(path) if stat.S_ISLNK(kind) else path.read_bytes() if stat.S_ISREG(kind) else stat.S_IFMT(kind)
        return {path.name: of(path) for path in self.folder.iterdir()}

    def read(self, name):
        return (self.folder / name).read_bytes()

    def write(self, name, content):
        (self.folder / name).write_text(content)
        return name


# one command line of every verb that writes; OUT is the output
WRITERS = {"fit -o": "fit p.csv -n 8 -q -o OUT.json", "fit --summary": "fit p.csv -n 8 -q --summary OUT.json",
           "fit --report": "fit p.csv -n 8 -q --report OUT.html", "evaluate": "evaluate s.json --samples 40 -o OUT.csv",
           "convert": "convert s.json -o OUT.obj", "plot": "plot s.json p.csv -o OUT.svg", "generate": "generate rose -o OUT.csv",
           "assemble": "assemble p.csv -n 8 -q -o OUT.sys", "merge": "merge s.sys s.sys -q -o OUT.sys", "solve": "solve s.sys -q -o OUT.json"}
# one command line of every verb that prints
PRINTERS = ["", "--help", "--version", "fit --help", "methods", "info p.csv", "info s.json", "compare s.json p.csv", "generate rose",
            "evaluate s.json --samples 9", "plot s.json", "fit p.csv -n 8", "fit p.csv -n 8 -q -o -", "fit p.csv -n 8 -q --summary -",
            "reproduce epia", "info s.sys", "solve s.sys -o -"]


class Places(Files):
    def each_writer(self, prefix):
        """Verb, command line with the output `prefix` + extension, and that name."""
        for verb, line in WRITERS.items():
            words = [word.replace("OUT", prefix) for word in line.split()]
            yield verb, words, next(word for word in words if word.startswith(prefix))

    def timeless(self, content):
        """A summary's or page's seconds differ from run to run."""
        try:
            summary = json.loads(content)
            summary.pop("seconds", None)
            return summary
        except ValueError:
            return content if not content.startswith(b"<!") else content[:200]

    def test_devices_are_written_into(self):
        if os.geteuid() != 0:
            # an ordinary user cannot make devices, but cannot replace those of the system either
            for verb, words, name in self.each_writer("dev"):
                with self.subTest(verb):
                    (self.folder / name).unlink(missing_ok=True)
                    (self.folder / name).symlink_to("/dev/full")
                    self.bad(3, f"{name}: cannot be written: No space left on device", *words)
            return
        for verb, words, name in self.each_writer("dev"):
            with self.subTest(verb):
                path = self.folder / name
                path.unlink(missing_ok=True)
                os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 3))  # null
                self.good(*words)
                self.assertTrue(stat.S_ISCHR(path.lstat().st_mode))
                path.unlink()
                os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 7))  # full
                self.bad(3, f"{name}: cannot be written: No space left on device", *words)

    def test_pipes_with_names_are_written_into(self):
        for (verb, words, name), (_, plain, expected) in zip(self.each_writer("fifo"), self.each_writer("file")):
            with self.subTest(verb):
                path = self.folder / name
                path.unlink(missing_ok=True)
                os.mkfifo(path)
                got = []
                reader = threading.Thread(target=lambda: got.append(path.read_bytes()))
                reader.start()
                self.good(*words)
                reader.join(GUARD)
                self.good(*plain)
                self.assertEqual(self.timeless(got[0]), self.timeless(self.read(expected)))
                self.assertTrue(stat.S_ISFIFO(path.lstat().st_mode))

    def test_sockets_are_written_into(self):
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(self.folder / "listen.csv"))
            listener.listen()
            got = []

            def take():
                with listener.accept()[0] as end:
                    while part := end.recv(1 << 16):
                        got.append(part)
            reader = threading.Thread(target=take)
            reader.start()
            self.good("generate", "rose", "-o", "listen.csv")
            reader.join(GUARD)
        self.good("generate", "rose", "-o", "plain.csv")
        self.assertEqual(b"".join(got), self.read("plain.csv"))
        self.assertTrue(stat.S_ISSOCK((self.folder / "listen.csv").lstat().st_mode))
        self.bad(3, "listen.csv: cannot be written: Connection refused", "generate", "rose", "-o", "listen.csv")

    def test_descriptors_are_written_into(self):
        spline = self.read("s.json")
        for name in ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "/proc/thread-self/fd/1"):
            with self.subTest(name):
                self.assertEqual(self.good("fit", "p.csv", "-n", 8, "-q", "-o", name), spline)
                with open(self.folder / "log", "w") as log:
                    log.write("before\n")
                    log.flush()
                    self.good("fit", "p.csv", "-n", 8, "-q", "-o", name, stdout=log, capture_output=False)
                self.assertEqual(self.read("log"), b"before\n" + spline)
        (self.folder / "out.json").symlink_to("/dev/stdout")
        self.assertEqual(self.good("convert", "s.json", "-o", "out.json"), spline)
        with open(self.folder / "five", "wb") as five:
            self.good("fit", "p.csv", "-n", 8, "-q", "-o", f"/dev/fd/{five.fileno()}", pass_fds=[five.fileno()])
        self.assertEqual(self.read("five"), spline)
        self.bad(3, "/dev/fd/77: cannot be written: Bad file descriptor", "fit", "p.csv", "-n", 8, "-o", "/dev/fd/77")
        # the report makes room
        self.assertEqual(self.good("fit", "p.csv", "-n", 8, "-o", "/dev/stdout"), spline)

    def test_links_stay_and_their_targets_are_replaced(self):
        (self.folder / "deep").mkdir()
        for verb, words, name in self.each_writer("link"):
            with self.subTest(verb):
                target = self.folder / "deep" / name
                target.unlink(missing_ok=True)
                (self.folder / name).unlink(missing_ok=True)
                (self.folder / ("second" + name)).unlink(missing_ok=True)
                (self.folder / name).symlink_to("second" + name)
                (self.folder / ("second" + name)).symlink_to("deep/" + name)
                self.good(*words)  # there is nothing yet
                first = target.read_bytes()
                target.write_text("old")
                self.good(*words)
                self.assertEqual(self.timeless(target.read_bytes()), self.timeless(first))
                self.assertEqual(os.readlink(self.folder / name), "second" + name)
                self.assertFalse(target.is_symlink())
        (self.folder / "round.json").symlink_to("round.json")
        self.bad(3, "round.json: cannot be written: Too many levels of symbolic links", "convert", "s.json", "-o", "round.json")

    def test_modes_and_owners_stay(self):
        for verb, words, name in self.each_writer("mode"):
            with self.subTest(verb):
                path = self.folder / name
                path.unlink(missing_ok=True)
                self.good(*words, preexec_fn=lambda: os.umask(0o027))
                self.assertEqual(stat.S_IMODE(path.stat().st_mode), 0o640)
                path.write_text("old")
                path.chmod(0o604)
                if os.geteuid() == 0:
                    os.chown(path, 12345, 54321)
                owner = path.stat().st_uid, path.stat().st_gid
                self.good(*words, preexec_fn=lambda: os.umask(0o077))
                self.assertEqual(stat.S_IMODE(path.stat().st_mode), 0o604)
                self.assertEqual((path.stat().st_uid, path.stat().st_gid), owner)
                self.assertNotEqual(path.read_bytes(), b"old")

    def test_places_that_cannot_be_written(self):
        (self.folder / "dir.json").mkdir()
        self.bad(3, "dir.json: cannot be written: Is a directory", "convert", "s.json", "-o", "dir.json")
        self.bad(3, "p.csv/x.json: cannot be written: Not a directory", "convert", "s.json", "-o", "p.csv/x.json")
        self.bad(3, "no/x.json: the folder no does not exist", "convert", "s.json", "-o", "no/x.json")
        self.bad(3, "no/x.csv: the folder no does not exist", "generate", "rose", "-o", "no/x.csv")
        self.bad(3, "p.csv/figure: cannot be written: Not a directory", "reproduce", "mlspia", "--folder", "p.csv")


class Sameness(Files):
    def test_an_output_is_no_input(self):
        """By whatever name, and for every flag that reads a file."""
        def file(name, rows):
            return self.write(name, "\n".join(map(str, rows)) + "\n")
        ones = file("ones.txt", [1] * 60)
        cases = {"--weights": ones, "--tolerances": ones, "--parameters": file("t.txt", np.linspace(0, 1, 60)),
                 "--knots": "s.json", "--initial": "s.json", "--before": "s.json", "--corners": file("c.txt", [30]), "--interpolate": file("i.txt", [0, 59]),
                 "--moving": file("m.txt", [3]), "--tangents": file("d.txt", ["0 1 0"]), "--derivatives": file("e.txt", ["0 1 0"])}
        for flag, name in cases.items():
            with self.subTest(flag):
                os.link(self.folder / name, self.folder / "hard.json")
                for output, spelled in (("--summary", name), ("--summary", f"./{name}"), ("--summary", self.folder / name), ("-o", "hard.json")):
                    self.bad(2, f"{spelled}: it is the file of {flag}", "fit", "p.csv", flag, name, output, spelled)
                (self.folder / "hard.json").unlink()
        self.bad(2, "s.json: it is the file of --boundary", "fit", "p.csv", "--boundary", "u0=s.json", "-o", "s.json")
        (self.folder / "link.json").symlink_to("p.csv")
        self.bad(2, "link.json: it is the file of the points", "fit", "p.csv", "-o", "link.json")
        self.bad(2, "link.json: it is the file of the points", "fit", "link.json", "-o", "link.json")
        with open(self.folder / "p.csv") as points:
            self.bad(2, "p.csv: it is the file of the points", "fit", "-", "--summary", "p.csv", stdin=points)
        self.bad(2, "s.json: it is the file of a spline", "convert", "s.json", "-o", "s.json")
        self.bad(2, "./s.json: it is the file of a spline", "convert", "s.json", "-o", "x.step", "-o", "./s.json")
        self.bad(2, "p.csv: it is the file of --parameters", "evaluate", "s.json", "--parameters", "p.csv", "-o", "p.csv")
        (self.folder / "s.csv").symlink_to("s.json")
        self.bad(2, "s.csv: it is the file of the spline", "evaluate", "s.json", "--samples", 9, "-o", "s.csv")
        (self.folder / "p.svg").symlink_to("p.csv")
        self.bad(2, "p.svg: it is the file of the points", "plot", "s.json", "p.csv", "-o", "p.svg")
        with open(self.folder / "s.json", "a") as spline:
            self.bad(2, "-: it is the file of the spline", "evaluate", "s.json", "--samples", 9, stdout=spline, stderr=subprocess.PIPE,
                     capture_output=False)

    def test_words_and_lists_are_no_files(self):
        for name in ("data", "ends", "8", "0,59"):
            self.write(name, "not read")
        self.good("fit", "p.csv", "-n", 8, "--knots", "data", "--interpolate", "ends", "--initial", "data", "-q", "--summary", "data")
        self.good("fit", "p.csv", "-n", 8, "--interpolate", "0,59", "-q", "--summary", "0,59")

    def test_an_output_is_written_once(self):
        (self.folder / "sub").mkdir()
        (self.folder / "link.json").symlink_to("new.json")
        self.write("old.json", "old")
        os.link(self.folder / "old.json", self.folder / "hard.json")
        for one, other in (("new.json", "new.json"), ("new.json", "./new.json"), ("new.json", "sub/../new.json"), ("new.json", "link.json"),
                           ("new.json", self.folder / "new.json"), ("old.json", "hard.json"), ("-", "-"), ("-", "/dev/stdout"),
                           ("/dev/fd/1", "-")):
            with self.subTest(one=one, other=other):
                self.bad(2, f"{other}: it would be written twice, as --output and as --summary",
                         "fit", "p.csv", "-n", 8, "-o", one, "--summary", other)
                self.bad(2, f"{other}: it would be written twice, as --output and as --output", "convert", "s.json", "-o", one, "-o", other)
        self.good("fit", "p.csv", "-n", 8, "-q", "--summary", "/dev/null", "--report", "/dev/null")  # holds nothing


class AllOrNothing(Files):
    LINE = ["fit", "p.csv", "-n", "8", "-q", "-o", "a.json", "--summary", "b.json", "--report", "c.html"]

    def test_a_failure_leaves_every_old_file(self):
        self.write("a.json", "old a")
        self.write("b.json", "old b")
        # the page is larger than this, the others are not
        limit = 1 << 16
        self.bad(3, "c.html: cannot be written: File too large", *self.LINE,
                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.good(*self.LINE)
        self.assertEqual(json.loads(self.read("a.json"))["format"], "batten-spline")
        for verb, line in WRITERS.items():
            name = next(word for word in line.split() if "OUT" in word)
            self.write(name, "old")
            with self.subTest(verb):
                self.bad(3, f"{name}: cannot be written: File too large", *line.split(),
                         preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (9, 9)))

    def test_a_stream_that_fails_leaves_every_old_file(self):
        self.write("a.json", "old a")
        with open("/dev/full", "w") as full:
            self.bad(3, "standard output: cannot be written: No space left on device", "fit", "p.csv", "-n", 8, "-q", "-o", "a.json",
                     "--summary", "-", stdout=full, stderr=subprocess.PIPE, capture_output=False)

    def test_a_name_that_cannot_be_given_takes_the_others_back(self):
        for name in ("a.json", "b.json", "c.html"):
            self.write(name, "old " + name)
        before = self.state()
        inside = ["unshare", "-m"] if os.geteuid() == 0 else ["unshare", "-rm"]
        if subprocess.run([*inside, "true"], capture_output=True).returncode != 0:
            lacks(self, "no mount namespace can be had")
        # what something is mounted on cannot be replaced
        script = 'mount --bind s.json c.html && exec "$@"'
        for line in (self.LINE, [*self.LINE[:6], "new.json", *self.LINE[7:]]):
            done = subprocess.run([*inside, "sh", "-c", script, "sh", BATTEN, *line], cwd=self.folder, capture_output=True, timeout=GUARD)
            self.assertEqual((done.returncode, done.stderr), (3, b"batten: c.html: cannot be replaced: Device or resource busy\n"))
            self.assertEqual(self.state(), before)


class StandardOutput(Files):
    def test_full(self):
        for line in PRINTERS:
            with self.subTest(line), open("/dev/full", "w") as full:
                done = self.run_batten(*self.words(line), stdout=full, stderr=subprocess.PIPE, capture_output=False)
                self.assertEqual((done.returncode, done.stderr), (3, b"batten: standard output: cannot be written: No space left on device\n"))

    def words(self, line):
        return [*line.split(), *(["--folder", "figures"] if "reproduce" in line else [])]

    def test_closed(self):
        for line in PRINTERS:
            with self.subTest(line):
                done = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", BATTEN, *self.words(line)], cwd=self.folder, capture_output=True, timeout=GUARD)
                self.assertEqual((done.returncode, done.stderr), (3, b"batten: standard output: cannot be written: Bad file descriptor\n"))

    def test_closed_streams_are_no_place_for_files(self):
        """The first file opened would take a closed stream's number, and what is printed would go into it."""
        script = 'exec "$@" <&- >&- 2>&-'
        done = subprocess.run(["sh", "-c", script, "sh", BATTEN, "fit", "p.csv", "-n", "8", "-o", "x.json"], cwd=self.folder, timeout=GUARD)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(self.read("x.json"), self.read("s.json"))
        self.assertEqual(self.read("p.csv").count(b"\n"), 60)

    def test_a_reader_that_leaves(self):
        for line in ("generate rose --samples 100000", "methods", "--help"):
            read, write = os.pipe()
            os.close(read)
            with self.subTest(line):
                done = self.run_batten(*line.split(), stdout=write, stderr=subprocess.PIPE, capture_output=False)
                self.assertEqual((done.returncode, done.stderr), (3, b"batten: standard output: cannot be written: Broken pipe\n"))
            os.close(write)


class Machine(Files):
    @unittest.skipIf(SANITIZED, "the sanitizer needs threads of its own")
    def test_no_threads(self):
        """An ordinary user whose processes are all used up gets the same surface."""
        self.folder.chmod(0o755)
        command = self.folder / "batten"
        shutil.copy(BATTEN, command)
        self.good("generate", "peaks", "--samples", "300x300", "-o", "g.npy")
        out = self.folder / "out"
        out.mkdir()
        out.chmod(0o777)

        def ordinary(most):
            if os.geteuid() == 0:
                os.setgroups([])
                os.setresgid(54321, 54321, 54321)
                os.setresuid(54321, 54321, 54321)
            resource.setrlimit(resource.RLIMIT_NPROC, (most, most))
        for most in (1, 2, 3):
            done = subprocess.run([command, "fit", "g.npy", "-n", "60x60", "-q", "-o", f"out/{most}.json"], cwd=self.folder,
                                  capture_output=True, timeout=GUARD, preexec_fn=lambda: ordinary(most))
            self.assertEqual((done.returncode, done.stderr), (0, b""), most)
        self.good("fit", "g.npy", "-n", "60x60", "-q", "-o", "all.json")
        for most in (1, 2, 3):
            self.assertEqual(self.read(f"out/{most}.json"), self.read("all.json"))

    @unittest.skipIf(SANITIZED, "the sanitizer needs the address space")
    def test_no_memory(self):
        """With any limit a command ends well, or with one line and every file as it was."""
        self.good("generate", "peaks", "--samples", "400x400", "-o", "g.npy")
        self.good("generate", "rose", "--samples", 100000, "-o", "big.csv")
        self.write("x.json", "old")
        self.write("y.csv", "old")
        before, refused = self.state(), 0
        for line in ("fit g.npy -n 150x150 -q -o x.json", "evaluate s.json --samples 500000 -o y.csv", "info big.csv"):
            for mebibytes in (*range(24, 130, 7), 200, 400):
                done = self.run_batten(*line.split(), preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (mebibytes << 20,) * 2))
                words = done.stderr.decode()
                if "error while loading shared libraries" in words:
                    continue  # not yet ours
                with self.subTest(line, mebibytes=mebibytes):
                    self.assertIn(done.returncode, (0, 2, 3), words)
                    if done.returncode == 0:
                        for name in ("x.json", "y.csv"):
                            self.write(name, "old")
                        continue
                    refused += 1
                    self.assertRegex(words, r"^batten: [^\n]*memory[^\n]*\n$")
                    self.assertEqual(self.state(), before)
        self.assertGreater(refused, 5)

    def test_counts_that_nothing_holds(self):
        self.good("generate", "peaks", "--samples", "20x20", "-o", "g.npy")
        self.good("fit", "g.npy", "-n", "8x8", "-q", "-o", "g.json")
        self.good("generate", "rose", "-o", "rose.csv")
        rng = np.random.default_rng(1)
        x = rng.random((60, 2))
        np.savetxt(self.folder / "cloud.xyz", np.c_[x, x[:, 0] * x[:, 1]])
        memory = r"batten: {}: [^ ]+ GB of memory would be needed, [^ ]+ [MG]B are left\n"
        for words, line in ((memory.format("99999999999 points"), "evaluate s.json --samples 99999999999 -o x.npy"),
                            (memory.format("9999999x9999999 points"), "evaluate g.json --samples 9999999x9999999"),
                            ("batten: 4294967296x4294967296 points: 4294967296x4294967296 is more than can be counted\n",
                             "evaluate g.json --samples 4294967296x4294967296"),
                            (memory.format("99999999x99999999 points"), "generate peaks --samples 99999999x99999999"),
                            ("batten: grid: 11x1676976733973595647 is more than can be counted\n",
                             "fit rose.csv -n 4x4 --grid 11x1676976733973595647"),
                            (memory.format("control points"), "fit cloud.xyz --project xy -n 1000000000x4"),
                            ("batten: control points: 4294967296x4294967296 is more than can be counted\n",
                             "fit cloud.xyz --project xy -p 1 -n 4294967296x4294967296")):
            with self.subTest(line):
                # so little memory that trying would show
                limit = None if SANITIZED else lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30,) * 2)
                done = self.run_batten(*line.split(), preexec_fn=limit)
                self.assertRegex(done.stderr.decode(), "^" + words.replace("(", r"\(") + "$")
                self.assertEqual(done.returncode, 2)


class Readers(Files):
    def points(self, name):
        """The points of a file as the command reads them."""
        self.good("fit", name, "-n", 4, "-q", "-o", "points.vtu")
        text = self.read("points.vtu").decode()
        return np.array(text.split("<Points>")[1].split(">")[1].split("<")[0].split(), float).reshape(-1, 3)

    def test_empty_first_fields(self):
        self.bad(3, "a.csv:1:1: '' is not a number", "info", self.write("a.csv", ",1\n0,1\n2,3\n"))
        self.bad(3, "a.csv:2:1: '' is not a number", "info", self.write("a.csv", "0,1\n,1\n2,3\n"))
        self.bad(3, "a.csv:1:1: '' is not a number", "info", self.write("a.csv", ",x,1\n0,1,2\n"))
        self.bad(3, "a.csv:1:1: '' is not a number", "info", self.write("a.csv", ",\n0,1\n"))
        self.bad(3, "a.csv:1:1: '' is not a number", "info", self.write("a.csv", ",,x\n0,1,2\n"))

    def test_tables_with_an_index(self):
        """As pandas writes them: df.to_csv(), with semicolons, tabs, and quoted names."""
        P = np.random.default_rng(3).random((9, 2))
        for head, between in ((",x,y", ","), (";x;y", ";"), ("\tx\ty", "\t"), ('"","x","y"', ",")):
            with self.subTest(head):
                self.write("i.csv", head + "\n" + "".join(f"{i}{between}{x!r}{between}{y!r}\n" for i, (x, y) in enumerate(P.tolist())))
                self.assertIn(b"9 points in dimension 2\n", self.good("info", "i.csv"))
                self.assertIn(b"the first column has no name and counts the rows: left out\n", self.good("info", "i.csv"))
                np.testing.assert_array_equal(self.points("i.csv")[:9, :2], P)
        self.write("i.csv", ",x,y\n" + "".join(f"{i + 5},{x!r},{y!r}\n" for i, (x, y) in enumerate(P.tolist())))
        self.assertIn(b"9 points in dimension 3\n", self.good("info", "i.csv"))
        self.assertIn(b"the first column has no name but does not count the rows: read as a coordinate\n", self.good("info", "i.csv"))

    def numbers(self, name):
        """Those of a file of one column, all in [0, 1], through a spline that gives back its parameter."""
        self.write("line.json", json.dumps({"format": "batten-spline", "version": 1, "degree": [1], "knots": [[0, 0, 1, 1]],
                                            "control_shape": [2], "control_points": [[0], [1]]}))
        self.good("evaluate", "line.json", "--parameters", name, "-o", "numbers.npy")
        return np.load(self.folder / "numbers.npy").ravel()

    def test_long_texts(self):
        """Of several megabytes, so that they are read in many parts, by all threads; NumPy reads them beside us."""
        rng = np.random.default_rng(8)
        written = [f(x) for f, x in zip(rng.choice(["%.18e".__mod__, repr, "%.3f".__mod__, "%g".__mod__], 300000), rng.random(300000).tolist())]
        for end, extra in (("\n", ""), ("\r\n", ""), ("\n", "# a comment, 7"), ("\r\n", " ")):
            with self.subTest(repr(end + extra)):
                lines = [line for k, word in enumerate(written) for line in ([word] if k % 7 or not extra else [word, extra])]
                (self.folder / "long.csv").write_bytes((end.join(["t", *lines]) + end).encode())
                expected = np.loadtxt(self.folder / "long.csv", skiprows=1)
                np.testing.assert_array_equal(self.numbers("long.csv"), expected)
                content = self.read("long.csv")
                (self.folder / "long.csv.gz").write_bytes(gzip.compress(content[:3000000], 1) + gzip.compress(content[3000000:], 1))
                np.testing.assert_array_equal(self.numbers("long.csv.gz"), expected)
                self.write("bad.csv", content.decode().replace("\r", "") + "0.5,0.25\n" + "x\n" * 300000)
                self.bad(3, f"bad.csv:{len(lines) + 2}: 2 numbers where the rows before have 1", "info", "bad.csv")
                self.write("bad.csv", content.decode().replace("\r", "") + "  0.5x\n" + "1,2\n" * 300000)
                self.bad(3, f"bad.csv:{len(lines) + 2}:3: '0.5x' is not a number", "info", "bad.csv")

    def test_one_long_line(self):
        rng = np.random.default_rng(9)
        H = rng.random((3, 400000))
        np.savetxt(self.folder / "wide.csv", H, fmt="%.9f", delimiter=";")
        self.assertGreater(self.read("wide.csv").index(b"\n"), 1 << 22)
        self.bad(2, "wide.csv: 3x400000 means points of dimension 400000, outside 1 to 16; heights reads it as a grid of heights", "info", "wide.csv")
        said = self.good("fit", "wide.csv", "--heights", "-n", "3x5", "-p", "1", "-q", "--summary", "-")
        self.assertEqual(json.loads(said)["samples"], H.size)

    def test_threads_read_the_same(self):
        t = np.linspace(0, 1, 60000)
        np.savetxt(self.folder / "h.csv", np.c_[np.cos(9 * t), np.sin(9 * t), t], delimiter=", ", header="x, y, z")
        for threads in (1, 2, 5):
            self.good("fit", "h.csv", "-n", 50, "-q", "--threads", threads, "-o", f"h{threads}.json")
        self.assertEqual(self.read("h1.json"), self.read("h2.json"))
        self.assertEqual(self.read("h1.json"), self.read("h5.json"))

    def test_compressed_text(self):
        for name in ("p.csv.gz", "p.txt.gz", "p.xyz.gz", "P.CSV.GZ"):
            (self.folder / name).write_bytes(gzip.compress(self.read("p.csv")))
            self.assertEqual(self.good("fit", name, "-n", 8, "-q", "-o", "-"), self.read("s.json"), name)
        self.write("no.csv.gz", "1,2\n3,4\n")
        self.bad(3, "no.csv.gz: not a sound .gz file: incorrect header check", "info", "no.csv.gz")
        (self.folder / "short.csv.gz").write_bytes(gzip.compress(self.read("p.csv"))[:-4])
        self.bad(3, "short.csv.gz: the compressed file ends too early", "info", "short.csv.gz")
        (self.folder / "none.csv.gz").write_bytes(gzip.compress(b""))
        self.bad(3, "none.csv.gz: the file is empty", "info", "none.csv.gz")
        self.bad(2, "p.npy.gz: unknown extension of compressed points '.npy'; known: .csv, .txt, .xyz, .dat", "info", "p.npy.gz")
        self.bad(2, "a.csv.gz: .gz files of points are read, not written", "generate", "rose", "-o", "a.csv.gz")

    def test_binary_files_come_through_pipes(self):
        P = np.random.default_rng(4).random((5000, 2))
        np.save(self.folder / "q.npy", P)
        os.mkfifo(self.folder / "pipe.npy")
        writer = threading.Thread(target=lambda: (self.folder / "pipe.npy").write_bytes(self.read("q.npy")))
        writer.start()
        piped = self.good("info", "pipe.npy")
        writer.join(GUARD)
        self.assertEqual(piped.replace(b"pipe", b"q"), self.good("info", "q.npy"))

    def test_types_of_npy(self):
        """Every type and order, judged by the same numbers as doubles in C order."""
        rng = np.random.default_rng(5)
        for dtype in ("<f8", ">f8", "<f4", ">f4", "i1", "u1", "<i2", ">u2", "<i4", ">i4", "<u4", "<i8", ">u8"):
            for order in "CF":
                A = (100 * rng.random((500, 3))).astype(dtype)
                np.save(self.folder / "a.npy", np.asarray(A, order=order))
                np.save(self.folder / "b.npy", A.astype("<f8"))
                self.assertEqual(self.good("info", "a.npy")[1:], self.good("info", "b.npy")[1:], (dtype, order))
        np.save(self.folder / "a.npy", np.asfortranarray(rng.random((40, 50, 3))))
        np.save(self.folder / "b.npy", np.ascontiguousarray(np.load(self.folder / "a.npy")))
        for name in "ab":
            self.good("fit", f"{name}.npy", "-n", "5x6", "-q", "-o", f"{name}.json")
        self.assertEqual(self.read("a.json"), self.read("b.json"))

    def test_memory(self):
        for word in ("12X", "M", "-1", "0", "1.5G", "5 M", "9999999999G", "1Mb"):
            self.bad(2, f"--memory {word}: bytes like 800M are needed, K, M or G after them", "fit", "p.csv", "-n", 8, "--memory", word, "-q")
        for word in ("1K", "1M", "100000", "3G"):
            self.assertEqual(self.good("fit", "p.csv", "-n", 8, "-q", "--memory", word, "-o", "-"), self.read("s.json"))
        self.bad(2, "--memory 959: the 60 samples of p.csv take 0.00096 MB", "fit", "p.csv", "-n", 8, "--memory", 959, "-o", "x.json")
        np.save(self.folder / "q.npy", np.random.default_rng(4).random((50000, 2)))
        self.bad(2, "--memory 700K: the 50000 samples of q.npy take 0.8 MB", "fit", "q.npy", "-n", 8, "--memory", "700K", "-o", "x.json")

    def test_elements_without_properties(self):
        vertices = "".join(f"{i} {i * i} 0\n" for i in range(9))
        for encoding in ("ascii", "binary_little_endian"):
            head = (f"ply\nformat {encoding} 1.0\nelement junk 1000000000000\nelement vertex 9\nproperty double x\nproperty double y\n"
                    "property double z\nend_header\n")
            body = vertices.encode() if encoding == "ascii" else np.loadtxt(vertices.splitlines()).astype("<f8").tobytes()
            (self.folder / "p.ply").write_bytes(head.encode() + body)
            self.assertIn(b"9 points in dimension 3\n", self.good("info", "p.ply"))

    def test_numbers_that_are_not_finite(self):
        for word in ("nan", "inf", "-inf"):
            table = self.write("t.txt", f"0.5\n{word}\n")
            self.bad(3, f"t.txt: row 1: {word} is not a finite number", "evaluate", "s.json", "--parameters", table)
            for flag in ("--weights", "--tolerances", "--parameters", "--knots", "--initial", "--before", "--interpolate", "--tangents"):
                self.bad(3, f"t.txt: row 1: {word} is not a finite number", "fit", "p.csv", *([] if flag in ("--tolerances", "--knots") else ["-n", 8]),
                         flag, table)
        spline = json.loads(self.read("s.json"))
        huge = dict(spline, control_points=[[1e307, -1e307], [-1e307, 1e307]] * 4)
        self.write("huge.json", json.dumps(huge))
        done = self.run_batten("evaluate", "huge.json", "--samples", 9, "--derivative", 1, "-o", "x.csv")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr.decode(), r"^batten: sample \d: its coordinates \(.*\) must be finite numbers\n$")

    def test_splines_that_are_not(self):
        spline = json.loads(self.read("s.json"))
        for words, change in ((r"degree: 3\.7 is not a whole number in range", dict(degree=[3.7])),
                              (r"degree: 2147483648 is not a whole number in range", dict(degree=[2**31])),
                              (r"control_shape: 18446744073709551615 is not a whole number in range", dict(control_shape=[2**64 - 1])),
                              (r"version \"1\" is not 1", dict(version="1")), (r"version 2 is not 1", dict(version=2)),
                              (r"unknown key 'closd'; did you mean 'closed'\?", dict(closd=[True])),
                              (r"axis 0: between knots 0 and \S+ nothing can be computed",
                               dict(knots=[[x * 1e-320 for x in spline["knots"][0]]])),
                              (r"control_points: 1e\+308 is so large that nothing can be computed",
                               dict(control_points=[[1e308, -1e308], [-1e308, 1e308]] * 4)),
                              (r"parse error .*", dict(control_points=[[float("nan"), 1]] * 8))):
            self.write("bad.json", json.dumps(dict(spline, **change)))
            for line in ("info bad.json", "evaluate bad.json --samples 4", "fit p.csv --knots bad.json"):
                done = self.run_batten(*line.split())
                self.assertRegex(done.stderr.decode(), r"^batten: bad\.json: " + words + r"\n$")
                self.assertEqual(done.returncode, 3)

    def test_sizes_far_from_one(self):
        """Extents and combs come out in range; the squares and cubes on the way do not."""
        P = np.loadtxt(self.folder / "p.csv", delimiter=",")
        spline = json.loads(self.read("s.json"))
        for scale in (1e150, 1e250, 1e-150, 1e-250):
            np.savetxt(self.folder / "q.csv", P * scale, delimiter=",")
            self.write("q.json", json.dumps(dict(spline, control_points=(np.array(spline["control_points"]) * scale).tolist())))
            diagonal = float(self.good("info", "q.csv").split(b"diagonal ")[1].split()[0])
            self.assertAlmostEqual(diagonal / scale / np.linalg.norm(np.ptp(P, axis=0)), 1, 5)
            self.assertNotRegex(self.good("plot", "q.json", "--comb").decode(), r"\b(nan|inf)\b")

    def test_streams_need_no_extension(self):
        content = self.read("p.csv")
        self.assertEqual(self.good("fit", "/dev/stdin", "-n", 8, "-q", "-o", "-", input=content, stdin=None), self.read("s.json"))
        done = subprocess.run(["bash", "-c", f"{BATTEN} fit <(cat p.csv) -n 8 -q -o >(cat > sub.json)"], cwd=self.folder, timeout=GUARD,
                              capture_output=True)
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_names_that_are_no_line(self):
        done = self.run_batten("info", "a\nb\x1b.csv")
        self.assertEqual((done.returncode, done.stderr), (3, b"batten: a?b?.csv: cannot be read: No such file or directory\n"))
        done = self.run_batten("info", "x" * 5000 + ".csv")
        self.assertEqual((done.returncode, done.stderr.count(b"\n"), len(done.stderr) < 700), (3, 1, True))


if __name__ == "__main__":
    unittest.main()
