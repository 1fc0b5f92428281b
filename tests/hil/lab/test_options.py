"""Tests that the lab's programs check their options before anything is built."""

import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]


class Check(unittest.TestCase):
    def answer(self, program: str, *options: str) -> tuple[int, str]:
        """Exit status and the last line of errors of the options alone."""
        done = subprocess.run(
            [sys.executable, "-m", f"tests.hil.{program}", "--check", *options],
            cwd=ROOT, capture_output=True, text=True, check=False,
        )
        return done.returncode, done.stderr.strip().rpartition("\n")[2]

    def test_good_options_are_accepted(self) -> None:
        self.assertEqual(self.answer("lab", "drive", "can-down"), (0, ""))
        self.assertEqual(self.answer("vehicle_image", "--keep-disk", "start"), (0, ""))

    def test_names_of_no_scenario_are_refused(self) -> None:
        for program, script in (("lab", "hil"), ("vehicle_image", "try-image")):
            status, said = self.answer(program, "drive-backwards")
            self.assertEqual(status, 2)
            found = f"script/{script}: error: found no scenario 'drive-backwards', wanted one of "
            self.assertTrue(said.startswith(found), said)

    def test_an_image_needs_packages(self) -> None:
        status, said = self.answer("vehicle_image", "--packages", "/nowhere", "start")
        self.assertEqual(status, 2)
        self.assertIn("found 0 files bevloc_*_amd64.deb in /nowhere, wanted one", said)


if __name__ == "__main__":
    unittest.main()
