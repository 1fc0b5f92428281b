"""EfficientNet-B0 (Tan and Le 2019). Parameter names are torchvision's, so that its weights can be
loaded."""

from __future__ import annotations

from dataclasses import dataclass

import torch.nn.functional as F
from torch import Tensor, nn

_SQUEEZE = 4  # input channels of a block per squeezed channel


@dataclass(frozen=True)
class _Stage:
    expansion: int
    size: int
    stride: int
    outputs: int
    blocks: int


_STEM = 32
_STAGES = (
    _Stage(1, 3, 1, 16, 1),
    _Stage(6, 3, 2, 24, 2),
    _Stage(6, 5, 2, 40, 2),
    _Stage(6, 3, 2, 80, 3),
    _Stage(6, 5, 1, 112, 3),
    _Stage(6, 5, 2, 192, 4),
    _Stage(6, 3, 1, 320, 1),
)


def _conv(
    inputs: int, outputs: int, size: int = 1, stride: int = 1, groups: int = 1, swish: bool = True
) -> nn.Sequential:
    convolution = nn.Conv2d(inputs, outputs, size, stride, size // 2, groups=groups, bias=False)
    layers: list[nn.Module] = [convolution, nn.BatchNorm2d(outputs)]
    return nn.Sequential(*layers, *([nn.SiLU(inplace=True)] if swish else []))


class SqueezeExcite(nn.Module):
    def __init__(self, channels: int, squeezed: int) -> None:
        super().__init__()
        self.fc1 = nn.Conv2d(channels, squeezed, 1)
        self.fc2 = nn.Conv2d(squeezed, channels, 1)

    def forward(self, x: Tensor) -> Tensor:
        mean = x.mean((2, 3), keepdim=True)
        return x * self.fc2(F.silu(self.fc1(mean))).sigmoid()


class MbConv(nn.Module):
    """Expand, depthwise convolution, squeeze-excite, project; with a skip if the shapes match."""

    def __init__(self, inputs: int, stage: _Stage, stride: int) -> None:
        super().__init__()
        hidden = stage.expansion * inputs
        self.block = nn.Sequential(
            *([_conv(inputs, hidden)] if hidden != inputs else []),
            _conv(hidden, hidden, stage.size, stride, groups=hidden),
            SqueezeExcite(hidden, inputs // _SQUEEZE),
            _conv(hidden, stage.outputs, swish=False),
        )
        self.skip = stride == 1 and inputs == stage.outputs

    def forward(self, x: Tensor) -> Tensor:
        return self.block(x) + x if self.skip else self.block(x)


class EfficientNetB0(nn.Module):
    """The backbone without the last 1x1 convolution and the classifier."""

    widths = (40, 112, 320)
    _TAPS = (3, 5, 7)  # layers of `features` after which strides 8, 16 and 32 are taken

    def __init__(self) -> None:
        super().__init__()
        layers = [_conv(3, _STEM, 3, 2)]
        inputs = _STEM
        for stage in _STAGES:
            blocks = []
            for block in range(stage.blocks):
                blocks.append(MbConv(inputs, stage, stage.stride if block == 0 else 1))
                inputs = stage.outputs
            layers.append(nn.Sequential(*blocks))
        self.features = nn.Sequential(*layers)

    def forward(self, images: Tensor) -> list[Tensor]:
        """[n, 3, rows, cols] -> features at strides 8, 16 and 32."""
        taps, x = [], images
        for i, layer in enumerate(self.features):
            x = layer(x)
            if i in self._TAPS:
                taps.append(x)
        return taps
