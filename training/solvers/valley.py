"""Which way the score falls least when one axis is moved, of standardised map features.

Near the solution the score falls like d^T H d for a displacement d = (x m, y m, yaw rad), with
H = sum over cells (all but the outermost) and channels of J^T J; J = (f_x, f_y, -y' f_x + x' f_y)
are the map features' gradients, from differences over two cells, and (x', y') is where the cell
lies from the corrected position, which a turn is about. To H is added 0.001 trace(U H) U^-1, with U
the variances of uniform hypotheses: where the map shows nothing along an axis, that axis stays.

Given x, the y and yaw that suit it best follow from H d = 0 in their two rows; given yaw at the
same x, y follows from its row. Nothing here gets a gradient.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.solvers.definition import SolverDefinition

_RIDGE = 1e-3
_LEAST_TRACE = 1e-12  # no map shows so little: keeps H regular


class ScoreValley:
    """Of map features [batch, C, rows, cols]."""

    def __init__(self, features_map: Tensor, definition: SolverDefinition) -> None:
        self._uniform = uniform_variance(definition)
        rows, cols = features_map.shape[2:]
        f = features_map.detach()
        cell_m = definition.cell_m
        # Rows and columns run against x and y.
        f_x = (f[:, :, :-2, 1:-1] - f[:, :, 2:, 1:-1]) / (2 * cell_m)
        f_y = (f[:, :, 1:-1, :-2] - f[:, :, 1:-1, 2:]) / (2 * cell_m)
        # All channels of a cell turn alike: their products are summed before the cells'.
        products = ((f_x * f_x).sum(1), (f_x * f_y).sum(1), (f_y * f_y).sum(1))
        xx, xy, yy = (product.double().cpu() for product in products)  # [batch, row, col]
        x = (0.5 * rows - 0.5 - torch.arange(1, rows - 1, dtype=torch.float64))[:, None] * cell_m
        y = (0.5 * cols - 0.5 - torch.arange(1, cols - 1, dtype=torch.float64)) * cell_m
        x_turn, y_turn = x * xy - y * xx, x * yy - y * xy
        turn_turn = x * y_turn - y * x_turn
        rows_of_h = ((xx, xy, x_turn), (xy, yy, y_turn), (x_turn, y_turn, turn_turn))
        entries = [torch.stack([h.sum((1, 2)) for h in row], dim=1) for row in rows_of_h]
        self._curvature = torch.stack(entries, dim=1)

    def _curvature_at(self, pose: Tensor) -> Tensor:
        """`pose`: (x m, y m, yaw rad), [batch, 3]. A turn about it is one about the middle, and a
        shift by (y, -x)."""
        middle_from_here = torch.eye(3, dtype=torch.float64).repeat(len(pose), 1, 1)
        middle_from_here[:, 0, 2] = pose[:, 1].double().cpu()
        middle_from_here[:, 1, 2] = -pose[:, 0].double().cpu()
        curvature = middle_from_here.transpose(1, 2) @ self._curvature @ middle_from_here
        trace = (curvature.diagonal(dim1=1, dim2=2) @ self._uniform).clamp(min=_LEAST_TRACE)
        return curvature + _RIDGE * trace[:, None, None] * torch.diag(1 / self._uniform)

    def along_x(self, pose: Tensor) -> Tensor:
        """The displacement that moves x by 1 m, with the y and the yaw that suit it, [batch, 3]."""
        curvature = self._curvature_at(pose)
        others = -torch.linalg.solve(curvature[:, 1:, 1:], curvature[:, 1:, :1])[:, :, 0]
        one = torch.ones(len(pose), 1, dtype=torch.float64)
        return torch.cat((one, others), dim=1).to(pose)

    def along_yaw(self, pose: Tensor) -> Tensor:
        """The displacement that turns by 1 rad, with the y that suits it, [batch, 3]."""
        curvature = self._curvature_at(pose)
        y = -curvature[:, 1, 2] / curvature[:, 1, 1]
        return torch.stack((torch.zeros_like(y), y, torch.ones_like(y)), dim=1).to(pose)


def uniform_variance(definition: SolverDefinition) -> Tensor:
    """Of x, y and yaw when every hypothesis is as likely as any other."""
    return torch.stack([h.square().mean() for h in definition.hypotheses()])
