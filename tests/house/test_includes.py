"""Holds every #include to the table of docs/architecture.md."""

from __future__ import annotations

import re
import unittest

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
