"""Tries the tools of the simulator with options that make no sense."""

from __future__ import annotations

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

BIN = Path(os.environ["BEVLOC_BIN"])


class ToolsTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_tool(self, name: str, *words: str) -> subprocess.CompletedProcess[str]:
        command = [str(BIN / f"bevloc_{name}"), *words]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.folder)

    def expect_refused(self, name: str, *words: str, said: str = "") -> None:
        ended = self.run_tool(name, *words)
        self.assertEqual(ended.returncode, 2, words)
        self.assertRegex(ended.stderr, said or r"found .* wanted|not in range", words)
        self.assertEqual(list(self.folder.glob("*.png")), [])

    def test_a_world_is_drawn_with_a_size(self) -> None:
        for words in (
            *(("--pixels", "0"), ("--pixels", "-5"), ("--size", "0"), ("--size", "nan")),
            *(("--east", "inf"), ("--north", "nan"), ("--time", "-1"), ("--map", "")),
        ):
            self.expect_refused("draw_world", "1", "world.png", *words)
        self.expect_refused("draw_world", "1", "no/world.png", said="found no folder no")
        self.expect_refused("draw_world", "1", "world.png", "--map", "no.osm", said="no.osm")

    def test_a_world_is_rendered_from_a_pose_in_some_weather(self) -> None:
        for words in (
            *(("--pose", "nan", "1", "2"), ("--ground", "0", "inf", "0"), ("--time", "nan")),
            *(("--overcast", "5"), ("--rain", "-1"), ("--sun-elevation", "91"), ("--seed", "-1")),
        ):
            self.expect_refused("render_world", *words)
        for words in (
            *(("--overcast", "1"), ("--rain", "1"), ("--sun-elevation", "5"), ("--night",)),
        ):
            self.expect_refused("render_world", "--random-conditions", *words, said="excludes")
        self.expect_refused("render_world", "--night", "--sun-elevation", "5", said="excludes")

    def test_scenes_are_measured_without_a_folder(self) -> None:
        self.expect_refused("measure_scenes", "--scenes", "-1")
        self.assertEqual(self.run_tool("measure_scenes", "--scenes", "0").returncode, 0)
        self.assertEqual(list(self.folder.iterdir()), [])
        (self.folder / "file").touch()
        words = ("--scenes", "0", "--pictures", "1", "--out", "file/scenes")
        self.expect_refused("measure_scenes", *words, said="found no way to create this folder")


if __name__ == "__main__":
    unittest.main()
