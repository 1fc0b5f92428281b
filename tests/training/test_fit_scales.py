"""Scales that are fitted to finished features."""

from __future__ import annotations

import unittest
from types import SimpleNamespace

import torch
from torch import Tensor

from training.fit_scales import fit_scales, fit_sigma_scale
from training.losses import pose_losses
from training.solver import KINDS, PoseSolvers, Solution
from training.synthetic_scene import features_under

CORRECTIONS = torch.tensor([[0.5, -0.3, 0.01], [-1.2, 0.4, -0.02], [1.6, 0.1, 0.005]])


def batches(noise: float) -> list[SimpleNamespace]:
    """One noisy scene each."""
    result = []
    for seed, correction in enumerate(CORRECTIONS):
        bev, features_map = features_under(correction, seed, channels=4)
        generator = torch.Generator().manual_seed(seed)
        bev = bev + noise * torch.randn(bev.shape, generator=generator)
        result.append(SimpleNamespace(sides=(bev, features_map), correction=correction[None]))
    return result


def infer(batch: SimpleNamespace) -> tuple[Tensor, Tensor, None]:
    return *batch.sides, None


class FitScales(unittest.TestCase):
    @torch.no_grad()
    def loss(self, solvers: PoseSolvers, kind: str, samples: list[SimpleNamespace]) -> float:
        found = [solvers.solve(kind, *s.sides).posterior for s in samples]
        losses = [pose_losses(p, s.correction).sum() for p, s in zip(found, samples)]
        return torch.stack(losses).mean().item()

    def test_every_solver_gains_from_poor_scales(self):
        samples = batches(0.5)
        kinds = [k for k in KINDS if k in ("decoupled", "banded", "block", "decoupled+refine")]
        solvers = PoseSolvers()
        for scale in solvers.log_scale.values():
            scale.data.fill_(0.0)
        before = [self.loss(solvers, kind, samples) for kind in kinds]
        fit_scales(solvers, infer, 12 * samples)
        for kind, loss in zip(kinds, before):
            self.assertLess(self.loss(solvers, kind, samples), loss - 0.5, kind)

    def test_sigma_covers_what_a_gaussian_does(self):
        generator = torch.Generator().manual_seed(1)
        samples = []
        for _ in range(50):
            correction = torch.randn(8, 3, generator=generator)
            samples.append(SimpleNamespace(sides=(correction, correction), correction=correction))

        def solve(bev: Tensor, _: Tensor) -> Solution:
            error = torch.randn(bev.shape, generator=generator)
            return Solution(bev + 2.0 * error, torch.ones_like(bev), None)

        self.assertAlmostEqual(fit_sigma_scale(infer, solve, samples), 2.0, delta=0.1)


if __name__ == "__main__":
    unittest.main()
