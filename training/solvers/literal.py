"""Decoupled neural matching exactly as in the paper (section III-D, eq. 7 to 13), on raw features.

* Both sides are divided by the largest magnitude in either. This does not change any score.
* Yaw: F_B is rotated by each hypothesis (features.py). A = |FFT2| at the size of the grid, without
  a window. A is sampled bilinearly in polar coordinates of its indices, row bin r cos(theta)
  (wrapping) and column bin r sin(theta), at 180 angles theta_i = i degrees and radii r = 1 ... 24
  (half the shorter side minus one), and averaged over the radii: Y[c, i].
  P = softmax(-yaw_scale * sum((Y_M - Y_B^a)^2) / sum(Y_M^2)).
* x and y: F_B is moved by each hypothesis and the best yaw in one step. A = GeM (eq. 12) over the
  whole of the other axis, (mean(max(f, 1e-6)^omega))^(1 / omega). The score is the ZNCC over all
  positions and channels together (zncc.py). P = softmax(scale * ZNCC) with x_scale or y_scale.
* The estimates are the best hypotheses (eq. 6 and 10). They have no gradient; the distributions do.

Two points differ from the paper: the minus in eq. 9, without which the worst yaw wins, and the
softmax scales, without which the distributions are nearly uniform.
"""

from __future__ import annotations

import math
from functools import lru_cache

import torch
from torch import Tensor

from training.solvers.definition import SolverDefinition
from training.solvers.features import move
from training.solvers.zncc import sums_of, zncc


def scale_together(bev: Tensor, features_map: Tensor) -> tuple[Tensor, Tensor]:
    """Divides both sides of each sample by their largest magnitude."""
    greatest = torch.maximum(bev.abs().amax((1, 2, 3)), features_map.abs().amax((1, 2, 3)))
    greatest = greatest.detach().clamp(min=1e-30)[:, None, None, None]
    return bev / greatest, features_map / greatest


def literal_yaw_scores(bev: Tensor, features_map: Tensor, definition: SolverDefinition) -> Tensor:
    """Scores of every yaw, [batch, count]."""
    yaw = definition.hypotheses()[2].to(bev.device)
    corrections = torch.stack((torch.zeros_like(yaw), torch.zeros_like(yaw), yaw), dim=1)
    moved = move(bev, corrections.expand(len(bev), -1, -1), definition.cell_m)
    yaw_map = _yaw_features(features_map[:, :, None], definition)
    difference = (yaw_map - _yaw_features(moved, definition)).square().sum((1, 3))
    return -difference / yaw_map.square().sum((1, 3))


def _yaw_features(features: Tensor, definition: SolverDefinition) -> Tensor:
    """[batch, C, count, rows, cols] -> [batch, C, count, angles]."""
    spectrum = torch.fft.rfft2(features)
    amplitude = (spectrum.real.square() + spectrum.imag.square() + 1e-12).sqrt()
    return amplitude.flatten(3) @ _polar_means(definition).to(features)


@lru_cache(maxsize=4)
def _polar_means(definition: SolverDefinition) -> Tensor:
    """The weight of each frequency of the half spectrum at each angle, [frequency, angle]."""
    rows, half_cols = definition.rows, definition.cols // 2 + 1
    count = min(definition.rows, definition.cols) // 2 - 1
    radius = torch.arange(1, count + 1, dtype=torch.float64)[:, None]
    theta = torch.arange(definition.literal_angles, dtype=torch.float64)
    theta = theta * (math.pi / definition.literal_angles)
    row, col = radius * torch.cos(theta), radius * torch.sin(theta)
    row0, col0 = row.floor(), col.floor()
    weights = torch.zeros(rows * half_cols, len(theta), dtype=torch.float64)
    for i in (0, 1):
        for j in (0, 1):
            weight = (1 - (row - row0 - i).abs()) * (1 - (col - col0 - j).abs())
            frequency = torch.remainder(row0 + i, rows) * half_cols + col0 + j
            weights.scatter_add_(0, frequency.long(), weight / count)
    return weights


def gem(features: Tensor, omega: Tensor, dim: int, least: float) -> Tensor:
    """Generalised mean (eq. 12) of max(f, least) along `dim`. It is computed with logarithms,
    because powers could underflow."""
    powers = omega * features.clamp(min=least).log()
    return ((torch.logsumexp(powers, dim) - math.log(features.shape[dim])) / omega).exp()


def literal_axis_scores(
    bev: Tensor,
    features_map: Tensor,
    yaw_rad: Tensor,
    omega: Tensor,
    definition: SolverDefinition,
) -> tuple[Tensor, Tensor]:
    """Scores of every x and of every y, [batch, count] each, with F_B rotated by `yaw_rad`
    [batch]."""
    x, y, _ = definition.hypotheses()
    scores = []
    for axis, shifts in enumerate((x, y)):
        corrections = torch.zeros(
            (len(bev), len(shifts), 3), dtype=torch.float64, device=bev.device
        )
        corrections[:, :, axis] = shifts.to(bev.device)
        corrections[:, :, 2] = yaw_rad.detach()[:, None]
        moved = move(bev, corrections, definition.cell_m)  # [batch, C, count, rows, cols]
        pooled = 4 - axis  # x pools over columns, y over rows
        axis_bev = gem(moved, omega, pooled, definition.gem_least)
        axis_map = gem(features_map[:, :, None], omega, pooled, definition.gem_least)
        product = (axis_bev * axis_map).sum((1, 3))
        sums = sums_of(axis_bev, (1, 3)), sums_of(axis_map, (1, 3))
        scores.append(zncc(product, *sums, axis_map[0].numel()))
    return scores[0], scores[1]
