"""A network for tests of quantization."""

from __future__ import annotations

import torch

from training.models.config import PRESETS
from training.models.network import BevNetwork


def untrained_network() -> BevNetwork:
    """With statistics in its normalisation that folding has to carry over."""
    torch.manual_seed(1)
    net = BevNetwork(PRESETS["nano"])
    for module in net.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            module.running_mean.normal_(0, 0.1)
            module.running_var.uniform_(0.5, 1.5)
            torch.nn.init.uniform_(module.weight, 0.5, 1.0)
            torch.nn.init.normal_(module.bias, 0, 0.1)
    return net.eval()
