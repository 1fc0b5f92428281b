"""x and y from axis features: the second half of the decoupled solver, on standardised features.

F_B is first rotated about the vehicle by the estimated yaw: F'(p) = F_B(R(-a) p), bilinear, taps
outside the grid count as zero. (Training uses the true yaw with noise of 0.2 degrees.)

A border of 4 cells, the largest shift, is cropped on every side.
* x: A[c, u] = mean over columns 4 ... 45. This is GeM, eq. 12, with omega = 1, because the features
  are signed. A_B^x[u] = A_B(u + x / 0.6), linear between rows, for u = 4 ... 95.
* y: A[c, v] = mean over rows 4 ... 95; A_B^y[v] = A_B(v + y / 0.6) for v = 4 ... 45.
* Per channel: z_c = cov(A_B^t, A_M) / sqrt((var(A_B^t) + 1e-3) (var(A_M) + 1e-3)), with population
  moments over the cropped positions. score = mean over c of z_c. P = softmax(scale * score) with
  x_scale or y_scale. The estimate is the mean of P.
"""

from __future__ import annotations

from torch import Tensor

from training.solvers.definition import DEFINITION, SolverDefinition, split_shift


def _axis_scores(
    axis_bev: Tensor, axis_map: Tensor, shifts: Tensor, definition: SolverDefinition
) -> Tensor:
    """ZNCC of axis features [batch, C, n] for every shift (in cells), [batch, count]."""
    crop = definition.crop_cells
    inner = axis_bev.shape[2] - 2 * crop
    whole, fraction = split_shift(shifts)
    fraction = fraction.to(axis_bev)[:, None]
    start = (whole + crop).to(axis_bev.device)
    windows = axis_bev.unfold(2, inner, 1)  # [batch, C, start, inner]
    last = windows.shape[2] - 1
    # The last window has no right neighbour; its shift is whole and does not need one.
    right = windows[:, :, (start + 1).clamp(max=last)]
    shifted = (1 - fraction) * windows[:, :, start] + fraction * right
    shifted = shifted - shifted.mean(dim=3, keepdim=True)
    fixed = axis_map[:, :, crop : crop + inner]
    fixed = (fixed - fixed.mean(dim=2, keepdim=True))[:, :, None]
    covariance = (shifted * fixed).mean(dim=3)
    epsilon = definition.zncc_epsilon
    variances = (shifted.square().mean(dim=3) + epsilon) * (fixed.square().mean(dim=3) + epsilon)
    return (covariance / variances.sqrt()).mean(dim=1)


def longitudinal_scores(
    turned_bev: Tensor, features_map: Tensor, definition: SolverDefinition = DEFINITION
) -> Tensor:
    """Scores of every x, [batch, count]."""
    inner = slice(definition.crop_cells, -definition.crop_cells)
    shifts = definition.hypotheses()[0] / definition.cell_m
    axes = turned_bev[..., inner].mean(3), features_map[..., inner].mean(3)
    return _axis_scores(*axes, shifts, definition)


def lateral_scores(
    turned_bev: Tensor, features_map: Tensor, definition: SolverDefinition = DEFINITION
) -> Tensor:
    """Scores of every y, [batch, count]."""
    inner = slice(definition.crop_cells, -definition.crop_cells)
    shifts = definition.hypotheses()[1] / definition.cell_m
    axes = turned_bev[:, :, inner].mean(2), features_map[:, :, inner].mean(2)
    return _axis_scores(*axes, shifts, definition)
