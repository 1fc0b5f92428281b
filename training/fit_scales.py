"""Fits the solvers' scales to the finished (quantized) features. Training learns some of the scales
with the float network, and none for the solvers that are not part of its loss."""

from __future__ import annotations

import torch
from torch import Tensor

from training.data import Batch
from training.evaluate import Inference, Solver
from training.losses import pose_losses
from training.solver import Posterior, PoseSolvers, estimate, standardise

RATE, FINAL_RATE = 0.2, 0.02
ROUNDS = 3


def _posteriors(solvers: PoseSolvers, bev: Tensor, features_map: Tensor) -> list[Posterior]:
    """The distributions of every solver with its own scales, from standardised features."""
    joint = solvers.joint(bev, features_map)
    decoupled = solvers.decoupled(bev, features_map, None)
    refined = solvers.refine(bev, features_map, estimate(decoupled))
    return [joint, decoupled, solvers.banded(bev, features_map), refined]


def fit_scales(solvers: PoseSolvers, infer: Inference, batches: list[Batch]) -> None:
    """Sets the inverse temperatures to the values that minimise -log P(truth)."""
    optimiser = torch.optim.Adam(solvers.log_scale.values(), lr=RATE)
    steps = ROUNDS * len(batches)
    decay = torch.optim.lr_scheduler.ExponentialLR(optimiser, (FINAL_RATE / RATE) ** (1 / steps))
    features = [_standardised_features(infer, batch) for batch in batches]
    for _ in range(ROUNDS):
        for batch, sides in zip(batches, features):
            losses = [pose_losses(p, batch.correction) for p in _posteriors(solvers, *sides)]
            optimiser.zero_grad()
            torch.stack(losses).mean().backward()
            optimiser.step()
            decay.step()


@torch.no_grad()
def _standardised_features(infer: Inference, batch: Batch) -> tuple[Tensor, Tensor]:
    bev, features_map, _ = infer(batch)
    return standardise(bev), standardise(features_map)


@torch.no_grad()
def fit_sigma_scale(infer: Inference, solver: Solver, batches: list[Batch]) -> float:
    """The factor by which to multiply the standard deviations of `solver` so that one sigma covers
    68.3 % of the errors, as for a Gaussian (geometric mean over the axes)."""
    ratios = []
    for batch in batches:
        solution = solver(*infer(batch)[:2])
        ratios.append((solution.estimate - batch.correction).abs() / solution.deviation)
    quantiles = torch.cat(ratios).quantile(0.683, dim=0)
    return quantiles.log().mean().exp().item()
