"""Ctrl-C, SIGTERM and SIGHUP: every verb ends at once with nothing half-written. A signal is sent when the program is seen to be at
what it is to be interrupted in: reading an open pipe, writing to one, computing."""
import os
import pathlib
import resource
import signal
import subprocess
import time
import unittest

import numpy as np

from judge import BATTEN, GUARD, InFolder, lacks

SOON = 1.0   # seconds that an end may take, of the processor's time and of waiting for a busy machine left out
ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
NOTHING = b"batten: interrupted; nothing was written\n"


def until(condition, what):
    """Waits for something to be seen; the guard is against hangs only."""
    end = time.monotonic() + GUARD
    while not condition():
        if time.monotonic() > end:
            raise AssertionError("never seen: " + what)
        time.sleep(0.002)


class Signals(InFolder):
    def setUp(self):
        super().setUp()
        t = np.linspace(0, 3, 60)
        np.savetxt(self.folder / "p.csv", np.c_[np.cos(t), np.sin(2 * t)], delimiter=",")
        subprocess.run([BATTEN, "fit", "p.csv", "-n", "8", "-q", "-o", "s.json"], cwd=self.folder, check=True)
        (self.folder / "old.json").write_text("old")

    def start(self, *arguments, **how):
        how = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, **how}
        return subprocess.Popen([BATTEN, *map(str, arguments)], cwd=self.folder, **how)

    def state(self):
        return {path.name: path.read_bytes() if path.is_file() else None for path in self.folder.iterdir()}

    def proc(self, run, name):
        return (pathlib.Path("/proc") / str(run.pid) / name).read_text()

    def sleeps_in(self, run, call):
        """Whether the main thread waits in a system call of this number (see syscall(2), x86-64 and arm64)."""
        try:
            return self.proc(run, "syscall").split()[0] in call
        except (OSError, IndexError):
            return False

    def computed(self, run):
        """Seconds of the processor's time that it has used."""
        fields = self.proc(run, "stat").rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def catches(self, run, number):
        """Whether its own handler is in place: a sanitized program computes for long before it has one."""
        caught = next(line for line in self.proc(run, "status").splitlines() if line.startswith("SigCgt:"))
        return bool(int(caught.split()[1], 16) >> (number - 1) & 1)

    def ends(self, run, words=NOTHING):
        _, said = run.communicate(timeout=GUARD)
        self.assertEqual((run.returncode, said), (130, words))

    READ, WRITE, OPEN = ("0", "63"), ("1", "64"), ("257", "56")

    def test_readers_that_wait(self):
        """For a pipe that nobody writes to: opened by its reader alone, and opened by both."""
        os.mkfifo(self.folder / "wait.csv")
        os.mkfifo(self.folder / "wait.json")
        lines = {"fit": "fit wait.csv -n 8 -o old.json", "fit --weights": "fit p.csv -n 8 --weights wait.csv -o old.json",
                 "evaluate": "evaluate wait.json --samples 9 -o old.csv", "evaluate --parameters": "evaluate s.json --parameters wait.csv",
                 "compare": "compare s.json wait.csv", "info": "info wait.csv", "convert": "convert wait.json -o old.json",
                 "plot": "plot s.json wait.csv -o x.svg"}
        for verb, line in lines.items():
            name = "wait.json" if "wait.json" in line else "wait.csv"
            for number in ENDINGS:
                with self.subTest(verb, number=number):
                    before = self.state_without_pipes()
                    run = self.start(*line.split())
                    until(lambda: self.sleeps_in(run, self.OPEN), "opening")
                    run.send_signal(number)
                    self.ends(run)
                    self.assertEqual(self.state_without_pipes(), before)
            with self.subTest(verb, number="while reading"):
                run = self.start(*line.split())
                with open(self.folder / name, "w") as writer:  # returns when it has been opened at the other end
                    writer.write("1,2\n")
                    writer.flush()
                    until(lambda: self.sleeps_in(run, self.READ), "reading")
                    run.send_signal(signal.SIGINT)
                    self.ends(run)

    def state_without_pipes(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir() if path.is_file()}

    def test_standard_input_that_waits(self):
        run = self.start("fit", "-", "-n", 8, "-o", "old.json", stdin=subprocess.PIPE)
        until(lambda: self.sleeps_in(run, self.READ), "reading")
        run.send_signal(signal.SIGINT)
        self.ends(run)

    def test_writers_that_wait(self):
        """For a pipe that nobody reads; what was made beside it does not stay."""
        subprocess.run([BATTEN, "generate", "rose", "--samples", "20001", "-o", "many.csv"], cwd=self.folder, check=True)
        for line in ("generate rose --samples 100000", "evaluate s.json --samples 100000", "plot s.json many.csv",
                     "fit p.csv -n 8 -q -o old.json --report -"):
            with self.subTest(line):
                before = self.state()
                run = self.start(*line.split(), stdout=subprocess.PIPE)
                until(lambda: self.sleeps_in(run, self.WRITE), "writing")
                run.send_signal(signal.SIGTERM)
                self.assertEqual(run.wait(GUARD), 130)
                self.assertEqual(run.stderr.read(), NOTHING)
                run.stdout.close()
                run.stderr.close()
                self.assertEqual(self.state(), before)

    def test_work_of_every_kind(self):
        subprocess.run([BATTEN, "generate", "rose", "--samples", "200000", "-o", "big.csv"], cwd=self.folder, check=True)
        subprocess.run([BATTEN, "generate", "peaks", "--samples", "500x500", "-o", "grid.npy"], cwd=self.folder, check=True)
        subprocess.run([BATTEN, "fit", "grid.npy", "-n", "60x60", "-q", "-o", "net.json"], cwd=self.folder, check=True)
        rng = np.random.default_rng(1)
        np.save(self.folder / "cloud.npy", rng.random((200000, 3)))
        t = np.linspace(0, 3, 20000)
        np.savetxt(self.folder / "noisy.csv", np.c_[t, np.sin(t)] + 1e-3 * rng.standard_normal((20000, 2)), delimiter=",")
        for line in ("fit big.csv -n 90000 -m lspia --stop-gradient 1e-300 --max-iterations 100000000 -o old.json",
                     "fit big.csv -t 1e-10 -o old.json", "fit grid.npy -t 1e-9 -o old.json -o new.step",
                     "fit grid.npy -n 200x200 -m epia --stop-deviation 1e-300 --max-iterations 100000000 -o old.json",
                     "evaluate s.json --samples 20000000 -o new.csv", "generate rose --samples 20000000 -o new.csv",
                     "compare s.json big.csv", "compare net.json grid.npy", "fit grid.npy -n 400x400 --smooth auto -o old.json",
                     "fit cloud.npy --project xy -n 150x150 --smooth auto -o old.json", "fit noisy.csv -m epia -t 1e-9 -o old.json", "reproduce all"):
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(line, number=number):
                    before = self.state()
                    run = self.start(*line.split())
                    until(lambda: self.catches(run, number), "its handler")
                    begun = self.computed(run)
                    until(lambda: self.computed(run) >= begun + 0.15, "computing")
                    sent = os.times()
                    run.send_signal(number)
                    self.ends(run)
                    used = os.times()
                    spent = used.children_user + used.children_system - sent.children_user - sent.children_system
                    self.assertLess(used.elapsed - sent.elapsed, 10 * SOON + spent)
                    self.assertEqual(self.state(), before)

    def test_staged_files_do_not_stay(self):
        """What is made already waits for an output that cannot be opened yet."""
        subprocess.run([BATTEN, "generate", "peaks", "--samples", "300x300", "-o", "grid.npy"], cwd=self.folder, check=True)
        os.mkfifo(self.folder / "pipe.html")
        before = self.state()
        run = self.start("fit", "grid.npy", "-n", "40x40", "-q", "-o", "old.json", "--summary", "new.json", "--report", "pipe.html")
        until(lambda: self.sleeps_in(run, self.OPEN), "opening the pipe")  # for nobody reads it
        self.assertIn(len(list(self.folder.glob(".batten-*.part"))), (0, 2))  # 0: where files may wait without a name
        run.send_signal(signal.SIGINT)
        self.ends(run)
        self.assertEqual(self.state(), before)

    def test_nothing_stays_of_a_command_that_is_killed(self):
        """No handler removes anything: what is made has no name yet."""
        try:
            os.close(os.open(self.folder, os.O_TMPFILE | os.O_WRONLY))
        except OSError as error:
            lacks(self, f"files without a name: {error}")
        os.mkfifo(self.folder / "pipe.html")
        before = self.state()
        run = self.start("fit", "p.csv", "-n", 8, "-q", "-o", "old.json", "--summary", "new.json", "--report", "pipe.html")
        until(lambda: self.sleeps_in(run, self.OPEN), "opening the pipe")
        run.kill()
        self.assertEqual(run.wait(GUARD), -signal.SIGKILL)
        run.stderr.close()
        self.assertEqual(self.state(), before)

    def test_a_second_one_ends_what_the_first_cannot(self):
        """The line on standard error cannot be written: nobody reads the pipe, and it is full."""
        read, write = os.pipe()
        os.set_blocking(write, False)
        try:
            while True:
                os.write(write, b"x" * 4096)
        except BlockingIOError:
            os.set_blocking(write, True)
        run = self.start("fit", "-", "-n", 8, stdin=subprocess.PIPE, stderr=write)
        until(lambda: self.sleeps_in(run, self.READ), "reading")
        run.send_signal(signal.SIGINT)
        until(lambda: self.sleeps_in(run, self.WRITE), "writing its line")
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(GUARD), 130)
        run.stdin.close()
        os.close(read)
        os.close(write)

    def test_what_was_ignored_stays_ignored(self):
        for number in ENDINGS:
            run = self.start("fit", "-", "-n", 8, "-q", "-o", "-", stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                             preexec_fn=lambda: signal.signal(number, signal.SIG_IGN))
            until(lambda: self.sleeps_in(run, self.READ), "reading")
            run.send_signal(number)
            out, said = run.communicate((self.folder / "p.csv").read_bytes(), timeout=GUARD)
            self.assertEqual((run.returncode, out, said), (0, (self.folder / "s.json").read_bytes(), b""))

    def test_a_full_file_is_an_error_not_a_signal(self):
        run = self.start("generate", "rose", "-o", "new.csv", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (99, 99)))
        _, said = run.communicate(timeout=GUARD)
        self.assertEqual((run.returncode, said), (3, b"batten: new.csv: cannot be written: File too large\n"))
        self.assertFalse((self.folder / "new.csv").exists())


if __name__ == "__main__":
    unittest.main()
