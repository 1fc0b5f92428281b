"""Tests the average of two networks."""

from __future__ import annotations

import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import onnx
import torch

from training import blend
from training.checkpoint import load_network, nuisances_of, read_checkpoint
from training.errors import CheckpointError, TrainingError
from training.export_onnx import build_model, rig_statements
from training.graph import folded_convolutions
from training.models import PRESETS, BevNetwork
from training.models.config import ModelConfig, network_config
from training.onnx_graph import FloatOnnxBackend
from training.rig_ranges import RANGE_KEYS, stored_ranges

LAST = "head.second.weight"


def write_network(
    seed: int,
    path: Path,
    config: ModelConfig = PRESETS["nano"],
    rig: dict[str, str] | None = None,
) -> BevNetwork:
    torch.manual_seed(seed)
    net = BevNetwork(config).eval()
    model = build_model(net, folded_convolutions(net), FloatOnnxBackend(), rig=rig)
    onnx.save(model, str(path))
    return net


def ranges(focal_px: str, height_m: str) -> dict[str, str]:
    """Statements about the rigs of a training."""
    return rig_statements() | dict(zip(RANGE_KEYS, (focal_px, height_m)))


class Blend(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.files = [self.root / "first.onnx", self.root / "second.onnx"]
        self.networks = [write_network(seed, path) for seed, path in enumerate(self.files)]

    def run_program(self, share: str, *options: str, run: Path | None = None) -> Path:
        """Blends into the folder `run`, by default a new one. Returns the checkpoint."""
        run = run or Path(tempfile.mkdtemp(dir=self.root))
        arguments = ["blend", *map(str, self.files), "--share", share, "--run", str(run)]
        arguments += options
        with mock.patch("sys.argv", arguments), contextlib.redirect_stdout(io.StringIO()):
            blend.main()
        return run / "checkpoint.pt"

    def test_a_quarter_of_the_second_network(self) -> None:
        net = load_network(self.run_program("0.25"))
        first, second = (network.state_dict()[LAST] for network in self.networks)
        torch.testing.assert_close(net.state_dict()[LAST], 0.75 * first + 0.25 * second)

    def test_no_share_of_the_second_network_computes_the_first(self) -> None:
        net = load_network(self.run_program("0"))
        for name, (weight, bias) in weights_and_biases(net).items():
            expected = weights_and_biases(self.networks[0])[name]
            torch.testing.assert_close(weight, expected[0])
            torch.testing.assert_close(bias, expected[1])

    def test_another_network(self) -> None:
        config = network_config("small", "lut")
        networks = [write_network(seed, path, config) for seed, path in enumerate(self.files)]
        net = load_network(self.run_program("0.5", "--network", "small", "--view", "lut"))
        first, second = (network.state_dict()[LAST] for network in networks)
        torch.testing.assert_close(net.state_dict()[LAST], 0.5 * (first + second))

    def test_the_export_measures_on_street_samples(self) -> None:
        self.assertEqual(nuisances_of(self.run_program("0.5")), "street")

    def ranges_of_the_export(self) -> list[str | None]:
        """The ranges that a model of the checkpoint states."""
        path = self.run_program("0.5")
        config = read_checkpoint(path)["config"]
        statements = rig_statements(nuisances_of(path), stored=stored_ranges(config))
        return [statements.get(key) for key in RANGE_KEYS]

    def test_the_export_states_the_rigs_of_both_networks(self) -> None:
        self.assertEqual(self.ranges_of_the_export(), [None, None])
        write_network(1, self.files[1], rig=ranges("150 420", "1.2 3.2"))
        self.assertEqual(self.ranges_of_the_export(), ["150 420", "1.2 3.2"])
        write_network(0, self.files[0], rig=rig_statements("street"))
        self.assertEqual(self.ranges_of_the_export(), ["150 420", "0.6 3.2"])

    def test_refuses_a_model_without_proper_ranges(self) -> None:
        half = {key: text for key, text in ranges("150 420", "").items() if text}
        for rig in (half, ranges("150 420", "2"), ranges("150", "x y")):
            write_network(1, self.files[1], rig=rig)
            with self.assertRaisesRegex(CheckpointError, "second.onnx: found '150.*wanted two num"):
                self.run_program("0.5")

    def test_another_run_is_not_replaced(self) -> None:
        run = self.root / "run"
        checkpoint = self.run_program("0.25", run=run)
        self.assertEqual(list(run.iterdir()), [checkpoint])
        content = checkpoint.read_bytes()
        message = f"{checkpoint}: found a run, wanted another folder for --run"
        with self.assertRaisesRegex(TrainingError, message):
            self.run_program("0.5", run=run)
        self.assertEqual(checkpoint.read_bytes(), content)

    def test_refuses_a_share_beyond_1(self) -> None:
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as errors:
            self.run_program("1.5")
        self.assertIn("--share: found 1.5, wanted 0 to 1", errors.getvalue())

    def test_refuses_an_unknown_network(self) -> None:
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as errors:
            self.run_program("0.5", "--network", "tiny")
        self.assertIn("'tiny'", errors.getvalue())


def weights_and_biases(net: BevNetwork) -> dict[str, tuple[torch.Tensor, torch.Tensor]]:
    return {name: (c.weight, c.bias) for name, c in folded_convolutions(net).items()}


if __name__ == "__main__":
    unittest.main()
