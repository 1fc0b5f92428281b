"""Reads a recording with npm's @mcap/core, the reference reader of the format."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = Path(__file__).parent / "npm"


def install(folder: Path) -> None:
    """Installs the pinned packages; skips the test where that is impossible."""
    if not shutil.which("npm") or not shutil.which("node"):
        raise unittest.SkipTest("npm or node is not installed")
    for name in ("package.json", "read_all.js"):
        shutil.copy(PACKAGE / name, folder)
    command = ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=180)
    if done.returncode != 0:
        raise unittest.SkipTest(f"npm cannot install the reader: {done.stderr[-300:]}")


class NpmTest(unittest.TestCase):
    def test_the_reference_reader_reads_every_message(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            install(folder)
            program = os.environ["BEVLOCD_PROGRAM"]
            command = [program, "--config", "config/demo.yaml", "--fast", "--duration", "1.5"]
            command += ["--out", str(folder), "--record", str(folder / "ring")]
            subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
            files = sorted(str(file) for file in (folder / "ring").glob("*.mcap"))
            self.assertEqual(len(files), 1)
            read = ["node", "read_all.js", *files]
            done = subprocess.run(read, cwd=folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            log = (folder / "can.log").read_text().splitlines()
        (result,) = json.loads(done.stdout)
        topics = result["indexed"]["topics"]
        self.assertEqual(topics, result["stream"]["topics"])
        self.assertEqual(sum(topics.values()), result["indexed"]["total"])
        self.assertEqual(result["indexed"]["attachments"], 2)
        self.assertEqual(result["indexed"]["metadata"], 1)
        # The log of the drive ends before the sign-off, which is recorded.
        self.assertGreater(topics["/can/in"] + topics["/can/out"], len(log))
        self.assertGreater(topics["/camera/front"], 10)
        self.assertEqual(topics["/map"], 1)
        self.assertGreater(topics["/solution"], 100)


if __name__ == "__main__":
    unittest.main()
