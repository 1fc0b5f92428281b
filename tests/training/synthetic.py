"""Synthetic samples for the tests of training."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from training.data import Batch
from training.distributed import WHOLE, Share


def gradient_of(parameter: Tensor) -> Tensor:
    """The gradient of a parameter that has one."""
    assert parameter.grad is not None
    return parameter.grad


class SyntheticStream:
    """A stream of random samples. Sample i depends only on i, like the simulator's."""

    def __init__(self, first_sample: int, share: Share = WHOLE) -> None:
        self._next, self._stride = first_sample + share.index, share.count
        self.positions: list[int] = []

    def next(self, count: int) -> Batch:
        positions = [self._next + i * self._stride for i in range(count)]
        samples = [self._sample(position) for position in positions]
        self._next += count * self._stride
        self.positions += positions
        return Batch(**{name: torch.stack([s[name] for s in samples]) for name in samples[0]})

    @staticmethod
    def _sample(i: int) -> dict[str, Tensor]:
        g = torch.Generator().manual_seed(i)
        raster = (torch.rand(3, 400, 200, generator=g) < 0.03).to(torch.uint8) * 255
        weight = torch.rand(8, 5000, generator=g)
        limits = torch.tensor([2.0, 1.0, math.radians(2.0)])
        return {
            "images": torch.randint(0, 256, (6, 3, 96, 320), generator=g, dtype=torch.uint8),
            "camera_mask": torch.tensor(63, dtype=torch.uint8),
            "raster_prior": raster,
            "raster_truth": raster.roll(2, 1),
            "correction": (2 * torch.rand(3, generator=g) - 1) * limits,
            "index": torch.randint(0, 2880, (8, 5000), generator=g),
            "weight": weight / weight.sum(0),
        }

    def close(self) -> None:
        pass
