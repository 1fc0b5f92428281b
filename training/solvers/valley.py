"""The valley of the score: the direction in which it falls least when one axis is moved. Computed
from standardised map features.

Near the solution, the score falls like d^T H d for a displacement d = (x m, y m, yaw rad). H is the
sum over channels and all cells but the outermost of J^T J. J = (f_x, f_y, -y' f_x + x' f_y) are the
gradients of the map features, from differences over two cells; (x', y') is the cell's position
relative to the corrected pose, which is the centre of rotation. The term 0.001 trace(U H) U^-1 is
added to H, where U is the diagonal matrix of the variances of uniform distributions over the
hypotheses. It keeps an axis fixed if the map does not constrain it.

For a given x, the best y and yaw follow from H d = 0 in their two rows. For a given yaw and fixed
x, y follows from its row. Nothing here gets a gradient.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.solvers.definition import SolverDefinition

_RIDGE = 1e-3
_LEAST_TRACE = 1e-12  # keeps H regular; the trace of any real map is larger


class ScoreValley:
    """The valley of the score of map features [batch, C, rows, cols]."""

    def __init__(self, features_map: Tensor, definition: SolverDefinition) -> None:
        self._uniform = uniform_variance(definition).to(features_map.device)
        rows, cols = features_map.shape[2:]
        f = features_map.detach()
        cell_m = definition.cell_m
        # Rows and columns run opposite to x and y.
        f_x = (f[:, :, :-2, 1:-1] - f[:, :, 2:, 1:-1]) / (2 * cell_m)
        f_y = (f[:, :, 1:-1, :-2] - f[:, :, 1:-1, 2:]) / (2 * cell_m)
        # All channels of a cell share its position, so products are summed over channels first.
        products = ((f_x * f_x).sum(1), (f_x * f_y).sum(1), (f_y * f_y).sum(1))
        xx, xy, yy = (product.double() for product in products)  # [batch, row, col]
        x = (0.5 * rows - 0.5 - torch.arange(1, rows - 1).to(xx))[:, None] * cell_m
        y = (0.5 * cols - 0.5 - torch.arange(1, cols - 1).to(xx)) * cell_m
        x_turn, y_turn = x * xy - y * xx, x * yy - y * xy
        turn_turn = x * y_turn - y * x_turn
        rows_of_h = ((xx, xy, x_turn), (xy, yy, y_turn), (x_turn, y_turn, turn_turn))
        entries = [torch.stack([h.sum((1, 2)) for h in row], dim=1) for row in rows_of_h]
        self._curvature = torch.stack(entries, dim=1)

    def _curvature_at(self, pose: Tensor) -> Tensor:
        """H at `pose` (x m, y m, yaw rad), [batch, 3]. A rotation about the pose equals a rotation
        about the grid's centre plus a shift by (y, -x)."""
        middle_from_here = torch.eye(3).to(self._curvature).repeat(len(pose), 1, 1)
        middle_from_here[:, 0, 2] = pose[:, 1].double()
        middle_from_here[:, 1, 2] = -pose[:, 0].double()
        curvature = middle_from_here.transpose(1, 2) @ self._curvature @ middle_from_here
        trace = (curvature.diagonal(dim1=1, dim2=2) @ self._uniform).clamp(min=_LEAST_TRACE)
        return curvature + _RIDGE * trace[:, None, None] * torch.diag(1 / self._uniform)

    def along_x(self, pose: Tensor) -> Tensor:
        """The displacement that moves x by 1 m, with the best y and yaw, [batch, 3]."""
        curvature = self._curvature_at(pose)
        yy, yaw_y, yaw_yaw = curvature[:, 1, 1], curvature[:, 1, 2], curvature[:, 2, 2]
        y_x, yaw_x = curvature[:, 1, 0], curvature[:, 2, 0]
        determinant = yy * yaw_yaw - yaw_y * yaw_y
        y = (yaw_y * yaw_x - yaw_yaw * y_x) / determinant
        yaw = (yaw_y * y_x - yy * yaw_x) / determinant
        return torch.stack((torch.ones_like(y), y, yaw), dim=1).to(pose)

    def along_yaw(self, pose: Tensor) -> Tensor:
        """The displacement that turns by 1 rad with the best y and unchanged x, [batch, 3]."""
        curvature = self._curvature_at(pose)
        y = -curvature[:, 1, 2] / curvature[:, 1, 1]
        return torch.stack((torch.zeros_like(y), y, torch.ones_like(y)), dim=1).to(pose)


def uniform_variance(definition: SolverDefinition) -> Tensor:
    """The variances of x, y and yaw if all hypotheses are equally likely."""
    return torch.stack([h.square().mean() for h in definition.hypotheses()])
