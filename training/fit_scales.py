"""Fits the solvers' scales to the finished (quantized) features. Training learns some of the scales
with the float network, and none for the solvers that are not part of its loss."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

import torch
from torch import Tensor

from training.data import Batch
from training.errors import TrainingError
from training.evaluate import Inference, Solver
from training.losses import pose_losses
from training.runtime import NativeSolution
from training.solver import Posterior, PoseSolvers, estimate, standardise

RATE, FINAL_RATE = 0.2, 0.02
ROUNDS = 3
RIGHT_M = (1.0, 0.3)  # a match with smaller errors in x and y has found the right place
FACTORS = (0.1, 10.0)  # the range that the daemon accepts (pipeline/network/network.cpp)
TYPICAL_SCORE = 0.32  # their mean score when the limits of evidence were chosen

ScoringSolver = Callable[[Tensor, Tensor], NativeSolution]


@dataclass(frozen=True)
class ResultScales:
    """Factors for the standard deviations and the scores of the solvers."""

    sigma: float = 1.0
    score: float = 1.0


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
    68.3 % of the errors, as for a Gaussian (geometric mean over the axes). TrainingError if it is
    not in FACTORS."""
    ratios = []
    for batch in batches:
        solution = solver(*infer(batch)[:2])
        ratios.append((solution.estimate - batch.correction).abs() / solution.deviation)
    quantiles = torch.cat(ratios).quantile(0.683, dim=0)
    return _usable("sigma", quantiles.log().mean().exp().item())


@torch.no_grad()
def fit_score_scale(
    infer: Inference, solver: ScoringSolver, batches: list[Batch]
) -> float:
    """The factor by which to multiply the scores so that matches of the right place have the mean
    score TYPICAL_SCORE. The limits of evidence (pipeline/tracker/evidence.h) then fit `infer`.
    TrainingError if it is not in FACTORS, or if no match has found the right place."""
    scores = []
    for batch in batches:
        solution = solver(*infer(batch)[:2])
        errors = (solution.estimate - batch.correction).abs()
        right = (errors[:, :2] < torch.tensor(RIGHT_M)).all(dim=1)
        scores.append(solution.score[right])
    return _usable("score", (TYPICAL_SCORE / torch.cat(scores).mean()).item())


def _usable(name: str, factor: float) -> float:
    least, most = FACTORS
    if not least <= factor <= most:
        raise TrainingError(
            f"factor of the {name}: found {factor:.3g}, wanted {least:g} to {most:g}; the network "
            "does not find the right place often enough, so train it longer"
        )
    return factor
