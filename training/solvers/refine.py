"""One more look at a solution, with the full score, of standardised features.

One coordinate pass of ZNCC (zncc.py) through the estimate so far, in the order y, yaw, x, over the
hypotheses of each axis: 11 + 21 + 21. P = softmax(joint_scale * ZNCC) of each axis replaces the
first distribution, and its mean the estimate, before the next axis is scored. What is held fixed
gets no gradient. (The run time can give each axis a scale of its own; a model file that names none
means joint_scale for all three.)
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.solvers.definition import SolverDefinition
from training.solvers.posterior import Posterior
from training.solvers.zncc import moved_zncc

_X, _Y, _YAW = 0, 1, 2


def axis_zncc(
    bev: Tensor, features_map: Tensor, held: Tensor, axis: int, definition: SolverDefinition
) -> Tensor:
    """ZNCC over the hypotheses of one axis, [batch, count]; the others as in `held` (x m, y m, yaw
    rad), [batch, 3]."""
    values = definition.hypotheses()[axis].to(bev.device)
    corrections = held.detach().double()[:, None].repeat(1, len(values), 1)
    corrections[:, :, axis] = values
    return moved_zncc(bev, features_map, corrections, definition.cell_m)


def refine(
    bev: Tensor, features_map: Tensor, start: Tensor, scale: Tensor, definition: SolverDefinition
) -> Posterior:
    """`start`: the estimate so far, [batch, 3]."""
    held = start.detach().clone()
    found: dict[int, Tensor] = {}
    for axis in (_Y, _YAW, _X):
        scores = axis_zncc(bev, features_map, held, axis, definition)
        found[axis] = torch.softmax(scores * scale, dim=1)
        values = definition.hypotheses()[axis].to(bev)
        held[:, axis] = found[axis].detach() @ values
    return Posterior(found[_X], found[_Y], found[_YAW])
