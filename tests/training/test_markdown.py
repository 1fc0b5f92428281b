"""Tests that the programs which write a part of a document find their own marks."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from tooling.markdown import write_between_marks
from training import model_table, quantization_report, report


class Marks(unittest.TestCase):
    def test_only_what_lies_between_the_marks_changes(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            document = Path(folder) / "page.md"
            for writer in (model_table, quantization_report, report):
                begin, end = writer.BEGIN, writer.END
                document.write_text(f"before\n{begin}old\n{end}after\n")
                write_between_marks(document, begin, end, "new\n")
                self.assertEqual(document.read_text(), f"before\n{begin}new\n{end}after\n")


if __name__ == "__main__":
    unittest.main()
