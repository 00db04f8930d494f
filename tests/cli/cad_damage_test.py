"""Damaged STEP and IGES files, by seed: read, or refused in one line; the process that reads keeps its limits and ends with the command."""
import collections
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import tempfile
import time
import unittest

import numpy as np
from scipy.interpolate import BSpline

from judge import BATTEN, GUARD

CASES = 40  # of each file and kind of damage
RATIONAL = re.compile(r"the (curve|surface) is rational")


def without_lines(content, draw):
    lines = content.splitlines(keepends=True)
    for _ in range(draw.randint(1, 4)):
        lines.pop(draw.randrange(len(lines)))
    return b"".join(lines)


def cut_off(content, draw):
    return content[:draw.randrange(len(content))]


def with_other_bytes(content, draw):
    content = bytearray(content)
    for _ in range(draw.randint(1, 6)):
        content[draw.randrange(len(content))] = draw.randrange(256)
    return bytes(content)


def with_other_numbers(content, draw):
    """References (#12) of STEP lead elsewhere or nowhere; numbers of IGES, counts and pointers among them, have other digits."""
    found = list(re.finditer(rb"#\d+" if content.startswith(b"ISO") else rb"\d+", content))
    for place in sorted(draw.sample(found, draw.randint(1, 3)), key=lambda m: -m.start()):
        digits = bytes(draw.choice(b"0123456789") for _ in range(place.end() - place.start()))
        new = b"#%d" % draw.choice([0, draw.randint(1, 60), 99999, 10**15]) if place.group().startswith(b"#") else digits
        content = content[:place.start()] + new + content[place.end():]
    return content


def with_lines_swapped(content, draw):
    lines = content.splitlines(keepends=True)
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return b"".join(lines)


def child_of(process):
    """The process that a process has started, once there is one; None when it ended before."""
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while process.poll() is None:
        try:
            found = children.read_text().split()
        except OSError:
            break
        if found and pathlib.Path(f"/proc/{found[0]}/comm").read_text().strip() == "batten-cad":
            return int(found[0])
    return None


def state(pid):
    """The letter of a process's state; none when it is gone."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return ""


def wait_until(holds):
    end = time.monotonic() + GUARD
    while not holds():
        if time.monotonic() > end:
            raise AssertionError("nothing happened")
        time.sleep(0.01)


class CadDamage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls._folder.name)
        for words in ("generate naca2412 -o c.csv", "fit c.csv -n 8 -q -o c.json -o c.step -o c.igs", "generate peaks --samples 20x20 -o s.npy",
                      "fit s.npy -n 6x5 -q -o s.json -o s.step -o s.igs", "convert s.json c.json -o b.step", "convert s.json c.json -o b.igs",
                      "generate peaks --samples 350x350 -o large.npy", "fit large.npy -n 300x300 -q -o large.step"):
            subprocess.run([BATTEN, *words.split()], cwd=cls.folder, check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def judge(self, name, label):
        """Runs a conversion; its status, and the words after the path where it was refused."""
        run = subprocess.run([BATTEN, "convert", name, "-o", "o.g2"], cwd=self.folder, capture_output=True, timeout=GUARD)
        words = run.stderr.decode(errors="replace")
        if run.returncode == 0:
            for note in words.splitlines():
                self.assertRegex(note, f"^batten: {name}: [0-9]+ of its faces .*(: left out|without the trims)$", label)
            words = ""
            self.check_splines((self.folder / "o.g2").read_text().split(), label)
        else:
            self.assertTrue(words.startswith(f"batten: {name}: ") and words.endswith("\n"), (label, words))
            self.assertTrue(words[:-1].isprintable(), (label, words))
            self.assertEqual(run.returncode, 2 if RATIONAL.search(words) else 3, (label, words))
        return words.removeprefix(f"batten: {name}: ").strip()

    def check_splines(self, numbers, label):
        """What was read are splines by SciPy's rules; numbers of GoTools' text: kind, dimension, sizes, knots, control points."""
        while numbers:
            axes = {"100": 1, "200": 2}[numbers[0]]
            dim, at, shape, knots = int(numbers[4]), 6, [], []
            for _ in range(axes):
                count, order = int(numbers[at]), int(numbers[at + 1])
                shape.append(count)
                knots.append(np.array(numbers[at + 2:at + 2 + count + order], float))
                at += 2 + count + order
            control = np.array(numbers[at:at + dim * np.prod(shape)], float).reshape([*shape[::-1], dim])
            self.assertTrue(np.isfinite(control).all(), label)
            for axis, t in enumerate(knots):
                BSpline(t, np.moveaxis(control, axes - 1 - axis, 0), len(t) - shape[axis] - 1)
            numbers = numbers[at + dim * np.prod(shape):]

    def test_damaged_files_are_read_or_refused_in_one_line(self):
        outcomes = collections.Counter()
        for original in ("c.step", "c.igs", "s.step", "s.igs", "b.step", "b.igs"):
            content = (self.folder / original).read_bytes()
            for damage in (without_lines, cut_off, with_other_bytes, with_other_numbers, with_lines_swapped):
                for seed in range(CASES // 5):
                    label = f"{original} {damage.__name__} {seed}"
                    name = "damaged" + pathlib.Path(original).suffix
                    (self.folder / name).write_bytes(damage(content, random.Random(label)))
                    outcomes[self.judge(name, label).partition(" (")[0]] += 1
        # the damage was such that all of this was seen
        for words in ("", "Open CASCADE failed while reading it", "not a STEP file that can be read",
                      "the file holds no B-spline curve or surface", "the file is cut off: its terminate section is missing"):
            self.assertGreater(outcomes[words], 0, outcomes)
        for words in ("the file is damaged: behind record", "the file is damaged: numbers are missing", "the file is damaged: '"):
            self.assertTrue(any(said.startswith(words) for said in outcomes), outcomes)

    def test_every_prefix_is_refused(self):
        for name in ("c.step", "c.igs"):
            content = (self.folder / name).read_bytes()
            cut = "cut" + pathlib.Path(name).suffix
            for size in range(0, len(content) - 3, len(content) // 50):
                (self.folder / cut).write_bytes(content[:size])
                self.assertNotEqual(self.judge(cut, f"{name}, {size} bytes"), "", f"{name}, {size} bytes")

    def test_counts_that_memory_cannot_hold(self):
        content = (self.folder / "s.igs").read_text()
        line = re.search(r"^128,5,4,.{55}", content, re.MULTILINE).group()  # the columns of a record's text
        (self.folder / "huge.igs").write_text(content.replace(line, "128,99999999,9,3,3,0,0,1,0,0,".ljust(len(line))))
        self.assertIn("numbers are missing in the B-spline of directory record", self.judge("huge.igs", "huge"))
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 2**21)  # KiB

    def paused(self, name="large.step"):
        """A run of `info` whose reading process is found at work and stopped, as if it hung."""
        while True:
            run = subprocess.Popen([BATTEN, "info", name], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            child = child_of(run)
            if child is not None and self.limits(child)["Max core file size"][0] == "0":
                os.kill(child, signal.SIGSTOP)
                wait_until(lambda: state(child) != "R" and state(child) != "S")
                if state(child) == "T":
                    return run, child
            run.kill()
            run.communicate()

    def limits(self, pid):
        """Soft and hard limits by name, once the process has set them."""
        found = {}
        while found.get("Max core file size", ("", ""))[1] != "0":
            try:
                text = pathlib.Path(f"/proc/{pid}/limits").read_text()
            except OSError:
                return {"Max core file size": ("", "")}
            if not text or state(pid) in ("Z", ""):
                return {"Max core file size": ("", "")}
            found = {line[:26].strip(): tuple(line[26:].split()[:2]) for line in text.splitlines()}
        return found

    def test_the_reading_process_is_limited(self):
        run, child = self.paused()
        limits = self.limits(child)
        size = (self.folder / "large.step").stat().st_size + 200  # the request's head
        used = int(re.search(r"VmSize:\s*(\d+) kB", pathlib.Path(f"/proc/{child}/status").read_text()).group(1)) * 1024
        self.assertLessEqual(int(limits["Max cpu time"][1]), 6 + 10 * size / 2**20)
        self.assertLessEqual(int(limits["Max address space"][0]) - used, 2**30 + 64 * size)
        os.kill(child, signal.SIGXCPU)
        os.kill(child, signal.SIGCONT)
        self.assertEqual(run.communicate(timeout=GUARD)[1], "batten: large.step: Open CASCADE failed while reading it "
                         "(it came to no end in the processor time allowed)\n")
        self.assertEqual(run.returncode, 3)

    def test_it_ends_with_the_command(self):
        run, child = self.paused()
        run.kill()
        run.communicate()
        wait_until(lambda: state(child) in ("", "Z"))

    def test_an_interrupt_ends_both(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            run, child = self.paused()
            run.send_signal(number)
            self.assertEqual(run.communicate(timeout=GUARD)[1], "batten: interrupted; nothing was written\n")
            self.assertEqual(run.returncode, 130)
            end = time.monotonic() + GUARD  # the system ends it once its parent has gone
            while state(child) and time.monotonic() < end:
                time.sleep(0.01)
            self.assertEqual(state(child), "")


if __name__ == "__main__":
    unittest.main()
