"""Full neural matching (paper, section III-D, eq. 4 and 5): the reference for all other solvers.

The score of a hypothesis (a, x, y) is the ZNCC (zncc.py) of F_M with F_B moved under it
(features.py) in one bilinear interpolation. P = softmax(joint_scale * ZNCC) over all hypotheses.
The marginals of P are the distributions of x, y and yaw; the estimates are their means.
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.utils.checkpoint import checkpoint

from training.solvers.definition import SolverDefinition
from training.solvers.zncc import moved_zncc


def full_scores(bev: Tensor, features_map: Tensor, definition: SolverDefinition) -> Tensor:
    """ZNCC of every hypothesis, [batch, yaw, x, y]. The backward pass recomputes the moved features
    of one yaw at a time, because storing those of all yaws would take gigabytes."""
    x, y, yaws = definition.hypotheses()
    positions = torch.cartesian_prod(x, y).to(bev.device)

    def scores_at(yaw: Tensor, bev: Tensor, features_map: Tensor) -> Tensor:
        corrections = torch.cat((positions, yaw.expand(len(positions), 1)), dim=1)
        return moved_zncc(bev, features_map, corrections[None], definition.cell_m)

    scores = [
        checkpoint(scores_at, yaw, bev, features_map, use_reentrant=False)
        for yaw in yaws.to(bev.device)
    ]
    return torch.stack(scores, dim=1).reshape(len(bev), len(yaws), len(x), len(y))
