"""What the lines of a run's log tell: mean losses, rate, and what the time went to."""

from __future__ import annotations

from torch import Tensor


class Progress:
    """Sums over the steps since the last line. Validation and checkpoints are left out."""

    def __init__(self) -> None:
        self._losses: Tensor | float = 0.0
        self._steps, self._samples = 0, 0
        self._busy_s, self._waited_s = 0.0, 0.0

    def add(self, losses: Tensor, samples: int, busy_s: float, waited_s: float) -> None:
        """A step of `samples` that took busy_s, waited_s of it for the samples."""
        self._losses = self._losses + losses
        self._steps += 1
        self._samples += samples
        self._busy_s += busy_s
        self._waited_s += waited_s

    def mean_losses(self) -> Tensor:
        return self._losses / self._steps

    @property
    def rate(self) -> float:
        """Samples per second."""
        return self._samples / self._busy_s

    @property
    def bottleneck(self) -> str:
        """Where samples come at once, the network is what limits the rate."""
        return f"{100 * self._waited_s / self._busy_s:.0f} % waiting for samples"
