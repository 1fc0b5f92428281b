"""Tests the native library: sampler, network and solvers."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest.mock import patch

import onnx
import torch

from tests.training.synthetic import SyntheticStream
from training import native as native_library
from training import sampler_process
from training.built_file import built_file
from training.data import Batch, view_table
from training.errors import TrainingError
from training.evaluate import float_inference
from training.export_onnx import build_model
from training.graph import folded_convolutions
from training.models import PRESETS, BevNetwork
from training.models.config import network_config
from training.onnx_graph import FloatOnnxBackend
from training.runtime import NativeNetwork, NativeSolver
from training.solver import Solution, standardise
from training.synthetic_scene import features_under

LEAVES_A_SAMPLER_OPEN = """
from training.data import SamplerStream
SamplerStream(1_000_000, 0, 2, 0.0)
"""


def native(net: BevNetwork) -> NativeNetwork:
    """The float network on the daemon's executor."""
    model = build_model(net, folded_convolutions(net), FloatOnnxBackend())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "untrained.onnx"
        onnx.save(model, str(path))
        return NativeNetwork(path)


class Sampler(unittest.TestCase):
    def test_the_program_exits_cleanly_with_an_open_sampler(self):
        ended = subprocess.run([sys.executable, "-c", LEAVES_A_SAMPLER_OPEN], timeout=240)
        self.assertEqual(ended.returncode, 0)


class BuiltFiles(unittest.TestCase):
    """Which build a command uses without a variable that names one."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def build(self, name: str, time_s: int) -> Path:
        path = self.root / "build" / name
        path.parent.mkdir(parents=True)
        path.touch()
        os.utime(path, (time_s, time_s))
        return path

    def test_release_comes_first_and_then_the_newest(self):
        self.assertIsNone(built_file(self.root / "build", "bin/program"))
        debug = self.build("debug/bin/program", 100)
        for preset, time_s, found in (("asan", 9, debug), ("tsan", 200, 0), ("release", 9, 0)):
            built = self.build(f"{preset}/bin/program", time_s)
            self.assertEqual(built_file(self.root / "build", "bin/program"), found or built)

    def test_a_build_without_presets_is_found(self):
        built = self.build("bin/program", 100)
        self.assertEqual(built_file(self.root / "build", "bin/program"), built)

    def test_programs_and_library_are_those_of_release(self):
        names = ("bin/bevloc_sampler", "training/native/libbevloc_training.so")
        for preset, time_s in (("debug", 200), ("release", 100)):
            program, library = (self.build(f"{preset}/{name}", time_s) for name in names)
        build = self.root / "build"
        with patch.object(sampler_process, "_ROOT", self.root), patch.dict(os.environ), \
                patch.object(native_library, "_BUILD", build):
            for variable in (sampler_process.ENVIRONMENT, native_library.ENVIRONMENT):
                os.environ.pop(variable, None)
            self.assertEqual(sampler_process.sampler_program(), program)
            self.assertEqual(native_library.library_path(), library)


class RunTime(unittest.TestCase):
    net: BevNetwork
    network: NativeNetwork

    @classmethod
    def setUpClass(cls):
        torch.set_num_threads(1)
        torch.manual_seed(1)
        cls.net = BevNetwork(PRESETS["nano"]).eval()
        cls.network = native(cls.net)

    def test_a_missing_model_is_refused_with_its_name(self):
        with self.assertRaisesRegex(TrainingError, "absent.onnx"):
            NativeNetwork(Path("absent.onnx"))

    def test_an_unknown_solver_is_refused(self):
        with self.assertRaisesRegex(TrainingError, "magic"):
            NativeSolver(self.network, "magic")

    @torch.no_grad()
    def test_the_network_computes_what_pytorch_computes(self):
        batch = SyntheticStream(0).next(2)
        batch.camera_mask[1] = 0b101101
        tables = [view_table(int(mask)) for mask in batch.camera_mask]
        batch.index = torch.stack([index for index, _ in tables])
        batch.weight = torch.stack([weight for _, weight in tables])
        self.check(self.network, self.net, batch)

    @torch.no_grad()
    def test_each_sample_is_seen_through_its_own_view_table(self):
        batch = SyntheticStream(0).next(1)
        index, weight = view_table(int(batch.camera_mask[0]))
        batch.index, batch.weight = index[None].roll(7, -1), weight[None].roll(7, -1)
        self.check(self.network, self.net, batch)

    @torch.no_grad()
    def test_a_larger_network_runs_too(self):
        net = BevNetwork(network_config("small", "lut")).eval()
        batch = SyntheticStream(0).next(1)
        index, weight = view_table(int(batch.camera_mask[0]))
        batch.index, batch.weight = index[None], weight[None]
        self.check(native(net), net, batch)

    def check(self, network: NativeNetwork, net: BevNetwork, batch: Batch) -> None:
        for found, expected in zip(network(batch), float_inference(net)(batch)):
            error = (found - expected).abs().amax() / expected.abs().amax()
            self.assertLess(error.item(), 1e-4)

    @torch.no_grad()
    def test_the_block_solver_agrees_with_the_joint_volume(self):
        bev, features_map = features_under(torch.tensor([0.5, -0.3, 0.01]), 1, channels=16)
        sides = standardise(bev), standardise(features_map)
        expected = Solution.of(self.net.solvers.joint(*sides))
        found = NativeSolver(self.network, "block")(bev, features_map)
        torch.testing.assert_close(found.estimate, expected.estimate, rtol=0, atol=1e-4)
        for a, b in zip(found.posterior.axes(), expected.posterior.axes()):
            torch.testing.assert_close(a, b, rtol=0, atol=1e-4)


if __name__ == "__main__":
    unittest.main()
