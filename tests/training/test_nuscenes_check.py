"""Tests training.nuscenes.check, which checks a nuScenes tree."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from PIL import Image

from tests.training.nuscenes_tree import VERSION, write_tree


class Check(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        write_tree(self.root)

    def check(self, *options: str) -> subprocess.CompletedProcess:
        command = [sys.executable, "-m", "training.nuscenes.check", str(self.root), *options]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)

    def test_a_good_tree_is_drawn(self):
        out = self.root / "sheets"
        done = self.check("--draw", "2", "--out", str(out))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("6 samples: none bad", done.stdout)
        self.assertEqual(len(list(out.iterdir())), 2)
        sheet = np.asarray(Image.open(out / "sample-0-0.png"))
        self.assertEqual(sheet.shape, (400, 2120, 3))
        images, raster = sheet[:384, :1920], sheet[:, 1920:]
        for colour in ((255, 160, 0), (60, 120, 255), (255, 40, 40)):
            self.assertGreater((images == colour).all(-1).sum(), 40)
            self.assertGreater((raster == colour).all(-1).sum(), 100)

    def test_a_bad_sample_is_named(self):
        (self.root / "samples/CAM_BACK/n015__CAM_BACK__0-1.jpg").unlink()
        done = self.check("--out", str(self.root / "sheets"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("6 samples: 1 bad (1 missing file)", done.stdout)
        self.assertRegex(done.stderr, "bad sample sample-0-1: .*0-1.jpg: found no such file")

    def test_a_bad_tree_is_refused_with_one_line(self):
        (self.root / VERSION / "scene.json").unlink()
        done = self.check()
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertRegex(done.stderr, "^.*scene.json: cannot be opened .*\n$")


if __name__ == "__main__":
    unittest.main()
