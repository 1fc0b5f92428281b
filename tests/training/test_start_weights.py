"""Tests the weights that a new run starts with."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path
from typing import Any
from unittest.mock import patch

import onnx
import torch
from onnx import helper
from torch import Tensor

from tests.training.synthetic import SyntheticStream
from tests.training.untrained import untrained_network
from training import bundle
from training.checkpoint import read_checkpoint
from training.config import TrainingConfig
from training.data import Batch
from training.errors import CheckpointError
from training.export_onnx import build_model, rig_statements
from training.graph import folded_convolutions
from training.model import real_images, real_raster
from training.models.config import PRESETS, network_config
from training.models.layers import ConvBn, running_statistics
from training.models.network import BevNetwork
from training.onnx_graph import FloatOnnxBackend
from training.rig_ranges import RANGE_KEYS, stored_ranges
from training.sampler_process import DriveFacts
from training.start_weights import start_with
from training.train import Trainer


def outputs(net: BevNetwork, batch: Batch) -> tuple[Tensor, ...]:
    with torch.no_grad():
        return net(
            real_images(batch.images), batch.index, batch.weight, real_raster(batch.raster_prior)
        )


def properties_of(model: onnx.ModelProto) -> dict[str, str]:
    return {entry.key: entry.value for entry in model.metadata_props}


def largest(tensor: Tensor) -> float:
    return tensor.abs().max().item()


class ModelFile(unittest.TestCase):
    def setUp(self) -> None:
        torch.set_num_threads(1)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "nano_float.onnx"
        self.trained = untrained_network()
        with torch.no_grad():
            for index, scale in enumerate(self.trained.solvers.log_scale.values()):
                scale.fill_(1.0 + 0.5 * index)
        convolutions = folded_convolutions(self.trained)
        onnx.save(build_model(self.trained, convolutions, FloatOnnxBackend()), str(self.file))
        self.batch = SyntheticStream(0).next(2)

    def start(self) -> BevNetwork:
        net = BevNetwork(PRESETS["nano"])
        start_with(net, self.file, lambda: [self.batch])
        return net

    def test_a_run_starts_with_the_network_of_a_float_model_file(self):
        net = self.start().eval()
        for found, wanted in zip(outputs(net, self.batch), outputs(self.trained, self.batch)):
            torch.testing.assert_close(found, wanted, rtol=1e-3, atol=1e-3 * largest(wanted))
        for name, scale in self.trained.solvers.log_scale.items():
            self.assertAlmostEqual(net.solvers.log_scale[name].item(), scale.item(), places=4)

    def test_training_begins_with_the_same_outputs(self):
        """A batch normalisation in training uses the statistics of its batch, so those of the file
        must have been measured."""
        net = self.start()
        stem = net.get_submodule("trunk.stem")
        assert isinstance(stem, ConvBn)
        _, variance = running_statistics(stem.bn)
        self.assertGreater((variance - 1.0).abs().max().item(), 1e-3)
        before = outputs(net.eval(), self.batch)[0]
        torch.testing.assert_close(
            outputs(net.train(), self.batch)[0], before, rtol=0.02, atol=0.02 * largest(before)
        )

    def rename(self, network: str) -> None:
        """Lets the file say that it holds this network."""
        model = onnx.load(str(self.file))
        helper.set_model_props(model, {**properties_of(model), "bevloc.model": network})
        onnx.save(model, str(self.file))

    def test_a_file_with_another_view_transform_is_refused(self):
        """The networks differ in parts that a model file does not hold, so all its weights fit."""
        for view in ("kernel", "dense"):
            net = BevNetwork(network_config("nano", view))
            message = f"holds the network 'nano', wanted '{net.config.name}'"
            with self.assertRaisesRegex(CheckpointError, message):
                start_with(net, self.file, lambda: [])

    def test_other_files_are_refused_with_what_is_wrong(self):
        self.rename("small")
        with self.assertRaisesRegex(CheckpointError, "trunk.stem.weight: found .*, wanted float32"):
            start_with(BevNetwork(PRESETS["small"]), self.file, lambda: [])
        self.file.write_bytes(b"no model")
        with self.assertRaisesRegex(CheckpointError, "unreadable as a model"):
            self.start()


class Rigs(unittest.TestCase):
    """The cameras that a model of a run states, which starts with the weights of another run."""

    def setUp(self) -> None:
        torch.set_num_threads(1)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        few = [SyntheticStream(0).next(1)]
        for module in ("bundle", "train"):
            patched = patch(f"training.{module}.measuring_batches", return_value=few)
            patched.start()
            self.addCleanup(patched.stop)

    def run_of(self, name: str, **options: Any) -> Path:
        """The checkpoint of a run that has not trained yet."""
        config = TrainingConfig(run=self.folder / name, samples=8, precision="float32", **options)
        run = Trainer(config, lambda _, first, share: SyntheticStream(first, share), [])
        run.save()
        return run.checkpoint_path

    def model_file(self, focal_px: str, height_m: str) -> str:
        net, path = untrained_network(), self.folder / "start.onnx"
        rig = rig_statements() | dict(zip(RANGE_KEYS, (focal_px, height_m)))
        model = build_model(net, folded_convolutions(net), FloatOnnxBackend(), rig=rig)
        onnx.save(model, str(path))
        return str(path)

    def stated(self, checkpoint: Path) -> list[str | None]:
        """The ranges of focal lengths and heights that a model of the checkpoint states."""
        config = read_checkpoint(checkpoint)["config"]
        statements = rig_statements(config["nuisances"], stored=stored_ranges(config))
        return [statements.get(key) for key in RANGE_KEYS]

    def test_a_run_states_those_of_the_model_file_too(self):
        start = self.model_file("150 420", "1.2 3.2")
        usual = self.run_of("usual", init=start, nuisances="usual")
        self.assertEqual(self.stated(usual), ["150 420", "1.2 3.2"])
        street = self.run_of("street", init=start)
        self.assertEqual(self.stated(street), ["150 420", "0.6 3.2"])
        self.assertEqual(self.stated(self.run_of("new", nuisances="usual")), [None, None])

    def test_a_run_states_those_of_the_checkpoint_and_of_its_start_too(self):
        first = self.run_of("first", init=self.model_file("150 420", "1.2 3.2"), nuisances="usual")
        second = self.run_of("second", init=str(first), nuisances="strong")
        self.assertEqual(self.stated(second), ["150 420", "1.2 3.2"])
        street = self.run_of("street")
        self.assertEqual(self.stated(self.run_of("usual", init=str(street), nuisances="usual")),
                         ["160 343", "0.6 2.6"])

    def test_a_run_states_those_of_the_drives_of_its_start(self):
        facts = DriveFacts({}, (200.0, 600.0), (1.2, 3.2))
        with patch("training.sampler_process.Drives.facts", return_value=facts):
            truck = self.run_of("truck", recordings="truck", map="m", nuisances="usual")
        car = self.run_of("car", init=str(truck), nuisances="usual")
        self.assertEqual(self.stated(car), ["161.8 630", "1.143 3.36"])

    def test_a_resumed_run_keeps_them(self):
        start = self.model_file("150 420", "1.2 3.2")
        self.run_of("run", init=start, nuisances="usual")
        # As in a bundle that continues a run.
        resumed = self.run_of("run", nuisances="usual", resume=True)
        self.assertEqual(self.stated(resumed), ["150 420", "1.2 3.2"])

    def test_a_bundle_brings_them_along(self):
        config = TrainingConfig(init=self.model_file("150 420", "1.2 3.2"), nuisances="usual")
        out = self.folder / "start.pt"
        bundle.write_start_weights(config, out)
        self.assertEqual(self.stated(out), ["150 420", "1.2 3.2"])


if __name__ == "__main__":
    unittest.main()
