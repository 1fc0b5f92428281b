"""Tests programs that refuse their options."""


from __future__ import annotations

import contextlib
import io
import sys
import unittest
from collections.abc import Callable
from unittest.mock import patch

from training import drive_report, evaluate, export_onnx, picture_statistics


class Programs(unittest.TestCase):
    def refusal(self, main: Callable[[], None], *arguments: str) -> str:
        said = io.StringIO()
        with patch.object(sys, "argv", ["program", *arguments]), contextlib.redirect_stderr(said):
            with self.assertRaises(SystemExit) as ended:
                main()
        self.assertEqual(ended.exception.code, 2)
        return said.getvalue()

    def test_no_program_runs_without_a_thread(self):
        for main in (export_onnx.main, drive_report.main, evaluate.main):
            said = self.refusal(main, "a", "b", "--threads", "0")
            self.assertIn("argument --threads: found '0', wanted a whole number", said)

    def test_a_report_that_cannot_be_written_is_refused_before_the_work(self):
        said = self.refusal(drive_report.main, "a", "b", "--out", "/nowhere/report.md")
        self.assertIn("argument --out: found '/nowhere/report.md', wanted a file in", said)

    def test_evaluation_ignores_no_option(self):
        both = ("checkpoint.pt", "--nuscenes", "tree", "--write", "models")
        self.assertIn("--write: found --nuscenes too", self.refusal(evaluate.main, *both))
        alone = ("checkpoint.pt", "--scenes", "val.txt")
        self.assertIn("--scenes: found no --nuscenes", self.refusal(evaluate.main, *alone))
        alone = ("checkpoint.pt", "--nuscenes-version", "v1.0-mini")
        said = self.refusal(evaluate.main, *alone)
        self.assertIn("--nuscenes-version: found no --nuscenes", said)
        said = self.refusal(evaluate.main, "checkpoint.pt", "--line-width-cells", "8")
        self.assertIn("--line-width-cells: found no --nuscenes", said)

    def test_a_real_frame_needs_its_rig(self):
        said = self.refusal(picture_statistics.main, "--real", "pictures")
        self.assertIn("--real and --rig: found one of them", said)


if __name__ == "__main__":
    unittest.main()
