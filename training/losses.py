"""The losses of the paper's section III-E."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

from training.solver import DEFINITION, Posterior

POSITIVE_WEIGHT = 2.0
BCE_WEIGHT = 3.0


def semantic_loss(logits: Tensor, target: Tensor) -> Tensor:
    """3 BCE + dice of masks [batch, 3, 400, 200] against targets in [0, 1]."""
    weight = torch.tensor(POSITIVE_WEIGHT, device=logits.device)
    bce = F.binary_cross_entropy_with_logits(logits, target, pos_weight=weight)
    probability = torch.sigmoid(logits)
    overlap = (probability * target).sum(dim=(0, 2, 3))
    total = probability.sum(dim=(0, 2, 3)) + target.sum(dim=(0, 2, 3))
    dice = 1 - (2 * overlap + 1) / (total + 1)
    return BCE_WEIGHT * bce + dice.mean()


def sample_1d(probability: Tensor, value: Tensor, value_range: float, step: float) -> Tensor:
    """The probability of `value` [batch] in a distribution [batch, count], interpolated linearly
    between hypotheses; values outside the range count as the nearest hypothesis."""
    last = probability.shape[1] - 1
    position = ((value + value_range) / step).clamp(0, last)
    low = position.floor().clamp(max=last - 1).long()
    fraction = position - low
    pair = probability.gather(1, torch.stack((low, low + 1), dim=1))
    return (1 - fraction) * pair[:, 0] + fraction * pair[:, 1]


def pose_losses(posterior: Posterior, correction: Tensor) -> Tensor:
    """-log P(truth) along x, y and yaw (eq. 14), [batch, 3]; correction [batch, 3]."""
    losses = []
    for axis, probability in enumerate(posterior.axes()):
        truth = sample_1d(probability, correction[:, axis], *DEFINITION.axes()[axis])
        losses.append(-torch.log(truth + 1e-8))
    return torch.stack(losses, dim=1)


def intersection_over_union(logits: Tensor, target: Tensor) -> tuple[Tensor, Tensor]:
    """Cells in the intersection and in the union per class, [3] each; sum both over a data set."""
    found, wanted = logits > 0, target > 0.5
    return (found & wanted).sum((0, 2, 3)), (found | wanted).sum((0, 2, 3))
