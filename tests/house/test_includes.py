"""Holds every #include to the table of docs/architecture.md."""

from __future__ import annotations

import re
import unittest
from collections import defaultdict

from tests.house.test_documents import ROOT, tracked

INCLUDE = re.compile(r'^\s*#include "([^"]+)"', re.MULTILINE)
ROW = re.compile(r"^\| `([^`]+)` \| (.+) \|$", re.MULTILINE)


def rules() -> dict[str, set[str]]:
    """For each folder, the folders that it may include; each may include itself."""
    page = (ROOT / "docs/architecture.md").read_text()
    table = page[page.index("| Folder | May include |"):].split("\n\n")[0]
    allowed = {}
    for folder, cell in ROW.findall(table):
        allowed[folder] = {folder, *re.findall(r"`([^`]+)`", cell)}
    return allowed


def room_of(path: str, rooms: set[str]) -> str | None:
    """The longest folder of the table that holds this file."""
    fitting = [room for room in rooms if path.startswith(room + "/")]
    return max(fitting, key=len) if fitting else None


def cxx_files() -> list[str]:
    return [str(path.relative_to(ROOT)) for path in tracked("*.h", "*.cpp")]


def uses_between_neighbours(listed: list[str]) -> dict[str, set[str]]:
    """For each folder, the folders beside it whose files its own files include, at any depth."""
    uses: dict[str, set[str]] = defaultdict(set)
    for name in listed:
        for included in INCLUDE.findall((ROOT / name).read_text()):
            ours, theirs = name.split("/")[:-1], included.split("/")[:-1]
            shared = 0
            while shared < min(len(ours), len(theirs)) and ours[shared] == theirs[shared]:
                shared += 1
            if shared < min(len(ours), len(theirs)):
                uses["/".join(ours[: shared + 1])].add("/".join(theirs[: shared + 1]))
    return uses


def cycles(uses: dict[str, set[str]]) -> list[str]:
    """Removes folders that use no remaining folder until there are none. The rest is in a cycle or
    uses one."""
    left = {folder: set(used) for folder, used in uses.items()}
    while bottom := [folder for folder, used in left.items() if not used & left.keys()]:
        for folder in bottom:
            del left[folder]
    return [f"{folder} -> {', '.join(sorted(used & left.keys()))}" for folder, used in left.items()]


class IncludesTest(unittest.TestCase):
    def test_follow_the_table_of_the_architecture(self) -> None:
        allowed = rules()
        self.assertGreaterEqual(len(allowed), 9)
        listed = cxx_files()
        wrong = []
        for name in listed:
            room = room_of(name, set(allowed))
            self.assertIsNotNone(room, f"{name} is in no folder of the table")
            for included in INCLUDE.findall((ROOT / name).read_text()):
                target = room_of(included, set(allowed))
                if target is not None and target not in allowed[str(room)]:
                    wrong.append(f"{name} includes {included}")
        self.assertEqual(wrong, [], "docs/architecture.md allows none of these")

    def test_form_no_cycle_between_neighbouring_folders(self) -> None:
        production = [name for name in cxx_files() if not name.startswith("tests/")]
        self.assertEqual(cycles(uses_between_neighbours(production)), [])

    def test_finds_a_cycle(self) -> None:
        uses = {"a/x": {"a/y"}, "a/y": {"a/z"}, "a/z": {"a/y"}, "a/w": {"a/x"}, "b": {"c"}}
        self.assertEqual(sorted(cycles(uses)), ["a/w -> a/x", "a/x -> a/y", "a/y -> a/z",
                                                "a/z -> a/y"])

    def test_write_every_path_from_the_root(self) -> None:
        listed = cxx_files()
        wrong = [
            f"{name}: {included}"
            for name in listed
            for included in INCLUDE.findall((ROOT / name).read_text())
            if not (ROOT / included).exists()
            # The receivers of the package bevloc-dev are compiled outside of this tree.
            and not (name.startswith("can/consumer/")
                     and (ROOT / name).with_name(included).exists())
        ]
        self.assertEqual(wrong, [])


if __name__ == "__main__":
    unittest.main()
