"""The network `nano`: plain convolutions and one gather, so that an int8 executor can run it all.

    images int8 [6, 3, 96, 320] -> trunk -> [48, 12, 40] a camera -> gather by the view table
      -> BEV encoder -> [48, 100, 50] -> three residual blocks -> F_B [16, 100, 50]
    raster [3, 400, 200] -> map encoder -> [48, 100, 50] -> three residual blocks -> F_M
    head H on either 48-channel feature -> masks [3, 400, 200]
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.models.layers import ConvBn, Residual
from training.solver import PoseSolvers

CAMERAS, IMAGE_ROWS, IMAGE_COLS = 6, 96, 320
FEATURE_ROWS, FEATURE_COLS = 12, 40
BEV_ROWS, BEV_COLS = 100, 50
VIEW_SLOTS = 8
RASTER_CHANNELS = 3
IMAGE_OFFSET, IMAGE_SCALE = 128, 1.0 / 64.0
RASTER_SCALE = 1.0 / 255.0


class Trunk(nn.Module):
    """Image features at stride 8, with stride 16 added to them."""

    def __init__(self, outputs: int = 48):
        super().__init__()
        self.stem = ConvBn(3, 12, stride=2)
        self.stage4 = nn.Sequential(ConvBn(12, 24, stride=2), Residual(24))
        self.stage8 = nn.Sequential(ConvBn(24, 40, stride=2), Residual(40), Residual(40))
        self.stage16 = nn.Sequential(ConvBn(40, 80, stride=2), Residual(80), Residual(80))
        self.lateral8 = ConvBn(40, outputs, 1, relu=False)
        self.lateral16 = ConvBn(80, outputs, 1, relu=False)
        self.smooth = ConvBn(outputs, outputs)

    def forward(self, images: Tensor) -> Tensor:
        x8 = self.stage8(self.stage4(self.stem(images)))
        x16 = self.lateral16(self.stage16(x8))
        up = F.interpolate(x16, scale_factor=2, mode="nearest")
        return self.smooth(F.relu(self.lateral8(x8) + up, inplace=True))


def gather_views(features: Tensor, index: Tensor, weight: Tensor) -> Tensor:
    """The view transform: features [batch * 6, C, 12, 40], index and weight [batch, 8, 5000]
    -> sum over slots of weight * feature, [batch, C, 100, 50]."""
    batch, channels = index.shape[0], features.shape[1]
    cells = CAMERAS * FEATURE_ROWS * FEATURE_COLS
    table = features.permute(0, 2, 3, 1).reshape(batch * cells, channels).float()
    offset = torch.arange(batch, device=index.device)[:, None, None] * cells
    keys = (index + offset).permute(0, 2, 1).reshape(-1, VIEW_SLOTS)
    weights = weight.permute(0, 2, 1).reshape(-1, VIEW_SLOTS)
    bev = F.embedding_bag(keys, table, per_sample_weights=weights, mode="sum")
    return bev.reshape(batch, BEV_ROWS, BEV_COLS, channels).permute(0, 3, 1, 2)


def compress(inputs: int, outputs: int) -> nn.Sequential:
    """The paper's three residual blocks before the solver. The last is linear: features are
    signed."""
    return nn.Sequential(
        ConvBn(inputs, outputs),
        Residual(outputs),
        Residual(outputs),
        Residual(outputs, linear=True),
    )


class MapEncoder(nn.Module):
    """VGG-like: raster [batch, 3, 400, 200] -> [batch, 48, 100, 50]."""

    def __init__(self, outputs: int = 48):
        super().__init__()
        self.layers = nn.Sequential(
            ConvBn(4 * RASTER_CHANNELS, 16), ConvBn(16, 32, stride=2), ConvBn(32, outputs)
        )

    def forward(self, raster: Tensor) -> Tensor:
        return self.layers(F.pixel_unshuffle(raster, 2))


class Head(nn.Module):
    """H: two convolutions and a pixel shuffle to mask logits."""

    def __init__(self, inputs: int = 48):
        super().__init__()
        self.first = ConvBn(inputs, 32)
        self.second = nn.Conv2d(32, 16 * RASTER_CHANNELS, 1)

    def forward(self, features: Tensor) -> Tensor:
        return F.pixel_shuffle(self.second(self.first(features)), 4)


class Nano(nn.Module):
    """Everything that is learned, the solvers' scales included."""

    def __init__(self, width: int = 48, channels: int = 16):
        super().__init__()
        self.trunk = Trunk(width)
        self.bev_encoder = Residual(width)
        self.bev_compress = compress(width, channels)
        self.map_encoder = MapEncoder(width)
        self.map_compress = compress(width, channels)
        self.head = Head(width)
        self.solvers = PoseSolvers()
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")
        nn.init.constant_(self.head.second.bias, -3.0)  # paint is rare

    def perceive(self, images: Tensor, index: Tensor, weight: Tensor) -> Tensor:
        """images [batch, 6, 3, 96, 320], real values -> BEV features [batch, 48, 100, 50]."""
        features = self.trunk(images.flatten(0, 1))
        return self.bev_encoder(gather_views(features, index, weight))

    def forward(
        self, images: Tensor, index: Tensor, weight: Tensor, raster: Tensor
    ) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """-> F_B, F_M, logits of the perceived and of the reconstructed mask."""
        bev = self.perceive(images, index, weight)
        encoded = self.map_encoder(raster)
        perceived, reconstructed = self.head(torch.cat((bev, encoded))).chunk(2)
        return self.bev_compress(bev), self.map_compress(encoded), perceived, reconstructed


def real_images(images: Tensor) -> Tensor:
    """RGB uint8 -> the network's real values: (RGB - 128) / 64."""
    return (images.float() - IMAGE_OFFSET) * IMAGE_SCALE


def real_raster(raster: Tensor) -> Tensor:
    return raster.float() * RASTER_SCALE
