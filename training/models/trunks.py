"""The trunks: ResNet-like ones with dense convolutions, which int8 hardware runs best, and pyramid
trunks on published backbones."""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.models.bifpn import BiFpn
from training.models.config import ModelConfig
from training.models.efficientnet import EfficientNetB0
from training.models.layers import ConvBn, Residual
from training.models.resnet50 import ResNet50


@dataclass(frozen=True)
class TrunkSize:
    stem: int
    widths: tuple[int, int, int]  # at strides 4, 8 and 16
    blocks: tuple[int, int, int]


_SIZES = {
    "nano": TrunkSize(12, (24, 40, 80), (1, 2, 2)),
    "small": TrunkSize(24, (48, 96, 192), (1, 3, 3)),
    "base": TrunkSize(32, (64, 128, 256), (2, 3, 3)),
}
_BACKBONES: dict[str, type[ResNet50] | type[EfficientNetB0]] = {
    "resnet50": ResNet50,
    "efficientnet_b0": EfficientNetB0,
}


def _stage(inputs: int, outputs: int, blocks: int) -> nn.Sequential:
    return nn.Sequential(
        ConvBn(inputs, outputs, stride=2), *(Residual(outputs) for _ in range(blocks))
    )


class ResidualTrunk(nn.Module):
    """Image features at stride 8, to which those at stride 16 are added."""

    def __init__(self, size: TrunkSize, outputs: int) -> None:
        super().__init__()
        width4, width8, width16 = size.widths
        self.stem = ConvBn(3, size.stem, stride=2)
        self.stage4 = _stage(size.stem, width4, size.blocks[0])
        self.stage8 = _stage(width4, width8, size.blocks[1])
        self.stage16 = _stage(width8, width16, size.blocks[2])
        self.lateral8 = ConvBn(width8, outputs, 1, relu=False)
        self.lateral16 = ConvBn(width16, outputs, 1, relu=False)
        self.smooth = ConvBn(outputs, outputs)

    def forward(self, images: Tensor) -> Tensor:
        """[n, 3, rows, cols] -> [n, outputs, rows / 8, cols / 8]."""
        x8 = self.stage8(self.stage4(self.stem(images)))
        x16 = self.lateral16(self.stage16(x8))
        up = F.interpolate(x16, scale_factor=2, mode="nearest")
        return self.smooth(F.relu(self.lateral8(x8) + up, inplace=True))


class PyramidTrunk(nn.Module):
    """A published backbone and a BiFPN, whose levels are resampled to one grid and mixed."""

    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        self.grid = config.feature_grid
        self.backbone = _BACKBONES[config.trunk]()
        self.neck = BiFpn(self.backbone.widths, config.pyramid_width, config.pyramid_cells)
        self.mix = nn.Conv2d(BiFpn.LEVELS * config.pyramid_width, config.width, 1)

    def forward(self, images: Tensor) -> Tensor:
        """[n, 3, rows, cols] -> [n, width, *grid]."""
        levels = self.neck(self.backbone(images))
        same = [
            F.interpolate(level, self.grid, mode="bilinear", align_corners=False)
            for level in levels
        ]
        return self.mix(torch.cat(same, dim=1))


def make_trunk(config: ModelConfig) -> nn.Module:
    if config.trunk in _SIZES:
        return ResidualTrunk(_SIZES[config.trunk], config.width)
    return PyramidTrunk(config)
