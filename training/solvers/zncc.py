"""Zero-mean normalised cross-correlation (paper, eq. 5) over all cells and channels at once:

ZNCC = (mean(a b) - mean(a) mean(b)) / sqrt(var(a) var(b)), population moments; 0 where a side is
constant. Features moved under a hypothesis count as zero where they do not reach.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.solvers.features import move


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


def moved_zncc(bev: Tensor, features_map: Tensor, corrections: Tensor, cell_m: float) -> Tensor:
    """ZNCC of F_M with F_B moved under each of the corrections [batch, count, 3]: [batch, count].
    `corrections` may also be [1, count, 3], the same for all."""
    moved = move(bev, corrections.expand(len(bev), -1, -1), cell_m)
    product = torch.einsum("bcnuv,bcuv->bn", moved, features_map)
    map_sums = sums_of(features_map[:, :, None], (1, 3, 4))
    return zncc(product, sums_of(moved, (1, 3, 4)), map_sums, features_map[0].numel())
