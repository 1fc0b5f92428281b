"""The VGG-like encoder of the rasterised map."""

from __future__ import annotations

import torch.nn.functional as F
from torch import Tensor, nn

from training.models.config import RASTER_CHANNELS, ModelConfig
from training.models.layers import ConvBn


class MapEncoder(nn.Module):
    """raster [batch, 3, 400, 200] -> [batch, width, *bev_size]."""

    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        self.unshuffle = min(2, config.raster_reduction)
        stride = config.raster_reduction // self.unshuffle
        inputs = self.unshuffle**2 * RASTER_CHANNELS
        widths = (inputs, *config.map_widths, config.width)
        self.layers = nn.Sequential(
            *(
                ConvBn(before, after, stride=stride if layer == 1 else 1)
                for layer, (before, after) in enumerate(zip(widths, widths[1:]))
            )
        )

    def forward(self, raster: Tensor) -> Tensor:
        return self.layers(F.pixel_unshuffle(raster, self.unshuffle))
