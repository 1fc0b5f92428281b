"""Tests the types of command line options."""

from __future__ import annotations

import tempfile
import unittest
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path

from tooling.option_types import above_zero, positive, whole_number, writable


class Types(unittest.TestCase):
    def refused(self, kind: Callable[[str], object], *texts: str) -> None:
        for text in texts:
            with self.assertRaisesRegex(ArgumentTypeError, f"found '{text}', wanted a"):
                kind(text)

    def test_whole_numbers(self):
        self.assertEqual((positive("1"), whole_number(0)("0")), (1, 0))
        self.refused(positive, "0", "-1", "1.5", "one", "")

    def test_numbers_above_zero(self):
        self.assertEqual(above_zero("3e-5"), 3e-5)
        self.refused(above_zero, "0", "-1", "nan", "inf", "one", "")

    def test_files_that_can_be_written(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(writable(f"{folder}/new"), Path(folder) / "new")
            self.refused(writable, folder, f"{folder}/no/new")


if __name__ == "__main__":
    unittest.main()
