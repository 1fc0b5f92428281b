"""BiFPN (Tan, Pang and Le 2020) as used by BeMapNet: five levels, strides 8 to 128."""

from __future__ import annotations

from collections.abc import Sequence

import torch
import torch.nn.functional as F
from torch import Tensor, nn

_EPSILON = 1e-4


def _lateral(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(nn.Conv2d(inputs, outputs, 1), nn.BatchNorm2d(outputs))


def _halve(x: Tensor) -> Tensor:
    return F.max_pool2d(x, 3, 2, 1)


class Fusion(nn.Module):
    """A weighted mean of feature maps (learned weights >= 0), swish and a separable convolution."""

    def __init__(self, inputs: int, width: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.ones(inputs))
        self.depthwise = nn.Conv2d(width, width, 3, 1, 1, groups=width, bias=False)
        self.pointwise = nn.Conv2d(width, width, 1)
        self.bn = nn.BatchNorm2d(width)

    def forward(self, *maps: Tensor) -> Tensor:
        weight = F.relu(self.weight)
        weight = weight / (weight.sum() + _EPSILON)
        mean = sum(w * x for w, x in zip(weight, maps))
        return self.bn(self.pointwise(self.depthwise(F.silu(mean))))


class BiFpnCell(nn.Module):
    """One top-down and one bottom-up pass over the levels. `skips`: feature maps that the bottom-up
    pass adds at each level (only in the first cell do they differ from the inputs)."""

    def __init__(self, levels: int, width: int) -> None:
        super().__init__()
        self.down = nn.ModuleList(Fusion(2, width) for _ in range(levels - 1))
        self.up = nn.ModuleList(Fusion(3, width) for _ in range(levels - 2))
        self.top = Fusion(2, width)

    def forward(self, inputs: Sequence[Tensor], skips: Sequence[Tensor]) -> list[Tensor]:
        """`inputs` and `skips` are ordered from fine to coarse; skips[0] is not used."""
        middle = [inputs[-1]]
        for level, fuse in zip(reversed(inputs[:-1]), self.down):
            above = F.interpolate(middle[-1], level.shape[2:], mode="nearest")
            middle.append(fuse(level, above))
        middle.reverse()
        outputs = [middle[0]]
        for skip, inner, fuse in zip(skips[1:], middle[1:], self.up):
            outputs.append(fuse(skip, inner, _halve(outputs[-1])))
        return [*outputs, self.top(skips[-1], _halve(outputs[-1]))]


class BiFpn(nn.Module):
    LEVELS = 5

    def __init__(self, widths: tuple[int, int, int], width: int, cells: int) -> None:
        super().__init__()
        self.lateral = nn.ModuleList(_lateral(inputs, width) for inputs in widths)
        self.skip = nn.ModuleList(_lateral(inputs, width) for inputs in widths[1:])
        self.coarser = _lateral(widths[-1], width)
        self.cells = nn.ModuleList(BiFpnCell(self.LEVELS, width) for _ in range(cells))

    def forward(self, features: Sequence[Tensor]) -> list[Tensor]:
        """Features at strides 8, 16 and 32 -> five levels, strides 8, 16, 32, 64 and 128."""
        level6 = _halve(self.coarser(features[-1]))
        coarse = [level6, _halve(level6)]
        levels = [lateral(x) for lateral, x in zip(self.lateral, features)] + coarse
        skips = [levels[0], *(skip(x) for skip, x in zip(self.skip, features[1:])), *coarse]
        for cell in self.cells:
            levels = cell(levels, skips)
            skips = levels
        return levels
