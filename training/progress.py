"""The figures of a run's log lines: mean losses, rate and time spent waiting."""

from __future__ import annotations

import torch
from torch import Tensor


class Progress:
    """Sums over the steps since the last log line, without the time of validations and
    checkpoints."""

    def __init__(self) -> None:
        self._losses: Tensor | float = 0.0
        self._steps, self._samples = 0, 0
        self._busy_s, self._waited_s = 0.0, 0.0

    def add(self, losses: Tensor, samples: int, busy_s: float, waited_s: float) -> None:
        """Adds a step that took busy_s, of which it waited waited_s for its samples."""
        self._losses = self._losses + losses
        self._steps += 1
        self._samples += samples
        self._busy_s += busy_s
        self._waited_s += waited_s

    def mean_losses(self) -> Tensor:
        return torch.as_tensor(self._losses / self._steps)

    @property
    def rate(self) -> float:
        """Samples per second."""
        return self._samples / self._busy_s

    @property
    def bottleneck(self) -> str:
        """The share of time spent waiting for samples. Near zero, the network limits the rate."""
        return f"{100 * self._waited_s / self._busy_s:.0f} % waiting for samples"
