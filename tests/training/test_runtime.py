"""What training asks of the native library besides the joint volume."""

import subprocess
import sys
import unittest
from pathlib import Path

import torch

from tests.training.synthetic import SyntheticStream
from training.model import Nano
from training.runtime import NativeNetwork, NativeSolver
from training.solver import Solution, standardise
from training.synthetic_scene import features_under

FIXTURES = Path(__file__).resolve().parent.parent / "pipeline/network/fixtures"

LEAVES_A_SAMPLER_OPEN = """
from training.data import SamplerStream
SamplerStream(1_000_000, 0, 2, 0.0)
"""


class Sampler(unittest.TestCase):
    def test_an_open_sampler_does_not_break_the_exit(self):
        ended = subprocess.run([sys.executable, "-c", LEAVES_A_SAMPLER_OPEN], timeout=240)
        self.assertEqual(ended.returncode, 0)


class RunTime(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.network = NativeNetwork(FIXTURES / "tiny_network_int8.onnx")

    def test_a_missing_model_is_refused_with_its_name(self):
        with self.assertRaisesRegex(ValueError, "absent.onnx"):
            NativeNetwork(Path("absent.onnx"))

    def test_an_unknown_solver_is_refused(self):
        with self.assertRaisesRegex(ValueError, "magic"):
            NativeSolver(self.network, "magic")

    def test_every_sample_has_its_own_outputs(self):
        batch = SyntheticStream(0).next(2)
        bev, features_map, mask = self.network(batch)
        self.assertEqual(tuple(bev.shape), (2, 16, 100, 50))
        self.assertEqual(tuple(mask.shape), (2, 3, 400, 200))
        self.assertFalse(torch.equal(bev[0], bev[1]))
        self.assertFalse(torch.equal(features_map[0], features_map[1]))

    @torch.no_grad()
    def test_the_block_solver_agrees_with_the_joint_volume(self):
        bev, features_map = features_under(torch.tensor([0.5, -0.3, 0.01]), 1, channels=16)
        solvers = Nano().solvers
        solvers.log_scale["joint"].data.fill_(torch.tensor(150.5).log())  # of the fixture
        expected = Solution.of(solvers.joint(standardise(bev), standardise(features_map)))
        found = NativeSolver(self.network, "block")(bev, features_map)
        torch.testing.assert_close(found.estimate, expected.estimate, rtol=0, atol=1e-4)
        for a, b in zip(found.posterior.axes(), expected.posterior.axes()):
            torch.testing.assert_close(a, b, rtol=0, atol=1e-4)


if __name__ == "__main__":
    unittest.main()
