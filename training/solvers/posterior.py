"""Distributions over the hypotheses and the estimates derived from them."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from training.solvers.definition import DEFINITION, SolverDefinition, hypotheses


@dataclass(frozen=True)
class Posterior:
    """The distributions over the hypotheses of x, y and yaw, [batch, count] each."""

    x: Tensor
    y: Tensor
    yaw: Tensor

    def axes(self) -> tuple[Tensor, Tensor, Tensor]:
        return self.x, self.y, self.yaw


def joint_posterior(scores: Tensor, scale: Tensor) -> Posterior:
    """The marginals of P = softmax(scale * score) over all hypotheses, from their scores
    [batch, yaw, x, y]."""
    probability = torch.softmax((scores * scale).flatten(1), dim=1)
    volume = probability.reshape(scores.shape)
    return Posterior(volume.sum((1, 3)), volume.sum((1, 2)), volume.sum((2, 3)))


def posterior_mean(probability: Tensor, value_range: float, step: float) -> Tensor:
    return probability @ hypotheses(value_range, step).to(probability)


def estimate(posterior: Posterior, definition: SolverDefinition = DEFINITION) -> Tensor:
    """The means of the distributions (x m, y m, yaw rad), [batch, 3]."""
    means = [posterior_mean(p, *axis) for p, axis in zip(posterior.axes(), definition.axes())]
    return torch.stack(means, dim=1)


def best_hypotheses(posterior: Posterior, definition: SolverDefinition = DEFINITION) -> Tensor:
    """The most probable hypotheses (x m, y m, yaw rad), [batch, 3]. They have no gradient."""
    values = [h.to(p)[p.argmax(1)] for p, h in zip(posterior.axes(), definition.hypotheses())]
    return torch.stack(values, dim=1)


@dataclass(frozen=True)
class Solution:
    """A solver's result for a batch: estimate and standard deviation (x m, y m, yaw rad),
    [batch, 3] each, and the distributions."""

    estimate: Tensor
    deviation: Tensor
    posterior: Posterior

    @staticmethod
    def of(posterior: Posterior, definition: SolverDefinition = DEFINITION) -> Solution:
        """The means and standard deviations of the distributions."""
        means, deviations = estimate(posterior, definition), []
        for i, (probability, axis) in enumerate(zip(posterior.axes(), definition.axes())):
            square = probability @ hypotheses(*axis).to(probability).square()
            deviations.append((square - means[:, i].square()).clamp(min=1e-9).sqrt())
        return Solution(means, torch.stack(deviations, dim=1), posterior)
