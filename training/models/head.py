"""The paper's segmentation head."""

from __future__ import annotations

import torch.nn.functional as F
from torch import Tensor, nn

from training.models.config import RASTER_CHANNELS, ModelConfig
from training.models.layers import ConvBn, bias_of

_PAINT_LOGIT = -3.0  # initial bias: most cells hold no paint


class Head(nn.Module):
    """H: two convolutions and a pixel shuffle, [batch, width, *bev_size] -> mask logits
    [batch, 3, 400, 200]."""

    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        self.magnification = config.raster_reduction
        outputs = self.magnification**2 * RASTER_CHANNELS
        self.first = ConvBn(config.width, config.head_width)
        self.second = nn.Conv2d(config.head_width, outputs, 1)
        nn.init.constant_(bias_of(self.second), _PAINT_LOGIT)

    def forward(self, features: Tensor) -> Tensor:
        return F.pixel_shuffle(self.second(self.first(features)), self.magnification)
