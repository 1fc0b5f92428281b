"""Tests Markdown tables and the generated parts of documents."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from training import model_table, quantization_report, report
from training.errors import TrainingError
from training.markdown import table, write_between_marks


class Table(unittest.TestCase):
    def test_columns_of_numbers_are_aligned_to_the_right(self):
        head, rows = ("name", "unit", "size"), [["a", "m", "1"], ["b", "s", "2"]]
        self.assertEqual(
            table(head, rows),
            "| name | unit | size |\n| --- | ---: | ---: |\n| a | m | 1 |\n| b | s | 2 |\n",
        )
        self.assertIn("\n| --- | --- | ---: |\n", table(head, rows, text_columns=2))
        self.assertIn("\n| ---: | ---: | ---: |\n", table(head, rows, text_columns=0))


class Marks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.document = Path(folder.name) / "page.md"

    def test_only_what_lies_between_the_marks_changes(self):
        for writer in (model_table, quantization_report, report):
            begin, end = writer.BEGIN, writer.END
            self.document.write_text(f"before\n{begin}old\n{end}after\n")
            write_between_marks(self.document, begin, end, "new\n")
            self.assertEqual(self.document.read_text(), f"before\n{begin}new\n{end}after\n")

    def test_a_document_without_both_marks_is_refused_by_name_and_stays(self):
        for content in ("no marks\n", "a\n<begin>old\n", "a\nold\n<end>\n", "<end><begin>"):
            self.document.write_text(content)
            with self.assertRaisesRegex(ValueError, "page.md") as raised:
                write_between_marks(self.document, "<begin>", "<end>", "new\n")
            self.assertIsInstance(raised.exception, TrainingError)
            self.assertEqual(self.document.read_text(), content)


if __name__ == "__main__":
    unittest.main()
