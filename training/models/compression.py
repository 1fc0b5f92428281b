"""Compresses BEV features to the channels that the solver compares."""

from __future__ import annotations

from torch import nn

from training.models.config import ModelConfig
from training.models.layers import ConvBn, Residual


def make_compression(config: ModelConfig) -> nn.Sequential:
    """The paper's three residual blocks before the solver. The last one is linear, because features
    are signed."""
    channels = config.channels
    return nn.Sequential(
        ConvBn(config.width, channels),
        Residual(channels),
        Residual(channels),
        Residual(channels, linear=True),
    )
