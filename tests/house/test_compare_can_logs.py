"""Tests script/compare-can-logs."""

from __future__ import annotations

import unittest
from types import ModuleType

from tests.support.script_module import load_script


class CompareTest(unittest.TestCase):
    script: ModuleType

    @classmethod
    def setUpClass(cls) -> None:
        cls.script = load_script("compare-can-logs")

    def frame(self, value: float | None, message: str = "M") -> object:
        return self.script.Frame(0.5, message, {"CHECKSUM": value, "S": value})

    def test_counts_frames_that_differ_and_keeps_the_largest_difference(self) -> None:
        first = [self.frame(value) for value in (1.0, 2.0, 3.0)]
        second = [self.frame(value) for value in (1.0, 2.5, 2.75)]
        differences = self.script.compare(first, second)
        self.assertEqual(list(differences), ["M.S"])
        self.assertEqual((differences["M.S"].frames, differences["M.S"].most), (2, 0.5))

    def test_notices_a_value_in_one_log_only(self) -> None:
        differences = self.script.compare([self.frame(None)], [self.frame(1.0)])
        self.assertEqual(differences["M.S"].one_sided, 1)

    def test_refuses_logs_with_other_frames(self) -> None:
        for second in ([], [self.frame(1.0, "N")]):
            with self.assertRaisesRegex(ValueError, "frame 0"):
                self.script.compare([self.frame(1.0)], second)

    def test_refuses_empty_logs(self) -> None:
        with self.assertRaisesRegex(ValueError, "no frames"):
            self.script.compare([], [])


if __name__ == "__main__":
    unittest.main()
