"""The table of docs/integrity.md, from made-up rows."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from evaluation.campaign import table
from tooling.errors import MarksError


def row(seed: int, beyond_s: float, detection_s: float | None) -> table.Row:
    return {
        "mode": "gnss-jump",
        "what": "GNSS jumps",
        "seed": seed,
        "detected_by": "GnssContradicts" if detection_s is not None else None,
        "detection_s": detection_s,
        "valid_beyond_alert_s": beyond_s,
        "limit_s": 0.3,
        "worst": [0.1, 0.2 * seed, 0.3],
        "fault_ends": True,
        "recovery_s": 0.0,
        "valid_share": 0.9,
    }


class TableTest(unittest.TestCase):
    def test_shows_the_worst_seed(self) -> None:
        text = table.text_of([row(1, 0.0, 1.0), row(2, 0.25, 3.0)])
        line = text.splitlines()[-1]
        self.assertIn("| 0.25 | 0.10 / 0.40 / 0.30 |", line)
        self.assertIn("| GnssContradicts | 2.00 to 3.00 |", line)
        self.assertNotIn("fails", line)

    def test_says_which_mode_fails(self) -> None:
        self.assertIn("**fails** (0.3 s allowed)", table.text_of([row(1, 0.31, None)]))

    def test_says_in_how_many_runs_something_was_detected(self) -> None:
        self.assertIn("2.00 in 1 of 2", table.text_of([row(1, 0.0, None), row(2, 0.0, 2.0)]))

    def test_a_run_that_was_never_valid_has_no_time_of_detection(self) -> None:
        never = row(1, 0.0, None)
        never["detected_by"] = "never valid"
        self.assertIn("| never valid | - |", table.text_of([never]))
        line = table.text_of([never, row(2, 0.0, 2.0)])
        self.assertIn("| never valid, GnssContradicts | 2.00 in 1 of 2 |", line)

    def test_replaces_only_what_is_between_the_marks(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            begin, end = table.marks("stage")
            page.write_text(f"before\n{begin}old\n{end}after\n")
            table.write(page, "stage", "script/campaign", "new\n")
            text = page.read_text()
            self.assertTrue(text.startswith("before\n"))
            self.assertTrue(text.endswith("after\n"))
            self.assertIn("new", text)
            self.assertNotIn("old", text)
            with self.assertRaises(MarksError):
                table.write(page, "pictures", "script/campaign", "new\n")


if __name__ == "__main__":
    unittest.main()
