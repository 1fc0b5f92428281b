"""Tests how scripts give maps to their drives."""

from __future__ import annotations

import subprocess
import unittest
from pathlib import Path

from evaluation import map_turns

ROOT = Path(__file__).resolve().parents[2]


class MapTurnsTest(unittest.TestCase):
    def test_every_second_drive_has_a_map_in_turn(self) -> None:
        maps = [Path("a"), Path("b")]
        given = [map_turns.map_of(drive, maps) for drive in range(6)]
        self.assertEqual(given, [None, maps[0], None, maps[1], None, maps[0]])
        self.assertIsNone(map_turns.map_of(1, []))

    def refused(self, script: str, *words: str) -> str:
        command = [str(ROOT / "script" / script), *words]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(ended.returncode, 2, ended.stderr)
        return ended.stderr

    def test_a_map_that_no_drive_uses_is_refused(self) -> None:
        said = self.refused("campaign", "--seeds", "3", "--map", "a.osm", "b.osm")
        self.assertRegex(said, "--map: found 2 of them with --seeds 3, wanted --seeds 4 or more")
        said = self.refused("evaluate", "--drives", "1", "--map", "a.osm")
        self.assertRegex(said, "--map: found 1 of them with --drives 1, wanted --drives 2 or more")


if __name__ == "__main__":
    unittest.main()
