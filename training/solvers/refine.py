"""One more look at a solution, with the full score, of standardised features.

Two rounds of ZNCC (zncc.py) through the estimate so far, each one pass along y, yaw and x, in this
order, over the hypotheses of each axis: 11 + 21 + 21. What has been searched follows along the
score's valley (valley.py, at the estimate so far): y while yaw is searched, y and yaw while x is.
No pose that is scored lies beyond the farthest hypotheses. Each search gives
P = softmax(scale * ZNCC), with refine_x_scale, refine_y_scale or refine_yaw_scale, and goes on from
its mean. The first round only finds where the second begins: y and yaw of the first are searched at
an x that it then finds to be wrong.

The distributions are marginals of the second round: P_x is the last search's. What followed an axis is spread by it,
P(v) = sum over i of P_followed(i) P_search(v - slope (value_i - where the search began)), linear
between hypotheses, and what leaves an axis stays at its end: P_y by yaw and then by x, P_yaw by x.
Their means are the estimate. Where a search begins and goes along gets no gradient.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.solvers.definition import SolverDefinition
from training.solvers.posterior import Posterior
from training.solvers.valley import ScoreValley
from training.solvers.zncc import moved_zncc

_X, _Y, _YAW = 0, 1, 2


def line_zncc(
    sides: tuple[Tensor, Tensor],
    pose: Tensor,
    axis: int,
    direction: Tensor,
    definition: SolverDefinition,
) -> Tensor:
    """ZNCC of F_B and F_M over the hypotheses of one axis, [batch, count], along `direction`
    through `pose`, both [batch, 3]."""
    offset = definition.hypotheses()[axis].to(pose) - pose[:, axis, None]
    corrections = pose[:, None] + offset[..., None] * direction[:, None]
    farthest = torch.tensor(definition.farthest()).to(corrections)
    corrections = torch.maximum(torch.minimum(corrections, farthest), -farthest)
    return moved_zncc(*sides, corrections, definition.cell_m)


def spread(
    probability: Tensor, values: Tensor, followed: Tensor, offset: Tensor
) -> Tensor:
    """The distribution [batch, count] of what followed another axis: by `offset` [batch, n] at each
    of that axis's `n` hypotheses."""
    last = len(values) - 1
    step = values[1] - values[0]
    position = torch.arange(last + 1).to(offset) + offset[..., None] / step  # [batch, n, count]
    position = position.clamp(0, last)
    # What is not a number has to lie somewhere; `above` keeps it.
    low = position.nan_to_num().floor().clamp(max=last - 1)
    above = (position - low).to(probability)
    share = followed[..., None] * probability[:, None]
    result = torch.zeros_like(probability)
    result = result.scatter_add(1, low.long().flatten(1), ((1 - above) * share).flatten(1))
    return result.scatter_add(1, low.long().flatten(1) + 1, (above * share).flatten(1))


def refine(
    bev: Tensor,
    features_map: Tensor,
    start: Tensor,
    scales: tuple[Tensor, ...],
    definition: SolverDefinition,
) -> Posterior:
    """`start`: the estimate so far, [batch, 3]; `scales`: of x, y and yaw."""
    values = [h.to(start) for h in definition.hypotheses()]
    valley = ScoreValley(features_map, definition)
    pose = start.detach()

    def search(axis: int, direction: Tensor) -> Tensor:
        nonlocal pose
        scores = line_zncc((bev, features_map), pose, axis, direction, definition)
        probability = torch.softmax(scores * scales[axis], dim=1)
        step = probability.detach() @ values[axis] - pose[:, axis]
        pose = pose + step[:, None] * direction
        return probability

    along_y = torch.eye(3).to(pose)[None, _Y].expand_as(pose)
    with torch.no_grad():
        search(_Y, along_y)
        search(_YAW, valley.along_yaw(pose))
        search(_X, valley.along_x(pose))
    y = search(_Y, along_y)
    first_yaw, along_yaw = pose[:, _YAW, None], valley.along_yaw(pose)
    yaw = search(_YAW, along_yaw)
    first_x, along_x = pose[:, _X, None], valley.along_x(pose)
    x = search(_X, along_x)

    turned, moved = values[_YAW] - first_yaw, values[_X] - first_x
    y = spread(y, values[_Y], yaw, along_yaw[:, _Y, None] * turned)
    y = spread(y, values[_Y], x, along_x[:, _Y, None] * moved)
    yaw = spread(yaw, values[_YAW], x, along_x[:, _YAW, None] * moved)
    return Posterior(x, y, yaw)
