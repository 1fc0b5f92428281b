"""Tests that onnxruntime computes what the daemon's executor computes. Skipped unless
script/check-onnxruntime has installed onnxruntime."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

import numpy as np
import onnx
import torch

from tests.training.onnxruntime_check import (
    LEVELS,
    REQUIRED_SHARE,
    agreements,
    compare,
    golden_samples,
    what_is_missing,
)
from tests.training.untrained import untrained_network
from training.export_onnx import build_model
from training.onnx_graph import Int8OnnxBackend
from training.quantize import quantize

MODELS = Path(__file__).resolve().parent.parent.parent / "models"


class Comparison(unittest.TestCase):
    def test_differences_are_counted_in_steps_of_the_largest_value(self):
        expected = np.array([-12.7, 1.0, 2.0, 3.0], np.float32)
        found = expected + np.array([0.0, 0.05, 0.09, 0.3], np.float32)
        agreement = compare(found, expected)
        self.assertEqual(agreement.share_within_one, 0.75)
        self.assertEqual(agreement.share_equal, 0.25)
        self.assertAlmostEqual(agreement.worst, 3.0, places=3)


@unittest.skipIf(what_is_missing(), what_is_missing())
class OnnxRuntime(unittest.TestCase):
    def check(self, model: str) -> None:
        for name, found in agreements(MODELS / model, [golden_samples()], "all").items():
            self.assertGreaterEqual(found.share_within_one, REQUIRED_SHARE, name)

    def test_the_shipped_model_gives_the_same_values(self):
        self.check("nano.onnx")

    def test_the_larger_model_gives_the_same_values(self):
        self.check("small-lut.onnx")

    def test_the_float_model_gives_the_same_values(self):
        self.check("nano_float.onnx")

    @torch.no_grad()
    def test_a_model_gives_the_same_values_in_integers_and_in_floats(self):
        net, batch = untrained_network(), golden_samples()
        quantization = quantize(net, [batch])
        model = build_model(net, quantization.convolutions, Int8OnnxBackend(quantization))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "untrained.onnx"
            onnx.save(model, str(path))
            for level in LEVELS:
                for name, found in agreements(path, [batch], level).items():
                    self.assertEqual(found.share_equal, 1.0, f"{level}: {name}")


if __name__ == "__main__":
    unittest.main()
