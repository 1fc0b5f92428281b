"""Tests which links of the installed pages count as broken."""

from __future__ import annotations

import fnmatch
import re
import tempfile
import unittest
from pathlib import Path

from tests.house.installed_pages import broken_links, named_configs
from tests.house.test_documents import ROOT, tracked


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


class Configs(unittest.TestCase):
    def test_are_found_in_the_commands_and_the_text_of_a_page(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            text = "`config/a.yaml`, tests/hil/config/b.yaml\n\n    --dbc config/c.dbc x\n"
            page.write_text(text, encoding="utf-8")
            self.assertEqual(named_configs(page), {"a.yaml", "c.dbc"})

    def test_that_pages_use_are_installed(self) -> None:
        install = (ROOT / "cmake/Install.cmake").read_text(encoding="utf-8")
        # As files, or by the pattern of a folder.
        installed = re.findall(r'config/([\w.]+)|PATTERN "([\w*.]+)"', install)
        missing = {
            name
            for page in tracked("*.md")
            for name in named_configs(page)
            if (ROOT / "config" / name).exists()
            and not any(fnmatch.fnmatch(name, file or pattern) for file, pattern in installed)
        }
        self.assertEqual(missing, set())


if __name__ == "__main__":
    unittest.main()
