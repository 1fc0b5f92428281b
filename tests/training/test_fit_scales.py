"""Tests the scales that are fitted to finished features."""

from __future__ import annotations

import unittest

import torch
from torch import Tensor

from training.data import Batch
from training.errors import TrainingError
from training.fit_scales import TYPICAL_SCORE, fit_scales, fit_score_scale, fit_sigma_scale
from training.losses import pose_losses
from training.runtime import NativeSolution
from training.solver import KINDS, Posterior, PoseSolvers, Solution
from training.synthetic_scene import features_under

CORRECTIONS = torch.tensor([[0.5, -0.3, 0.01], [-1.2, 0.4, -0.02], [1.6, 0.1, 0.005]])
NOTHING = torch.empty(0)


def features_batch(bev: Tensor, features_map: Tensor, correction: Tensor) -> Batch:
    """A batch that carries features in place of rasters."""
    return Batch(NOTHING, NOTHING, bev, features_map, correction, NOTHING, NOTHING)


def batches(noise: float) -> list[Batch]:
    """One noisy scene each."""
    result = []
    for seed, correction in enumerate(CORRECTIONS):
        bev, features_map = features_under(correction, seed, channels=4)
        generator = torch.Generator().manual_seed(seed)
        bev = bev + noise * torch.randn(bev.shape, generator=generator)
        result.append(features_batch(bev, features_map, correction[None]))
    return result


def infer(batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
    return batch.raster_prior, batch.raster_truth, NOTHING


class FitScales(unittest.TestCase):
    @torch.no_grad()
    def loss(self, solvers: PoseSolvers, kind: str, samples: list[Batch]) -> float:
        found = [solvers.solve(kind, *infer(s)[:2]).posterior for s in samples]
        losses = [pose_losses(p, s.correction).sum() for p, s in zip(found, samples)]
        return torch.stack(losses).mean().item()

    def test_fitting_improves_poor_scales_of_every_solver(self):
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
            samples.append(features_batch(correction, correction, correction))

        def solve(bev: Tensor, _: Tensor) -> Solution:
            error = torch.randn(bev.shape, generator=generator)
            unused = Posterior(NOTHING, NOTHING, NOTHING)
            return Solution(bev + 2.0 * error, torch.ones_like(bev), unused)

        self.assertAlmostEqual(fit_sigma_scale(infer, solve, samples), 2.0, delta=0.1)

    def test_matches_of_the_right_place_have_the_typical_score(self):
        truth = torch.zeros(4, 3)
        found = torch.tensor([[0.2, 0.1, 0.0], [0.9, 0.2, 0.1], [0.2, 0.4, 0.0], [1.2, 0.1, 0.0]])
        unused = Posterior(NOTHING, NOTHING, NOTHING)
        scores = torch.tensor([0.1, 0.3, 0.9, 0.8])
        solution = NativeSolution(found, torch.ones_like(found), unused, scores)
        scale = fit_score_scale(
            infer, lambda *_: solution, [features_batch(truth, truth, truth)]
        )
        self.assertAlmostEqual(scale, TYPICAL_SCORE / 0.2, places=5)

    def fitted_score(self, error_m: float, score: float) -> float:
        """The factor for four matches that are `error_m` off along the road."""
        truth, found = torch.zeros(4, 3), torch.zeros(4, 3)
        found[:, 0] = error_m
        unused = Posterior(NOTHING, NOTHING, NOTHING)
        solution = NativeSolution(found, torch.ones_like(found), unused, torch.full((4,), score))
        return fit_score_scale(infer, lambda *_: solution, [features_batch(truth, truth, truth)])

    def test_a_score_factor_that_the_daemon_would_refuse_is_an_error(self):
        with self.assertRaisesRegex(TrainingError, "factor of the score: found nan, wanted 0.1 to"):
            self.fitted_score(error_m=2.0, score=0.3)
        for score in (0.0, 0.01, 4.0):
            with self.assertRaisesRegex(TrainingError, "factor of the score: found .*, wanted 0.1"):
                self.fitted_score(error_m=0.0, score=score)
        self.assertAlmostEqual(self.fitted_score(error_m=0.0, score=0.32), 1.0, places=5)

    def test_a_sigma_factor_that_the_daemon_would_refuse_is_an_error(self):
        truth = torch.full((4, 3), 50.0)
        unused = Posterior(NOTHING, NOTHING, NOTHING)
        solution = Solution(torch.zeros(4, 3), torch.ones(4, 3), unused)
        with self.assertRaisesRegex(TrainingError, "factor of the sigma: found 50, wanted 0.1 to"):
            fit_sigma_scale(infer, lambda *_: solution, [features_batch(truth, truth, truth)])


if __name__ == "__main__":
    unittest.main()
