"""Tests the report of the cost of quantization, on an untrained network."""

from __future__ import annotations

import math
import unittest
from pathlib import Path

import torch

from tests.training.synthetic import SyntheticStream
from tests.training.untrained import untrained_network
from training.layer_errors import LayerError, layer_errors
from training.quantization_report import (
    BEGIN,
    layer_table,
    pose_table,
)
from training.quantize import Quantization, quantize

# A layer of the image branch, whose scale the tests make too small, and one of the map branch.
SPOILT, OF_THE_MAP = "trunk.stage8.1.first", "map_encoder.layers.1"

EXACT = torch.tensor([[1.0, 2.0, 3.0]] * 2)
DOCUMENT = Path(__file__).resolve().parents[2] / "docs/quantization.md"


def titles(tables: str) -> list[str]:
    """The first column of a Markdown table."""
    return [line.split("|")[1].strip() for line in tables.splitlines() if line.startswith("|")]


class LayerErrors(unittest.TestCase):
    before: dict[str, LayerError]
    after: dict[str, LayerError]
    quantization: Quantization

    @classmethod
    def setUpClass(cls):
        torch.set_num_threads(1)
        net, batches = untrained_network(), [SyntheticStream(3).next(1)]
        quantization = quantize(net, batches)
        cls.before = {e.name: e for e in layer_errors(net, quantization, batches)}
        quantization.activations[SPOILT].scale /= 16
        cls.after = {e.name: e for e in layer_errors(net, quantization, batches)}
        cls.quantization = quantization

    def test_every_layer_is_reported(self):
        self.assertEqual(set(self.before), {"view", *self.quantization.convolutions})

    def test_a_layer_has_no_effect_on_the_other_branch(self):
        self.assertTrue(math.isinf(self.before[SPOILT].map_db))
        self.assertFalse(math.isinf(self.before[SPOILT].bev_db))
        self.assertTrue(math.isinf(self.before[OF_THE_MAP].bev_db))
        self.assertFalse(math.isinf(self.before[OF_THE_MAP].map_db))

    def test_the_error_of_a_last_layer_is_its_effect_on_the_features(self):
        bev, of_map = (self.before[f"{side}_compress.3.second"] for side in ("bev", "map"))
        self.assertAlmostEqual(bev.alone_db, bev.bev_db, places=3)
        self.assertAlmostEqual(of_map.alone_db, of_map.map_db, places=3)
        self.assertIsNone(bev.step)
        self.assertIsNone(of_map.step)

    def test_noise_adds_up(self):
        last = self.before["bev_compress.3.second"]
        self.assertLess(last.together_db, last.alone_db)

    def test_a_scale_that_is_too_small_shows_as_saturation_and_noise(self):
        before, after = self.before[SPOILT], self.after[SPOILT]
        assert before.saturated is not None and after.saturated is not None
        self.assertLess(before.saturated, 0.01)
        self.assertGreater(after.saturated, before.saturated + 0.1)
        for kind in ("alone_db", "together_db", "bev_db"):
            self.assertLess(getattr(after, kind), getattr(before, kind) - 5, kind)
        self.assertEqual(after.largest_output, before.largest_output)
        untouched = self.after["trunk.stem"]
        self.assertEqual(untouched, self.before["trunk.stem"])


class Document(unittest.TestCase):
    def test_a_layer_is_a_row(self):
        layer = LayerError("view", None, 1.5, 0.01, 0.0005, 40.04, 20.0, 30.0, math.inf)
        self.assertEqual(
            layer_table([layer]).splitlines()[-1],
            "| `view` |  | 1.50 | 0.0100 | 0.050 | 40.0 | 20.0 | 30.0 | exact |",
        )

    def test_the_pose_table_pairs_the_samples(self):
        rows = pose_table(EXACT, EXACT + torch.tensor([0.5, 0.0, -1.0])).splitlines()
        self.assertEqual(rows[2], "| block, x (m) | 1.0000 | 1.5000 | +0.5000 ± 0.0000 |")
        self.assertEqual(len(rows), 5)

    def test_the_document_has_the_rows_that_the_program_writes(self):
        text = DOCUMENT.read_text(encoding="utf-8")
        poses = text.partition(BEGIN)[2].partition("\nLayers, ")[0]
        self.assertEqual(titles(poses), titles(pose_table(EXACT, EXACT)))


if __name__ == "__main__":
    unittest.main()
