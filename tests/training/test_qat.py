"""Tests quantization-aware training, on an untrained network and synthetic samples."""

from __future__ import annotations

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest.mock import patch

import torch

from tests.training.synthetic import SyntheticStream, gradient_of
from tests.training.untrained import untrained_network
from training import quantization_report
from training.checkpoint import load_network, state_of_weights
from training.config import CALIBRATION_SEEDS, FIRST_TRAINING_SEED, QAT_SEEDS, USUAL_SEEDS
from training.data import Batch, SamplerStream
from training.errors import NotFiniteError, TrainingError
from training.export_onnx import quantization_of
from training.fake_quantization import FakeQuantized
from training.graph import folded_convolutions
from training.qat import SEED, fine_tune, fine_tuning_loss, main, save
from training.quantize import int8_inference, quantize


class SameBatch:
    """A stream that repeats one batch."""

    def __init__(self, batch: Batch) -> None:
        self.batch = batch

    def next(self, count: int) -> Batch:
        return self.batch

    def close(self) -> None:
        pass


class QuantizationAwareTraining(unittest.TestCase):
    def setUp(self):
        torch.set_num_threads(1)
        self.net, self.batch = untrained_network(), SyntheticStream(3).next(1)
        self.quantization = quantize(self.net, [self.batch])

    def coarse(self) -> FakeQuantized:
        """A network whose weights have only about four bits."""
        for conv in self.quantization.quantized.values():
            conv.scale = 8 * conv.scale
        return FakeQuantized(self.net, self.quantization)

    @torch.no_grad()
    def loss(self, network: FakeQuantized) -> float:
        return fine_tuning_loss(network(self.batch), self.net.solvers, self.batch).item()

    def test_equals_the_int8_network(self):
        expected = int8_inference(self.net, self.quantization)(self.batch)
        found = FakeQuantized(self.net, self.quantization)(self.batch)
        for a, b in zip(found, expected):
            self.assertTrue(torch.equal(a.detach(), b))

    def test_all_weights_except_clipped_ones_have_a_gradient(self):
        for quantized in self.quantization.quantized.values():
            quantized.scale = 0.5 * quantized.scale
        network = FakeQuantized(self.net, self.quantization)
        torch.stack([output.square().mean() for output in network(self.batch)]).sum().backward()
        for name, conv in network.convolutions.items():
            limit = 63 * self.quantization.quantized[name].scale[:, None, None, None]
            clipped = conv.weight.abs() > limit
            self.assertTrue(clipped.any(), name)
            self.assertFalse(gradient_of(conv.weight)[clipped].any(), name)
            self.assertTrue(gradient_of(conv.weight).any(), name)
            self.assertTrue(gradient_of(conv.bias).any(), name)

    def test_a_few_steps_lower_the_loss_of_a_coarse_quantization(self):
        network = self.coarse()
        before = self.loss(network)
        fine_tune(network, SameBatch(self.batch), steps=6, batch_size=1, rate=1e-3)
        self.assertLess(self.loss(network), before - 0.1)

    def test_the_export_equals_the_trained_network(self):
        network = self.coarse()
        fine_tune(network, SameBatch(self.batch), steps=1, batch_size=1, rate=1e-3)
        trained = [output.detach() for output in network(self.batch)]
        with tempfile.TemporaryDirectory() as folder:
            first, path = Path(folder) / "first.pt", Path(folder) / "run/checkpoint.pt"
            weights = self.net.state_dict()
            state = {"model": weights, "ema": weights, "samples": 100, "config": {}}
            torch.save(state, first)
            save(network, first, 8, path)
            net = load_network(path)
            self.assertEqual(torch.load(path)["samples"], 108)
            quantization = quantization_of(net, path, [])
        for name, conv in folded_convolutions(net).items():
            learned = network.convolutions[name]
            torch.testing.assert_close(conv.weight, learned.weight.detach(), rtol=1e-6, atol=0)
            torch.testing.assert_close(conv.bias, learned.bias.detach(), rtol=1e-6, atol=0)
        for a, b in zip(int8_inference(net, quantization)(self.batch), trained):
            self.assertTrue(torch.equal(a, b))

    def test_a_nan_loss_ends_the_run(self):
        network = FakeQuantized(self.net, self.quantization)
        network.convolutions["bev_compress.3.second"].bias.data[0] = float("nan")
        with self.assertRaisesRegex(NotFiniteError, "step 0"):
            fine_tune(network, SameBatch(self.batch), steps=2, batch_size=1, rate=1e-3)


class Program(unittest.TestCase):
    def run_main(self, *arguments: str) -> None:
        said = io.StringIO()
        with patch.object(sys, "argv", ["qat", *arguments]), contextlib.redirect_stdout(said):
            main()

    def test_has_seeds_of_its_own(self):
        parts = sorted((0, USUAL_SEEDS, CALIBRATION_SEEDS, QAT_SEEDS, SamplerStream.SEED_STRIDE))
        self.assertGreaterEqual(min(b - a for a, b in zip(parts, parts[1:])), 2**26)
        self.assertEqual(SEED, FIRST_TRAINING_SEED + QAT_SEEDS)

    def test_trains_with_the_nuisances_of_the_checkpoint(self):
        batch = SyntheticStream(3).next(1)
        weights = untrained_network().state_dict()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "checkpoint.pt"
            torch.save(state_of_weights(weights, {"nuisances": "strong"}), path)
            with patch("training.qat.calibration_batches", return_value=[batch]) as calibration, \
                    patch("training.qat.SamplerStream", return_value=SameBatch(batch)) as stream:
                self.run_main(str(path), "--run", f"{folder}/qat", "--samples=1", "--batch=1")
        self.assertEqual(calibration.call_args.args[2], "strong")
        self.assertEqual(stream.call_args.kwargs["nuisances"], "strong")

    def test_refuses_runs_on_real_data(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "checkpoint.pt"
            for option, name in (("recordings", "recorded drives"), ("nuscenes", "nuScenes")):
                torch.save(state_of_weights({}, {option: "mine"}), path)
                message = f"{path}: found a run on {name} .mine., wanted one on the simulator"
                with self.assertRaisesRegex(TrainingError, message):
                    self.run_main(str(path), "--run", folder)
                with self.assertRaisesRegex(TrainingError, message):
                    with patch.object(sys, "argv", ["report", str(path)]):
                        quantization_report.main()

    def test_another_run_is_not_replaced(self):
        weights = untrained_network().state_dict()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "checkpoint.pt"
            torch.save(state_of_weights(weights, {}), path)
            content = path.read_bytes()
            with patch("training.qat.calibration_batches") as rendered:
                message = f"{path}: found a run, wanted another folder for --run"
                with self.assertRaisesRegex(TrainingError, message):
                    self.run_main(str(path), "--run", folder)
            rendered.assert_not_called()
            self.assertEqual(path.read_bytes(), content)

    def test_refuses_less_than_a_batch(self):
        said = io.StringIO()
        with self.assertRaises(SystemExit) as ended, contextlib.redirect_stderr(said):
            self.run_main("none.pt", "--run", "none", "--samples=7")
        self.assertEqual(ended.exception.code, 2)
        self.assertIn("--samples: found 7, wanted at least one batch of 8", said.getvalue())


if __name__ == "__main__":
    unittest.main()
