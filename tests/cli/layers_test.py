"""No stage of the library includes a higher one; every source is listed; no file outgrows its room."""
import os
import pathlib
import re
import unittest

ROOT = pathlib.Path(os.environ["BATTEN_ROOT"])
STAGES = ROOT / "src" / "batten"
# the floors of docs/architecture.md, from the bottom
FLOOR = {"core": 0, "samples": 1, "shape": 1, "parametrize": 2, "basis": 2, "spline": 3, "system": 4, "measure": 5,
         "io": 5, "solve": 6, "iterate": 7, "fair": 8, "problem": 8, "search": 9, "robust": 9, "drivers": 10, "fit": 11, "report": 12}


class Layers(unittest.TestCase):
    def test_includes_point_downwards(self):
        for file in STAGES.glob("*/*.[ch]pp"):
            if file.name.endswith("_test.cpp"):
                continue
            here = file.parent.name
            for stage in re.findall(r"#include <batten/(\w+)/", file.read_text()):
                self.assertTrue(stage == here or FLOOR[stage] < FLOOR[here], f"{file.relative_to(ROOT)} includes {stage}/")

    def test_every_source_is_listed(self):
        listed = (STAGES / "CMakeLists.txt").read_text() + (ROOT / "tests" / "CMakeLists.txt").read_text()
        for file in STAGES.glob("*/*.cpp"):
            self.assertIn(f"{file.parent.name}/{file.name}", listed)

    def test_the_library_names_no_flag_of_the_command(self):
        """Its words are for every caller: options by the names that they have in it."""
        for file in [*STAGES.glob("*/*.[ch]pp"), *(ROOT / "cad").rglob("*.[ch]pp")]:
            for line in file.read_text().splitlines():
                if not file.name.endswith("_test.cpp"):
                    self.assertNotRegex(re.sub("//.*", "", line), r'"[^"]*--\w', file.relative_to(ROOT))

    def test_files_stay_small(self):
        for file in [*STAGES.rglob("*.[ch]pp"), *(ROOT / "apps").rglob("*.[ch]pp")]:
            if not file.name.endswith("_test.cpp"):
                self.assertLessEqual(len(file.read_text().splitlines()), 300, file.relative_to(ROOT))


if __name__ == "__main__":
    unittest.main()
