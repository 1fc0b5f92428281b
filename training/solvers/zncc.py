"""Zero-mean normalised cross-correlation (paper, eq. 5) over the cells of a lattice and all
channels together:

ZNCC = (mean(a b) - mean(a) mean(b)) / sqrt(var(a) var(b)) with population moments; 0 if a side is
constant. Moved features count as zero in cells that they do not cover.

If its library is built, the C++ code (training/moved_sums.py) computes the sums for float32
features on the CPU and corrections in the range of the paper's hypotheses, because it is faster.
This file computes all others.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.moved_sums import moved_sums
from training.native import runs_natively
from training.solvers.definition import DEFINITION
from training.solvers.features import move_to
from training.solvers.lattice import EVERY_CELL, CellLattice

_ROUNDING = 1e-6


def zncc(product: Tensor, a: tuple[Tensor, Tensor], b: tuple[Tensor, Tensor], count: int) -> Tensor:
    """ZNCC from sums over `count` values: of a b, and of the values and squares of each side."""
    (a_mean, a_variance), (b_mean, b_variance) = (_moments(*sums, count) for sums in (a, b))
    covariance = product / count - a_mean * b_mean
    variance = a_variance * b_variance
    varies = variance > 0
    deviation = torch.where(varies, variance, torch.ones_like(variance)).sqrt()
    return torch.where(varies, covariance / deviation, torch.zeros_like(covariance))


def _moments(value: Tensor, square: Tensor, count: int) -> tuple[Tensor, Tensor]:
    mean = value / count
    return mean, (square / count - mean.square()).clamp(min=0)


def sums_of(features: Tensor, dim: tuple[int, ...]) -> tuple[Tensor, Tensor]:
    """The sums of the values and of their squares."""
    return features.sum(dim), features.square().sum(dim)


def moved_zncc(
    bev: Tensor,
    features_map: Tensor,
    corrections: Tensor,
    cell_m: float,
    lattice: CellLattice = EVERY_CELL,
) -> Tensor:
    """ZNCC of F_M with F_B moved by each of the corrections, [batch, count]. `corrections` (x m,
    y m, yaw rad) is [batch, count, 3], or [1, count, 3] to use the same for the whole batch."""
    corrections = corrections.expand(len(bev), -1, -1)
    row, col = lattice.cells(*bev.shape[2:])
    map_cells = features_map[:, :, row.to(bev.device), col.to(bev.device)]
    if _is_native(bev, corrections, cell_m):
        mask = lattice.mask(*bev.shape[2:]).to(bev)
        sums = moved_sums(bev, features_map * mask, corrections, lattice)
        product, value, square = sums.unbind(2)
    else:
        moved = move_to(bev, corrections, cell_m, row, col)
        product = torch.einsum("bcnk,bck->bn", moved, map_cells)
        value, square = sums_of(moved, (1, 3))
    map_side = sums_of(map_cells[:, :, None], (1, 3))
    count = features_map.shape[1] * len(row)
    return zncc(product, (value, square), map_side, count).to(bev)


def _is_native(bev: Tensor, corrections: Tensor, cell_m: float) -> bool:
    """Whether the C++ code supports these features and corrections."""
    grid = (*bev.shape[2:], cell_m)
    if grid != (DEFINITION.rows, DEFINITION.cols, DEFINITION.cell_m) or not runs_natively(bev):
        return False
    farthest = torch.tensor(DEFINITION.farthest()).to(corrections)
    return bool((corrections.abs() <= farthest + _ROUNDING).all())
