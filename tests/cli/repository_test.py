"""What stands in the repository is about the project alone: no registry's host, no path of one machine, no packages' addresses."""
import json
import os
import pathlib
import re
import unittest

ROOT = pathlib.Path(os.environ["BATTEN_ROOT"])
GENERATED = {".git", "build", "out", "node_modules", "dist", "__pycache__", "reproduced", ".cache"}
# written in pieces, so that this file does not name what it looks for
HOSTS = re.compile("|".join(["registry" + r"\.(npmjs|yarnpkg)", "npmjs" + r"\.org", "pypi" + r"\.org", "pythonhosted" + r"\.org", "deb" + r"\.debian\.org",
                             "crates" + r"\.io", "proxy" + r"\.golang", "arti" + "factory", "nexus" + r"[./]"]))
PATHS = re.compile("|".join([r"(?<![\w.])" + f"/{folder}/" + r"\w" for folder in ("home", "root", "Users", "work", "mnt")] + [r"[A-Z]:\\\\Users"]))


def texts():
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [name for name in folders if name not in GENERATED]
        for name in names:
            path = pathlib.Path(folder) / name
            if name in GENERATED or path.suffix in (".png", ".npy") or path.is_symlink():
                continue
            yield path.relative_to(ROOT), path.read_text(errors="replace")


class Repository(unittest.TestCase):
    def test_no_registry_is_named(self):
        for path, text in texts():
            self.assertIsNone(HOSTS.search(text), path)

    def test_no_path_of_a_machine_is_named(self):
        for path, text in texts():
            found = PATHS.search(text)
            self.assertIsNone(found, f"{path}: {found and text[found.start():found.end() + 30]!r}")

    def test_the_lock_file_is_complete(self):
        """Every package that another asks for on any platform is there, with its checksum and without an address."""
        packages = json.loads((ROOT / "viewer" / "package-lock.json").read_text())["packages"]
        for name, entry in packages.items():
            self.assertNotIn("resolved", entry, name)
            if name:
                self.assertTrue(entry.get("integrity", "").startswith("sha512-"), name)
            for wanted in {**entry.get("dependencies", {}), **entry.get("optionalDependencies", {}), **entry.get("devDependencies", {})}:
                self.assertTrue(f"node_modules/{wanted}" in packages or f"{name}/node_modules/{wanted}" in packages, f"{name or 'viewer'} needs {wanted}")

    def test_every_reader_has_seeds(self):
        readers = re.search(r"foreach\(reader ([\w ]+)\)", (ROOT / "tests/fuzz/CMakeLists.txt").read_text())[1].split()
        self.assertEqual(sorted(readers), sorted(p.name for p in (ROOT / "tests/fuzz/seeds").iterdir()))
        for reader in readers:
            self.assertGreater(len(list((ROOT / "tests/fuzz/seeds" / reader).iterdir())), 0, reader)


if __name__ == "__main__":
    unittest.main()
