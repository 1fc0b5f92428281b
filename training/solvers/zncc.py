"""Zero-mean normalised cross-correlation (paper, eq. 5) over a lattice's cells and all channels at
once:

ZNCC = (mean(a b) - mean(a) mean(b)) / sqrt(var(a) var(b)), population moments; 0 where a side is
constant. Features moved under a hypothesis count as zero where they do not reach.

The sums of features in float32 that corrections move within the paper's hypotheses are the run
time's own (training/moved_sums.py), which is faster; all others are made here.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.moved_sums import moved_sums
from training.solvers.definition import DEFINITION
from training.solvers.features import move
from training.solvers.lattice import EVERY_CELL, CellLattice

_ROUNDING = 1e-6


def zncc(product: Tensor, a: tuple[Tensor, Tensor], b: tuple[Tensor, Tensor], count: int) -> Tensor:
    """From sums over `count` values: of a b, and of each side's values and squares."""
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
    """Of the values and of their squares."""
    return features.sum(dim), features.square().sum(dim)


def moved_zncc(
    bev: Tensor,
    features_map: Tensor,
    corrections: Tensor,
    cell_m: float,
    lattice: CellLattice = EVERY_CELL,
) -> Tensor:
    """ZNCC of F_M with F_B moved under each of the corrections [batch, count, 3]: [batch, count].
    `corrections` may also be [1, count, 3], the same for all."""
    corrections = corrections.expand(len(bev), -1, -1)
    mask = lattice.mask(*bev.shape[2:]).to(bev)
    features_map = features_map * mask
    if _is_native(bev, corrections, cell_m):
        product, *moved_side = moved_sums(bev, features_map, corrections, lattice).unbind(2)
    else:
        moved = move(bev, corrections, cell_m) * mask
        product = torch.einsum("bcnuv,bcuv->bn", moved, features_map)
        moved_side = sums_of(moved, (1, 3, 4))
    map_side = sums_of(features_map[:, :, None], (1, 3, 4))
    count = features_map.shape[1] * int(mask.sum())
    return zncc(product, tuple(moved_side), map_side, count).to(bev)


def _is_native(bev: Tensor, corrections: Tensor, cell_m: float) -> bool:
    grid = (*bev.shape[2:], cell_m)
    if grid != (DEFINITION.rows, DEFINITION.cols, DEFINITION.cell_m) or bev.dtype != torch.float32:
        return False
    farthest = torch.tensor(DEFINITION.farthest()).to(corrections)
    return bool((corrections.abs() <= farthest + _ROUNDING).all())
