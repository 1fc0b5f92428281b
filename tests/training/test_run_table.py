"""Tests the tables to which a run appends."""

import tempfile
import unittest
from pathlib import Path

from training.run_table import TABLES, append_row, drop_rows_after


class AppendRow(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "curves.csv"

    def append(self, *rows: dict[str, float]) -> list[str]:
        for row in rows:
            append_row(self.path, row)
        return self.path.read_text().splitlines()

    def test_the_first_row_names_the_columns(self):
        lines = self.append({"step": 1, "loss": 0.5}, {"step": 2, "loss": 0.25})
        self.assertEqual(lines, ["step,loss", "1,0.5", "2,0.25"])

    def test_an_old_table_gets_missing_columns(self):
        self.path.write_text("step,loss\r\n1,0.5\r\n")
        lines = self.append({"step": 2, "new": 3.0, "loss": 0.25}, {"step": 3, "new": 4, "loss": 0})
        self.assertEqual(lines, ["step,loss,new", "1,0.5,nan", "2,0.25,3.0", "3,0,4"])

    def test_a_column_that_is_no_longer_known_is_nan(self):
        self.path.write_text("step,old\r\n1,7\r\n")
        self.assertEqual(self.append({"step": 2}), ["step,old", "1,7", "2,nan"])

    def test_an_empty_file_gets_a_header(self):
        self.path.write_text("")
        self.assertEqual(self.append({"step": 1}), ["step", "1"])


class DropRows(unittest.TestCase):
    def test_rows_of_later_samples_are_removed_from_both_tables(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder) / name for name in TABLES]
            for path in paths:
                for samples in (8, 16, 24):
                    append_row(path, {"samples": samples, "loss": 0.5})
            drop_rows_after(Path(folder), 16)
            for path in paths:
                self.assertEqual(path.read_text().splitlines(), ["samples,loss", "8,0.5", "16,0.5"])

    def test_a_new_run_has_no_table(self):
        with tempfile.TemporaryDirectory() as folder:
            drop_rows_after(Path(folder), 0)
            self.assertEqual(list(Path(folder).iterdir()), [])


if __name__ == "__main__":
    unittest.main()
