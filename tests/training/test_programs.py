"""Tests what programs say about wrong input: one line, before the work."""

from __future__ import annotations

import os
import sys
import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import torch

from tests.training.untrained import untrained_network
from tooling.errors import run_program
from training import bundle, evaluate, golden, picture_statistics, train
from training.checkpoint import state_of_weights
from training.export_onnx import QUANTIZATION_FILE, SOLVERS_FILE

RIG = Path(__file__).resolve().parents[2] / "config/rig_demo.yaml"


class Refusals(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def said(self, main: Callable[[], None], *arguments: str) -> str:
        """The message with which a program ends."""
        with patch.object(sys, "argv", ["program", *arguments]):
            with self.assertRaises(SystemExit) as ended:
                run_program(main)
        self.assertIsInstance(ended.exception.code, str)
        self.assertNotIn("\n", str(ended.exception.code))
        return str(ended.exception.code)

    def test_a_run_is_no_file(self) -> None:
        file = self.folder / "run"
        file.touch()
        with patch.dict(os.environ, train.MALLOC_ENVIRONMENT):
            with patch("training.train.validation_set", return_value=[]):
                said = self.said(train.main, "--samples", "8", "--run", str(file))
        self.assertIn(f"{file}: found no way to use it (File exists), wanted a usable", said)

    def test_evaluation_needs_the_model_before_it_renders(self) -> None:
        checkpoint = self.folder / "checkpoint.pt"
        torch.save(state_of_weights(untrained_network().state_dict(), {}), checkpoint)
        with patch("training.evaluate.simulator_batches") as rendered:
            said = self.said(evaluate.main, str(checkpoint), "--write", str(self.folder))
        self.assertIn(f"{self.folder / 'nano.onnx'}: ", said)
        rendered.assert_not_called()

    def test_golden_vectors_need_the_files_of_the_export(self) -> None:
        checkpoint = self.folder / "checkpoint.pt"
        for missing in (QUANTIZATION_FILE, SOLVERS_FILE):
            with patch("training.golden.write_solver_vectors") as written:
                said = self.said(golden.main, "--checkpoint", str(checkpoint))
            self.assertIn(f"{self.folder / missing}: no such file, wanted it; run", said)
            written.assert_not_called()
            (self.folder / missing).touch()

    def test_a_real_frame_has_a_picture(self) -> None:
        arguments = ("--real", str(self.folder), "--rig")
        with patch("training.picture_statistics.simulated") as rendered:
            said = self.said(picture_statistics.main, *arguments, str(RIG))
            self.assertIn(f"{self.folder}: found no picture of a camera of {RIG}", said)
            said = self.said(picture_statistics.main, *arguments, "/nowhere/rig.yaml")
            self.assertIn("/nowhere/rig.yaml: found no way to use it (No such file", said)
        rendered.assert_not_called()

    def test_a_bundle_needs_its_files_before_it_copies(self) -> None:
        out = self.folder / "bundle"
        arguments = ("--out", str(out), "--samples", "8")
        said = self.said(bundle.main, *arguments, "--photos", "/nowhere")
        self.assertIn("--photos: found no folder '/nowhere', wanted that of script/photos", said)
        said = self.said(bundle.main, *arguments, "--init", "/nowhere.pt")
        self.assertIn("--init: found no file '/nowhere.pt', wanted a checkpoint", said)
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
