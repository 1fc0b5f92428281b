"""The BEV encoder: residual blocks, and upsampling if the solver needs finer cells."""

from __future__ import annotations

from torch import nn

from training.models.config import ModelConfig
from training.models.layers import ConvBn, Residual


def make_bev_encoder(config: ModelConfig) -> nn.Module:
    """[batch, width, 100, 50] -> [batch, width, *bev_size]."""
    layers: list[nn.Module] = [Residual(config.width) for _ in range(config.bev_blocks)]
    magnification = config.view_magnification
    while magnification > 1:
        layers.append(nn.Upsample(scale_factor=2, mode="bilinear", align_corners=False))
        layers.append(ConvBn(config.width, config.width))
        magnification //= 2
    # A single block is not wrapped, because the parameter names of nano's checkpoints depend on it.
    return layers[0] if len(layers) == 1 else nn.Sequential(*layers)
