"""Tests compact checkpoints."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

import torch
from torch import Tensor

from tests.training.synthetic import SyntheticStream
from training.checkpoint import read_checkpoint
from training.compact import pack, unpack
from training.config import TrainingConfig
from training.models.config import network_config
from training.models.network import BevNetwork
from training.train import Trainer

LIMIT_BYTES = 16 * 2**20


def adam_of(network: BevNetwork) -> torch.optim.AdamW:
    """An optimiser that has made a step with random gradients of many sizes."""
    optimiser = torch.optim.AdamW(network.parameters())
    generator = torch.Generator().manual_seed(2)
    for parameter in network.parameters():
        size = 10 ** (-4 * torch.rand(parameter.shape, generator=generator))
        parameter.grad = size * torch.randn(parameter.shape, generator=generator)
    optimiser.step()
    return optimiser


def state_of(network: BevNetwork) -> dict:
    weights = network.state_dict()
    average = {name: 0.5 * value for name, value in weights.items()}
    optimiser = adam_of(network).state_dict()
    return {"model": weights, "ema": average, "optimiser": optimiser, "samples": 8, "config": {}}


class Compact(unittest.TestCase):
    state: dict

    @classmethod
    def setUpClass(cls):
        torch.manual_seed(1)
        cls.state = state_of(BevNetwork(network_config("small", "lut")))

    def test_a_checkpoint_of_small_is_returned(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "checkpoint.pt"
            torch.save(pack(self.state), path)
            self.assertLess(path.stat().st_size, LIMIT_BYTES)
            self.assertEqual(read_checkpoint(path).keys(), self.state.keys())

    def assert_near(self, found: Tensor, wanted: Tensor) -> None:
        if wanted.ndim <= 1:
            self.assertTrue(torch.equal(found, wanted))
            return
        largest = wanted.abs().max().item()
        torch.testing.assert_close(found, wanted, rtol=6e-4, atol=1e-7 * largest)

    def test_weights_are_rounded_and_vectors_kept(self):
        found = unpack(pack(self.state))
        for part in ("model", "ema"):
            self.assertEqual(found[part].keys(), self.state[part].keys())
            for name, wanted in self.state[part].items():
                self.assert_near(found[part][name], wanted)

    def test_squares_keep_their_size_and_means_start_anew(self):
        found = unpack(pack(self.state))["optimiser"]["state"]
        for key, wanted in self.state["optimiser"]["state"].items():
            squares = wanted["exp_avg_sq"]
            if squares.ndim > 1:
                ratio = found[key]["exp_avg_sq"] / squares.clamp(min=2.0**-58)
                self.assertLess(torch.log2(ratio).abs().max().item(), 0.13)
                self.assertEqual(found[key]["exp_avg"].abs().max().item(), 0.0)
            else:
                self.assertTrue(torch.equal(found[key]["exp_avg"], wanted["exp_avg"]))

    def test_other_checkpoints_stay_as_they_are(self):
        self.assertIs(unpack(self.state), self.state)


class Resumption(unittest.TestCase):
    def trainer(self, run: Path, compact: bool) -> Trainer:
        # bfloat16 would round by more than the checkpoint does.
        config = TrainingConfig(
            run=run, samples=64, batch=2, resume=True, compact=compact, semantic_stage=0.0,
            precision="float32",
        )
        return Trainer(config, lambda _, first, share: SyntheticStream(first, share), [])

    def test_a_run_goes_on_from_a_compact_checkpoint(self):
        torch.set_num_threads(1)
        losses = {}
        for compact in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                first = self.trainer(Path(folder), compact)
                for _ in range(2):
                    first.train_step(0.1)
                first.save()
                second = self.trainer(Path(folder), compact)
                self.assertEqual((second.step, second.samples), (2, 4))
                losses[compact] = second.train_step(0.1)[0]
        torch.testing.assert_close(losses[True], losses[False], rtol=0.01, atol=1e-3)
        self.assertFalse(torch.equal(losses[True], losses[False]))


if __name__ == "__main__":
    unittest.main()
