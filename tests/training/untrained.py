"""An untrained network for tests of quantization."""

from __future__ import annotations

import torch

from training.models.config import PRESETS
from training.models.layers import running_statistics
from training.models.network import BevNetwork


def untrained_network() -> BevNetwork:
    """A network with random statistics in its batch normalisation, so that folding has an
    effect."""
    torch.manual_seed(1)
    net = BevNetwork(PRESETS["nano"])
    for module in net.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            mean, variance = running_statistics(module)
            mean.normal_(0, 0.1)
            variance.uniform_(0.5, 1.5)
            torch.nn.init.uniform_(module.weight, 0.5, 1.0)
            torch.nn.init.normal_(module.bias, 0, 0.1)
    return net.eval()
