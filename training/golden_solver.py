"""Writes the solvers' golden vectors: synthetic features and the results of every solver.

    <features>_bev.npy, <features>_map.npy   [sample, C, 100, 50], float16
    <group>_distributions.npy   [kind, sample, x + y + yaw hypotheses], kinds ordered as KINDS
    <group>_estimates.npy       [kind, sample, (x m, y m, yaw rad)]
    parameters.npy              scales in the order of SCALES, then the GeM exponent

The solvers compute in float64.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from training.solver import DEFINITION, KINDS, PoseSolvers, SolverDefinition
from training.synthetic_scene import cell_centres, features_under

CHANNELS = 16
SCALES = {
    "joint": 40.0,
    "x": 40.0,
    "y": 25.0,
    "yaw": 120.0,
    "banded_x": 40.0,
    "banded_y": 20.0,
    "refine_x": 35.0,
    "refine_y": 50.0,
    "refine_yaw": 65.0,
}
# Exponent of the literal solver. For all other solvers the C++ code accepts only 1.
GEM_OMEGA = 1.75
# Correction (m, m, degrees) and the standard deviation of the noise on F_B.
SCENE_CASES = (((0.0, 0.0, 0.0), 0.2), ((1.3, -0.7, 1.1), 1.0), ((-1.9, 0.9, -1.9), 3.0))
MASKS_CORRECTION = (-0.5, 0.3, 0.7)
MASKS_NOISE = 0.3


def _with_steps(metres: float, degrees: float, y_range_m: float) -> SolverDefinition:
    return dataclasses.replace(
        DEFINITION,
        x_step_m=metres,
        y_range_m=y_range_m,
        y_step_m=metres,
        yaw_step_rad=math.radians(degrees),
    )


# Name, features and hypotheses; keep the steps as in tests/pipeline/solver/golden_solver_test.cpp.
GROUPS = (
    ("scenes", "scenes", DEFINITION),
    ("masks", "masks", DEFINITION),
    ("coarse", "scenes", _with_steps(0.4, 0.4, 1.2)),
    ("fine", "masks", _with_steps(0.1, 0.1, 1.0)),
)


def _correction(x_m: float, y_m: float, yaw_degrees: float) -> Tensor:
    return torch.tensor([x_m, y_m, math.radians(yaw_degrees)])


def _scene(number: int) -> tuple[Tensor, Tensor]:
    """F_B and F_M [1, C, 100, 50]: smooth features, with noise on F_B."""
    correction, noise = SCENE_CASES[number]
    sides = features_under(_correction(*correction), number, max_frequency=0.5, channels=CHANNELS)
    generator = torch.Generator().manual_seed(number)
    return sides[0] + noise * torch.randn(sides[0].shape, generator=generator), sides[1]


def _road(points: Tensor) -> Tensor:
    """Masks [..., 3] of a slightly curved road: dashed dividers, no crossing, boundaries."""
    along, across = points.unbind(-1)
    across = across - 0.004 * along.square()

    def line(offset_m: float) -> Tensor:
        return torch.exp(-(((across - offset_m) / 0.4) ** 2))

    dashes = torch.sigmoid(8 * torch.sin(2 * math.pi * along / 9.0))
    dividers = (line(1.7) + line(-1.7)) * dashes
    boundaries = line(5.3) + line(-6.1) * (along < 18.0)
    return torch.stack((dividers, torch.zeros_like(dividers), boundaries), dim=-1)


def _masks() -> tuple[Tensor, Tensor]:
    """F_B and F_M [1, 3, 100, 50] that look like masks; the crossing class is empty."""
    x, y, yaw = _correction(*MASKS_CORRECTION).tolist()
    points = cell_centres()
    rotation = torch.tensor([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    on_map = points @ rotation.T + torch.tensor([x, y])
    bev, features_map = (_road(p).permute(2, 0, 1)[None] for p in (on_map, points))
    generator = torch.Generator().manual_seed(0)
    noise = MASKS_NOISE * torch.rand(bev[:, ::2].shape, generator=generator)
    bev[:, ::2] = torch.maximum(bev[:, ::2], noise)
    return bev, features_map


def _features(name: str) -> tuple[Tensor, Tensor]:
    """F_B and F_M of all samples, rounded to float16."""
    samples = [_scene(i) for i in range(len(SCENE_CASES))] if name == "scenes" else [_masks()]
    bev, features_map = (torch.cat(side) for side in zip(*samples))
    return bev.half(), features_map.half()


def golden_solvers(definition: SolverDefinition) -> PoseSolvers:
    solvers = PoseSolvers(definition).double()
    for name, value in SCALES.items():
        solvers.log_scale[name].data.fill_(math.log(value))
    solvers.log_gem_omega.data.fill_(math.log(GEM_OMEGA))
    return solvers


@torch.no_grad()
def write_solver_vectors(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    np.save(out / "parameters.npy", np.array([*SCALES.values(), GEM_OMEGA], np.float32))
    for group, features, definition in GROUPS:
        bev, features_map = _features(features)
        if group == features:
            np.save(out / f"{group}_bev.npy", bev.numpy())
            np.save(out / f"{group}_map.npy", features_map.numpy())
        solvers = golden_solvers(definition)
        found = [solvers.solve(kind, bev.double(), features_map.double()) for kind in KINDS]
        distributions = torch.stack([torch.cat(s.posterior.axes(), dim=1) for s in found])
        np.save(out / f"{group}_distributions.npy", distributions.float().numpy())
        estimates = torch.stack([s.estimate for s in found])
        np.save(out / f"{group}_estimates.npy", estimates.float().numpy())
