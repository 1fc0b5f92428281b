"""The layers that several parts of the networks use."""

from __future__ import annotations

import math
from typing import TypeVar

import torch
import torch.nn.functional as F
from torch import Tensor, nn

_TEMPERATURE = 1e4
ModuleType = TypeVar("ModuleType", bound=nn.Module)


def channels_last(module: ModuleType) -> ModuleType:
    """Stores a module's weights with the channels last, which is faster on the CPU."""
    # PyTorch 1.13 does not declare this overload.
    return module.to(memory_format=torch.channels_last)  # type: ignore[call-overload]


def bias_of(layer: nn.Conv2d) -> Tensor:
    """The bias of a convolution that has one."""
    assert layer.bias is not None
    return layer.bias


def running_statistics(bn: nn.BatchNorm2d) -> tuple[Tensor, Tensor]:
    """The running mean and variance of a batch normalisation that tracks them."""
    assert bn.running_mean is not None and bn.running_var is not None
    return bn.running_mean, bn.running_var


class ConvBn(nn.Module):
    """Convolution, batch normalisation and, unless `relu` is False, ReLU."""

    def __init__(
        self, inputs: int, outputs: int, size: int = 3, stride: int = 1, relu: bool = True
    ):
        super().__init__()
        self.conv = nn.Conv2d(inputs, outputs, size, stride, size // 2, bias=False)
        self.bn = nn.BatchNorm2d(outputs)
        self.relu = relu

    def forward(self, x: Tensor) -> Tensor:
        x = self.bn(self.conv(x))
        return F.relu(x, inplace=True) if self.relu else x


class Residual(nn.Module):
    """Two 3x3 convolutions with a skip; ReLU after the sum unless the block is `linear`."""

    def __init__(self, channels: int, linear: bool = False):
        super().__init__()
        self.first = ConvBn(channels, channels)
        self.second = ConvBn(channels, channels, relu=False)
        self.linear = linear

    def forward(self, x: Tensor) -> Tensor:
        y = self.second(self.first(x)) + x
        return y if self.linear else F.relu(y, inplace=True)


class Attention(nn.Module):
    """Multi-head attention of every query to every key. Keys have no bias, because softmax would
    cancel it."""

    def __init__(self, width: int, heads: int, dropout: float) -> None:
        super().__init__()
        self.heads = heads
        self.query = nn.Linear(width, width)
        self.key = nn.Linear(width, width, bias=False)
        self.value = nn.Linear(width, width)
        self.output = nn.Linear(width, width)
        self.dropout = nn.Dropout(dropout)
        for layer in (self.query, self.key, self.value, self.output):
            nn.init.xavier_uniform_(layer.weight)

    def forward(
        self, query: Tensor, key: Tensor, value: Tensor, hidden_keys: Tensor | None = None
    ) -> Tensor:
        """query [batch, n, width], key and value [batch, m, width], hidden_keys bool [batch, m]
        (True: the key is ignored) -> [batch, n, width]. If all keys are hidden, the result is the
        mean over all keys."""
        q, k, v = (
            self._split(layer(x))
            for layer, x in ((self.query, query), (self.key, key), (self.value, value))
        )
        logits = (q / math.sqrt(q.shape[-1])) @ k.transpose(2, 3)
        if hidden_keys is not None:
            lowest = torch.finfo(logits.dtype).min
            logits = logits.masked_fill(hidden_keys[:, None, None], lowest)
        mixed = self.dropout(torch.softmax(logits, dim=-1)) @ v
        return self.output(mixed.transpose(1, 2).flatten(2))

    def _split(self, x: Tensor) -> Tensor:
        """[batch, n, width] -> [batch, heads, n, width / heads]."""
        return x.unflatten(2, (self.heads, -1)).transpose(1, 2)


def sine_encoding(x_m: Tensor, y_m: Tensor, width: int) -> Tensor:
    """Ground positions [...] in metres -> [..., width]: sines and cosines of y, then of x. The
    positions are not normalised (BeMapNet, utils/position_encoding.py)."""
    octaves = torch.arange(width // 4, dtype=torch.float32, device=x_m.device)
    frequency = _TEMPERATURE ** (-4.0 * octaves / width)
    angles = (axis[..., None] * frequency for axis in (y_m, x_m))
    return torch.cat([wave for a in angles for wave in (a.sin(), a.cos())], dim=-1)


def cell_centres(rows: int, cols: int, cell_m: tuple[float, float]) -> tuple[Tensor, Tensor]:
    """x and y of the centres of BEV cells, [rows, cols] each. Row 0 is the far front, column 0 the
    far left. `cell_m`: cell size along x and along y."""
    x = (0.5 * rows - 0.5 - torch.arange(rows)) * cell_m[0]
    y = (0.5 * cols - 0.5 - torch.arange(cols)) * cell_m[1]
    return x[:, None].expand(rows, cols), y[None].expand(rows, cols)
