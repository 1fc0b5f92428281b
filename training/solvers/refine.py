"""One more look at a solution, with the full score, of standardised features.

Three rounds of ZNCC (zncc.py) through the estimate so far, each one pass along y, yaw and x, in
this order, over hypotheses of each axis. What has been searched follows along the score's valley
(valley.py, at the estimate so far): y while yaw is searched, y and yaw while x is. No pose that is
scored lies beyond the farthest hypotheses. Each search gives P = softmax(scale * ZNCC), with
refine_x_scale, refine_y_scale or refine_yaw_scale, and goes on from its mean.

Two coarse rounds score every tenth cell (lattice.py) with half of each scale, for of fewer cells the
score is noisier. They only say where the last one begins and what it need not look at; there are
two, as y and yaw of the first are searched at an x that it then finds to be wrong. The first scores
all hypotheses, the second and the last, which sees every second cell, those to which the round
before left at least 0.01 of the greatest probability. These share what they were left together; the
others keep theirs.

The distributions are marginals: P_x is that of a round's last search. What followed an axis is
spread by it,
P(v) = sum over i of P_followed(i) P_search(v - slope (value_i - where the search began)), linear
between hypotheses, and what leaves an axis stays at its end: P_y by yaw and then by x, P_yaw by x.
The means of the last round's are the estimate. Where a search begins and goes along, and what the
coarse rounds leave, get no gradient.
"""

from __future__ import annotations

import torch
from torch import Tensor

from training.solvers.definition import SolverDefinition
from training.solvers.lattice import EVERY_SECOND_CELL, EVERY_TENTH_CELL, CellLattice
from training.solvers.posterior import Posterior
from training.solvers.valley import ScoreValley
from training.solvers.zncc import moved_zncc

_X, _Y, _YAW = 0, 1, 2
_COARSE_SCALE = 0.5
_LEAST_LIKELY = 1e-2


def line_zncc(
    sides: tuple[Tensor, Tensor],
    pose: Tensor,
    axis: int,
    direction: Tensor,
    definition: SolverDefinition,
    lattice: CellLattice,
) -> Tensor:
    """ZNCC of F_B and F_M over the hypotheses of one axis, [batch, count], along `direction`
    through `pose`, both [batch, 3]."""
    offset = definition.hypotheses()[axis].to(pose) - pose[:, axis, None]
    corrections = pose[:, None] + offset[..., None] * direction[:, None]
    farthest = torch.tensor(definition.farthest()).to(corrections)
    corrections = torch.maximum(torch.minimum(corrections, farthest), -farthest)
    return moved_zncc(*sides, corrections, definition.cell_m, lattice)


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


def share_out(scores: Tensor, likely: Tensor, probability: Tensor) -> Tensor:
    """What the `likely` hypotheses have of `probability` together, shared out among them in
    proportion to softmax(scores). The others keep what they have. All [batch, count]."""
    together = (probability * likely).sum(1, keepdim=True)
    shares = torch.softmax(scores.masked_fill(~likely, -torch.inf), dim=1)
    return torch.where(likely, together * shares, probability)


class _Passes:
    """One round after the other, from `pose` [batch, 3] on."""

    def __init__(
        self, sides: tuple[Tensor, Tensor], pose: Tensor, definition: SolverDefinition
    ) -> None:
        self._sides = sides
        self._pose = pose
        self._definition = definition
        self._values = [h.to(pose) for h in definition.hypotheses()]
        self._valley = ScoreValley(sides[1], definition)

    def go_through(
        self, scales: list[Tensor], lattice: CellLattice, before: Posterior | None
    ) -> Posterior:
        """One round. Without distributions from before it scores all hypotheses."""
        along_y = torch.eye(3).to(self._pose)[None, _Y].expand_as(self._pose)
        axes = (None, None, None) if before is None else before.axes()

        def search(axis: int, direction: Tensor) -> Tensor:
            scores = line_zncc(
                self._sides, self._pose, axis, direction, self._definition, lattice
            )
            scores = scores * scales[axis]
            if axes[axis] is None:
                probability = torch.softmax(scores, dim=1)
            else:
                least = _LEAST_LIKELY * axes[axis].amax(1, keepdim=True)
                probability = share_out(scores, axes[axis] >= least, axes[axis])
            mean = probability.detach() @ self._values[axis]
            self._pose = self._pose + (mean - self._pose[:, axis])[:, None] * direction
            return probability

        y = search(_Y, along_y)
        first_yaw, along_yaw = self._pose[:, _YAW, None], self._valley.along_yaw(self._pose)
        yaw = search(_YAW, along_yaw)
        first_x, along_x = self._pose[:, _X, None], self._valley.along_x(self._pose)
        x = search(_X, along_x)

        turned, moved = self._values[_YAW] - first_yaw, self._values[_X] - first_x
        y = spread(y, self._values[_Y], yaw, along_yaw[:, _Y, None] * turned)
        y = spread(y, self._values[_Y], x, along_x[:, _Y, None] * moved)
        yaw = spread(yaw, self._values[_YAW], x, along_x[:, _YAW, None] * moved)
        return Posterior(x, y, yaw)


def refine(
    bev: Tensor,
    features_map: Tensor,
    start: Tensor,
    scales: tuple[Tensor, ...],
    definition: SolverDefinition,
) -> Posterior:
    """`start`: the estimate so far, [batch, 3]; `scales`: of x, y and yaw."""
    passes = _Passes((bev, features_map), start.detach(), definition)
    with torch.no_grad():
        coarse_scales = [_COARSE_SCALE * scale for scale in scales]
        coarse = passes.go_through(coarse_scales, EVERY_TENTH_CELL, None)
        coarse = passes.go_through(coarse_scales, EVERY_TENTH_CELL, coarse)
    return passes.go_through(list(scales), EVERY_SECOND_CELL, coarse)
