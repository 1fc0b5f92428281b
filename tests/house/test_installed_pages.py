"""Tests which links of the installed pages count as broken."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from tests.house.installed_pages import broken_links


class BrokenLinks(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_are_those_to_files_that_are_not_there(self) -> None:
        (self.folder / "docs").mkdir()
        page = "[a](b.md#part), [c](../d.md), [e](#here), [f](https://example.org/g.md)\n"
        (self.folder / "docs/a.md").write_text(page, encoding="utf-8")
        self.assertEqual(broken_links(self.folder), ["docs/a.md: b.md#part", "docs/a.md: ../d.md"])
        (self.folder / "docs/b.md").write_text("", encoding="utf-8")
        (self.folder / "d.md").write_text("", encoding="utf-8")
        self.assertEqual(broken_links(self.folder), [])

    def test_are_not_those_to_pictures_and_to_the_licence(self) -> None:
        page = "![a](images/a.png), [b](LICENSE)\n"
        (self.folder / "README.md").write_text(page, encoding="utf-8")
        self.assertEqual(broken_links(self.folder), [])


if __name__ == "__main__":
    unittest.main()
