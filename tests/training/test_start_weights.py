"""Tests the weights that a new run starts with."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

import onnx
import torch
from onnx import helper
from torch import Tensor

from tests.training.synthetic import SyntheticStream
from tests.training.untrained import untrained_network
from training.data import Batch
from training.errors import CheckpointError
from training.export_onnx import build_model
from training.graph import folded_convolutions
from training.model import real_images, real_raster
from training.models.config import PRESETS, network_config
from training.models.layers import ConvBn, running_statistics
from training.models.network import BevNetwork
from training.onnx_graph import FloatOnnxBackend
from training.start_weights import start_with


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


if __name__ == "__main__":
    unittest.main()
