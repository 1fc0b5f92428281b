"""Tests Markdown tables and the generated parts of documents."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from tooling.errors import MarksError
from tooling.markdown import table, write_between_marks


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
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.document = Path(folder.name) / "page.md"

    def test_only_what_lies_between_the_marks_changes(self) -> None:
        self.document.write_text("before\n<begin>old\n<end>after <begin>\n")
        write_between_marks(self.document, "<begin>", "<end>", "new\n")
        self.assertEqual(self.document.read_text(), "before\n<begin>new\n<end>after <begin>\n")

    def test_a_document_without_both_marks_is_refused_by_name_and_stays(self) -> None:
        for content in ("no marks\n", "a\n<begin>old\n", "a\nold\n<end>\n", "<end><begin>"):
            self.document.write_text(content)
            with self.assertRaisesRegex(MarksError, "page.md"):
                write_between_marks(self.document, "<begin>", "<end>", "new\n")
            self.assertEqual(self.document.read_text(), content)


if __name__ == "__main__":
    unittest.main()
