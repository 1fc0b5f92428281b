"""Compares the tests that docs/safety.md names with the sources, so that its evidence is there."""

from __future__ import annotations

import re
import unittest

from tests.house.test_documents import ROOT

PAGE = ROOT / "docs/safety.md"
NAMED_TEST = re.compile(r"`([A-Z]\w*)\.([A-Z]\w*|\*)`")
DEFINED_TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", re.MULTILINE)
LIST_OF_SUITES = "Where the suites are:"
EXAMPLE = "Suite"  # "`Suite.Name` is a unit test"


def named_tests(page: str) -> set[tuple[str, str]]:
    return {(suite, name) for suite, name in NAMED_TEST.findall(page) if suite != EXAMPLE}


def folders_of_suites(page: str) -> dict[str, str]:
    """The folder of each suite of the list. `E2e...` stands for all suites that begin so."""
    listed = page.split(LIST_OF_SUITES)[1].split("\n\n")[0]
    folders: dict[str, str] = {}
    for part in " ".join(listed.split()).split(";"):
        suites, _, folder = part.partition(" in `")
        for suite in re.findall(r"`(\w+(?:\.\.\.)?)`", suites):
            folders[suite] = folder.partition("`")[0]
    return folders


def folder_of(suite: str, folders: dict[str, str]) -> str:
    """An empty text if the list lacks the suite."""
    for listed, folder in folders.items():
        if suite == listed or (listed.endswith("...") and suite.startswith(listed[:-3])):
            return folder
    return ""


def tests_of(folder: str) -> set[tuple[str, str]]:
    found: set[tuple[str, str]] = set()
    for source in (ROOT / folder).glob("*.cpp"):
        for suite, name in DEFINED_TEST.findall(source.read_text()):
            found |= {(suite, name), (suite, "*")}
    return found


class SafetyPageTest(unittest.TestCase):
    def test_every_named_test_is_where_the_page_says(self) -> None:
        page = PAGE.read_text()
        folders = folders_of_suites(page)
        defined = {folder: tests_of(folder) for folder in set(folders.values())}
        named = named_tests(page)
        self.assertGreater(len(named), 50)
        missing: list[str] = []
        for suite, name in sorted(named):
            folder = folder_of(suite, folders)
            if not folder:
                missing.append(f"{suite} is not in the list of the suites")
            elif (suite, name) not in defined[folder]:
                missing.append(f"{suite}.{name} is not in {folder}")
        self.assertEqual(missing, [])


if __name__ == "__main__":
    unittest.main()
