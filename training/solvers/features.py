"""Operations on features [batch, C, rows, cols] before solvers compare them.

Standardise: each channel of F_B and of F_M, once over all its cells: (f - mean) / (std + 0.01),
with the population standard deviation (divided by 5000).

Move under a correction: moved(p) = features(R(-a) (p - t)), bilinear; taps outside the grid count
as zero.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

from training.solvers.definition import DEFINITION, SolverDefinition


def standardise(features: Tensor, definition: SolverDefinition = DEFINITION) -> Tensor:
    std, mean = torch.std_mean(features, dim=(2, 3), unbiased=False, keepdim=True)
    return (features - mean) / (std + definition.standard_epsilon)


def move_to(
    features: Tensor, corrections: Tensor, cell_m: float, row: Tensor, col: Tensor
) -> Tensor:
    """The values at `row` and `col` [n] of features moved by each of `corrections` (x m, y m,
    yaw rad), [batch, count, 3]: [batch, C, count, n]. The corrections get no gradient."""
    rows, cols = features.shape[2:]
    x_m, y_m, yaw = corrections.detach().double()[..., None].unbind(2)
    # Positions in cells, relative to the vehicle.
    x = 0.5 * rows - 0.5 - row.to(x_m) - x_m / cell_m
    y = 0.5 * cols - 0.5 - col.to(y_m) - y_m / cell_m
    source_x = torch.cos(yaw) * x + torch.sin(yaw) * y
    source_y = torch.cos(yaw) * y - torch.sin(yaw) * x
    # grid_sample expects (column, row) with the grid's edges at -1 and +1.
    grid = torch.stack((-source_y / (0.5 * cols), -source_x / (0.5 * rows)), dim=3)
    return F.grid_sample(features, grid.to(features), padding_mode="zeros", align_corners=False)


def move(
    features: Tensor, corrections: Tensor, cell_m: float, margin: tuple[int, int] = (0, 0)
) -> Tensor:
    """Features moved by each of `corrections` (x m, y m, yaw rad), [batch, count, 3]:
    [batch, C, count, rows, cols]. The result covers the grid and `margin` rows and columns around
    it. The corrections get no gradient."""
    rows, cols = features.shape[2:]
    row = torch.arange(-margin[0], rows + margin[0])
    col = torch.arange(-margin[1], cols + margin[1])
    cells = torch.cartesian_prod(row, col).unbind(1)
    moved = move_to(features, corrections, cell_m, *cells)
    return moved.unflatten(3, (len(row), len(col)))


def rotate(features: Tensor, yaw_rad: Tensor) -> Tensor:
    """Features rotated about the vehicle by yaw [batch], F'(p) = F(R(-a) p)."""
    corrections = F.pad(yaw_rad[:, None], (2, 0))
    return move(features, corrections[:, None], 1.0)[:, :, 0]
