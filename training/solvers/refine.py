"""Refines an estimate with the full score, on standardised features.

Three rounds search the hypotheses of y, yaw and x, one axis after the other in this order, with the
ZNCC (zncc.py) on a line through the current estimate. Axes that have already been searched follow
along the valley of the score (valley.py, evaluated at the current estimate): y while yaw is
searched, y and yaw while x is searched. Scored poses are clamped to the range of the hypotheses. A
search gives P = softmax(scale * ZNCC) with refine_x_scale, refine_y_scale or refine_yaw_scale; the
next search starts at its mean.

The two coarse rounds use every tenth cell (lattice.py) and half of each scale, because the score of
fewer cells is noisier. They only provide the start of the last round and exclude hypotheses from
it. Two are needed, because the first one searches y and yaw at an x that may still be wrong. The
first round scores all hypotheses. The second round and the last round, which uses every second
cell, score only hypotheses with at least 0.01 of the largest probability of the round before. The
total probability of the scored hypotheses is redistributed among them; the others keep theirs.

The resulting distributions are marginals. P_x is the result of a round's last search. The
distribution of an axis v that followed a searched axis w is convolved with the distribution of w:
P(v) = sum over i of P_w(i) P_v(v - slope (w_i - w_0)), where w_0 is the start of the search and
slope = dv/dw; linear between hypotheses; probability that would leave the range stays at its end.
P_y is convolved with yaw and then with x, P_yaw with x. The estimate is the mean of the last
round's distributions. The start and the direction of a search and the results of the coarse rounds
get no gradient.
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
    """ZNCC of F_B and F_M for the hypotheses of one axis, [batch, count], on the line through
    `pose` along `direction`, both [batch, 3]."""
    offset = definition.hypotheses()[axis].to(pose) - pose[:, axis, None]
    corrections = pose[:, None] + offset[..., None] * direction[:, None]
    farthest = torch.tensor(definition.farthest()).to(corrections)
    corrections = torch.maximum(torch.minimum(corrections, farthest), -farthest)
    return moved_zncc(*sides, corrections, definition.cell_m, lattice)


def convolve_along(
    probability: Tensor, values: Tensor, followed: Tensor, offset: Tensor
) -> Tensor:
    """Convolves the distribution [batch, count] of an axis with that of the axis it followed,
    [batch, n]. `values` [count]: the hypotheses of the axis; `offset` [batch, n]: its displacement
    at each hypothesis of the followed axis."""
    last = len(values) - 1
    step = values[1] - values[0]
    position = torch.arange(last + 1).to(offset) + offset[..., None] / step  # [batch, n, count]
    position = position.clamp(0, last)
    # NaN needs a valid index here; `above` passes the NaN on to the result.
    low = position.nan_to_num().floor().clamp(max=last - 1)
    above = (position - low).to(probability)
    share = followed[..., None] * probability[:, None]
    result = torch.zeros_like(probability)
    result = result.scatter_add(1, low.long().flatten(1), ((1 - above) * share).flatten(1))
    return result.scatter_add(1, low.long().flatten(1) + 1, (above * share).flatten(1))


def redistribute(scores: Tensor, likely: Tensor, probability: Tensor) -> Tensor:
    """Redistributes the total probability of the `likely` hypotheses among them in proportion to
    softmax(scores). The others keep theirs. All arguments are [batch, count]."""
    together = (probability * likely).sum(1, keepdim=True)
    shares = torch.softmax(scores.masked_fill(~likely, -torch.inf), dim=1)
    return torch.where(likely, together * shares, probability)


class _Rounds:
    """Executes rounds of searches, starting at `pose` [batch, 3]."""

    def __init__(
        self, sides: tuple[Tensor, Tensor], pose: Tensor, definition: SolverDefinition
    ) -> None:
        self._sides = sides
        self._pose = pose
        self._definition = definition
        self._values = [h.to(pose) for h in definition.hypotheses()]
        self._valley = ScoreValley(sides[1], definition)

    def run(
        self, scales: list[Tensor], lattice: CellLattice, before: Posterior | None
    ) -> Posterior:
        """One round. `before`: the distributions of the round before; None: score all
        hypotheses."""
        along_y = torch.eye(3).to(self._pose)[None, _Y].expand_as(self._pose)

        def search(axis: int, direction: Tensor) -> Tensor:
            scores = line_zncc(
                self._sides, self._pose, axis, direction, self._definition, lattice
            )
            scores = scores * scales[axis]
            if before is None:
                probability = torch.softmax(scores, dim=1)
            else:
                earlier = before.axes()[axis]
                least = _LEAST_LIKELY * earlier.amax(1, keepdim=True)
                probability = redistribute(scores, earlier >= least, earlier)
            mean = probability.detach() @ self._values[axis]
            self._pose = self._pose + (mean - self._pose[:, axis])[:, None] * direction
            return probability

        y = search(_Y, along_y)
        first_yaw, along_yaw = self._pose[:, _YAW, None], self._valley.along_yaw(self._pose)
        yaw = search(_YAW, along_yaw)
        first_x, along_x = self._pose[:, _X, None], self._valley.along_x(self._pose)
        x = search(_X, along_x)

        turned, moved = self._values[_YAW] - first_yaw, self._values[_X] - first_x
        y = convolve_along(y, self._values[_Y], yaw, along_yaw[:, _Y, None] * turned)
        y = convolve_along(y, self._values[_Y], x, along_x[:, _Y, None] * moved)
        yaw = convolve_along(yaw, self._values[_YAW], x, along_x[:, _YAW, None] * moved)
        return Posterior(x, y, yaw)


def refine(
    bev: Tensor,
    features_map: Tensor,
    start: Tensor,
    scales: tuple[Tensor, ...],
    definition: SolverDefinition,
) -> Posterior:
    """The refined distributions. `start`: the initial estimate, [batch, 3]; `scales`: the softmax
    scales of x, y and yaw."""
    rounds = _Rounds((bev, features_map), start.detach(), definition)
    with torch.no_grad():
        coarse_scales = [_COARSE_SCALE * scale for scale in scales]
        coarse = rounds.run(coarse_scales, EVERY_TENTH_CELL, None)
        coarse = rounds.run(coarse_scales, EVERY_TENTH_CELL, coarse)
    return rounds.run(list(scales), EVERY_SECOND_CELL, coarse)
