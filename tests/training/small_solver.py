"""Solvers small enough for exact checks: 20 x 10 cells, 5 x 3 x 5 hypotheses, float64."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from training.solver import PoseSolvers, SolverDefinition

DEGREE = math.radians(1.0)
SMALL = SolverDefinition(
    rows=20,
    cols=10,
    x_range_m=0.6,
    x_step_m=0.3,
    y_range_m=0.4,
    y_step_m=0.4,
    yaw_range_rad=2 * DEGREE,
    yaw_step_rad=DEGREE,
)
CHANNELS = 3


def small_solvers(scale: float = 20.0, omega: float = 1.6) -> PoseSolvers:
    solvers = PoseSolvers(SMALL).double()
    for parameter in solvers.log_scale.values():
        parameter.data.fill_(math.log(scale))
    solvers.log_gem_omega.data.fill_(math.log(omega))
    return solvers


def random_features(seed: int, batch: int = 2) -> tuple[Tensor, Tensor]:
    """Random F_M, and F_B that equals F_M plus noise."""
    generator = torch.Generator().manual_seed(seed)
    shape = (batch, CHANNELS, SMALL.rows, SMALL.cols)
    features_map = torch.randn(shape, generator=generator, dtype=torch.float64)
    noise = torch.randn(shape, generator=generator, dtype=torch.float64)
    return features_map + 0.5 * noise, features_map
