"""Scores every hypothesis from correlations of blocks (the joint volume), on standardised features.

B and M are F_B and F_M, zero outside. B is divided into blocks of 3 m (5 x 5 cells). If they do not
divide the grid, the last blocks are smaller. For block b and whole shifts (m, n) in cells

    K_b[m, n] = sum over channels c and cells (u, v) of b of B[c, u, v] M[c, u + m, v + n].

Hypothesis (x, y, a) shifts the whole block with centre p_b by d = R(a) p_b + t - p_b, that is by
m = -d.x / 0.6 rows and n = -d.y / 0.6 columns, and

    ZNCC(a, x, y) = sum over b of K_b(m, n) / (C * rows * cols).

The features are standardised once, not per hypothesis. K_b is interpolated between whole shifts by
cubic convolution along each axis (cubic.py). P = softmax(joint_scale * ZNCC) over all hypotheses.
The marginals of P are the distributions of x, y and yaw; the estimates are their means.

If its library is built, the C++ code (training/joint_volume.py,
pipeline/solver/reference/joint_volume.h) scores the paper's hypotheses in float32 on the CPU,
because it is faster. This file scores all others.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor

from training.joint_volume import joint_volume
from training.native import runs_natively
from training.solvers.cubic import cubic_weights
from training.solvers.definition import DEFINITION, SolverDefinition


def block_scores(
    bev: Tensor, features_map: Tensor, definition: SolverDefinition = DEFINITION
) -> Tensor:
    """ZNCC of every hypothesis, [batch, yaw, x, y]."""
    if definition == DEFINITION and runs_natively(bev):
        return joint_volume(bev, features_map, definition.block_cells)
    row_weights, col_weights = _look_up(definition, bev.dtype, bev.device)
    shifts = row_weights.shape[3], col_weights.shape[3]
    correlation = _correlations(bev, features_map, definition.block_cells, shifts)
    scores = [
        torch.einsum("bkmn,kxm,kyn->bxy", correlation, rows, cols)
        for rows, cols in zip(row_weights, col_weights)
    ]
    return torch.stack(scores, dim=1) / bev[0].numel()


def _correlations(bev: Tensor, features_map: Tensor, size: int, shifts: tuple[int, int]) -> Tensor:
    """K of every block at every whole shift, [batch, block, row shift, column shift]. `size`: cells
    of a block's side; `shifts`: number of row and column shifts."""
    # The last blocks are padded with zeros, which add nothing.
    fill = -bev.shape[2] % size, -bev.shape[3] % size
    reach = shifts[0] // 2, shifts[1] // 2
    blocks = F.pad(bev, (0, fill[1], 0, fill[0]))
    padded = F.pad(features_map, (reach[1], reach[1] + fill[1], reach[0], reach[0] + fill[0]))
    correlation = _Correlation.apply(blocks, padded, size, shifts)
    return correlation.permute(0, 3, 4, 1, 2).flatten(1, 2)


class _Correlation(torch.autograd.Function):
    """Sums over the blocks of `bev` times `features_map` at every shift: [batch, row shift, column
    shift, block row, block column]. One shift at a time, so that the products of all shifts need no
    memory, also not for the gradient; a GPU computes each in one go."""

    @staticmethod
    def forward(  # type: ignore[override]  # named arguments in place of *args
        ctx: Any, bev: Tensor, features_map: Tensor, size: int, shifts: tuple[int, int]
    ) -> Tensor:
        ctx.save_for_backward(bev, features_map)
        ctx.size, ctx.shifts = size, shifts
        rows, cols = bev.shape[2:]
        lines = []
        for m in range(shifts[0]):
            windows = (features_map[:, :, m : m + rows, n : n + cols] for n in range(shifts[1]))
            line = torch.stack([(bev * window).sum(1) for window in windows], dim=1)
            lines.append(F.avg_pool2d(line, size, divisor_override=1))
        return torch.stack(lines, dim=1)

    @staticmethod
    def backward(  # type: ignore[override]  # named argument in place of *args
        ctx: Any, gradient: Tensor
    ) -> tuple[Tensor, Tensor, None, None]:
        bev, features_map = ctx.saved_tensors
        rows, cols = bev.shape[2:]
        grad_bev, grad_map = torch.zeros_like(bev), torch.zeros_like(features_map)
        for m in range(ctx.shifts[0]):
            line = gradient[:, m].repeat_interleave(ctx.size, 2).repeat_interleave(ctx.size, 3)
            for n in range(ctx.shifts[1]):
                window = slice(None), slice(None), slice(m, m + rows), slice(n, n + cols)
                grad_bev.addcmul_(line[:, n, None], features_map[window])
                grad_map[window].addcmul_(line[:, n, None], bev)
        return grad_bev, grad_map, None, None


@lru_cache(maxsize=4)
def _look_up(
    definition: SolverDefinition, dtype: torch.dtype, device: torch.device
) -> tuple[Tensor, Tensor]:
    """The interpolation weights of K for the hypotheses: [yaw, block, x, row shift] and
    [yaw, block, y, column shift]."""
    d = definition
    x_m, y_m = torch.meshgrid(
        _block_centres(d.rows, d.block_cells, d.cell_m),
        _block_centres(d.cols, d.block_cells, d.cell_m),
        indexing="ij",
    )
    x_m, y_m = x_m.flatten()[None], y_m.flatten()[None]
    x, y, yaw = d.hypotheses()
    cos, sin = torch.cos(yaw)[:, None], torch.sin(yaw)[:, None]
    row = -(cos * x_m - sin * y_m - x_m)[..., None] / d.cell_m - x / d.cell_m
    col = -(sin * x_m + cos * y_m - y_m)[..., None] / d.cell_m - y / d.cell_m
    return _weights(row).to(device, dtype), _weights(col).to(device, dtype)


def _block_centres(cells: int, size: int, cell_m: float) -> Tensor:
    """The centres of the blocks along one axis in metres from the vehicle, positive to the front or
    left."""
    first = torch.arange(0, cells, size, dtype=torch.float64)
    last = (first + size - 1).clamp(max=cells - 1)
    return (0.5 * (cells - 1) - 0.5 * (first + last)) * cell_m


def _weights(shift: Tensor) -> Tensor:
    """The weight of every whole shift in the value at `shift` [...]: [..., shift]."""
    # Cubic convolution reads from one shift below the integer part to two above it.
    reach = math.floor(shift.abs().max().item()) + 2
    return cubic_weights(shift + reach, 2 * reach + 1)
