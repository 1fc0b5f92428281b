"""The network's data flow, written once for everything that runs or writes it after training.

`run_images` and `run_map` walk through a trained network and hand each step to a backend: float
with recorded ranges (calibration), simulated int8 (golden vectors), or ONNX nodes (export).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

import torch
from torch import Tensor, nn

from training.errors import TrainingError
from training.model import RASTER_SCALE
from training.models.config import RESIDUAL_TRUNKS, VIEW_COLS, VIEW_ROWS, ModelConfig
from training.models.layers import ConvBn, Residual
from training.models.network import BevNetwork

T = TypeVar("T")

# Of the graph's raster, a power of two like the steps of all activations (training/quantize.py).
# The weights of the first convolution on it make up for training's 1 / 255.
RASTER_STEP = 1.0 / 256.0
RASTER_GAIN = RASTER_SCALE / RASTER_STEP
RASTER_LAYER = "map_encoder.layers.0"


@dataclass
class FoldedConv:
    """A convolution with its batch normalisation folded in."""

    name: str
    weight: Tensor  # [out, in, rows, cols]
    bias: Tensor  # [out]
    stride: int = 1

    @property
    def padding(self) -> int:
        return self.weight.shape[2] // 2


class Backend(Protocol[T]):
    def conv(self, x: T, conv: FoldedConv, relu: bool, residual: T | None = None) -> T:
        """Convolution, sum with `residual`, ReLU; the result is quantized."""

    def output(self, x: T, conv: FoldedConv, residual: T | None = None) -> T:
        """The same at the network's end: the result stays real."""

    def upsample(self, x: T) -> T: ...

    def gather(self, x: T, channels: int) -> T:
        """The view transform of `channels` feature channels; the result is quantized."""

    def space_to_depth(self, x: T) -> T:
        """Blocks of 2 x 2 into channels, in the order of torch.pixel_unshuffle."""

    def depth_to_space(self, x: T) -> T: ...


def check_walkable(config: ModelConfig) -> None:
    """Refuses a network with a part that no backend, and so no executor, can express."""
    parts = (
        ("trunk", config.trunk, RESIDUAL_TRUNKS),
        ("view transform", config.view, ("lut",)),
        ("BEV size", config.bev_size, ((VIEW_ROWS, VIEW_COLS),)),
    )
    for part, found, wanted in parts:
        if found not in wanted:
            raise TrainingError(
                f"network '{config.name}' cannot be exported: its {part} is {found}, and the "
                f"executor's graph has {', '.join(map(str, wanted))} only"
            )


def fold(name: str, module: ConvBn | nn.Conv2d) -> FoldedConv:
    if isinstance(module, nn.Conv2d):
        return FoldedConv(name, module.weight.detach().clone(), module.bias.detach().clone())
    bn = module.bn
    gain = (bn.weight / torch.sqrt(bn.running_var + bn.eps)).detach()
    weight = module.conv.weight.detach() * gain[:, None, None, None]
    bias = (bn.bias - bn.running_mean * gain).detach()
    return FoldedConv(name, weight, bias, module.conv.stride[0])


def folded_convolutions(net: BevNetwork) -> dict[str, FoldedConv]:
    """Every convolution of the network by its module's name; the raster counts in RASTER_STEP."""
    folded = {}
    for name, module in net.named_modules():
        if isinstance(module, ConvBn):
            folded[name] = fold(name, module)
    folded["head.second"] = fold("head.second", net.head.second)
    folded[RASTER_LAYER].weight *= RASTER_GAIN
    return folded


class Walk:
    """One pass through the network on one backend."""

    def __init__(
        self, net: BevNetwork, convolutions: dict[str, FoldedConv], backend: Backend[T]
    ) -> None:
        check_walkable(net.config)
        self._convolutions = convolutions
        self._names = {id(module): name for name, module in net.named_modules()}
        self._net = net
        self._backend = backend

    def _folded(self, module: nn.Module) -> FoldedConv:
        return self._convolutions[self._names[id(module)]]

    def _layer(self, module: nn.Module, x: T) -> T:
        if isinstance(module, ConvBn):
            return self._backend.conv(x, self._folded(module), module.relu)
        if isinstance(module, Residual):
            inner = self._backend.conv(x, self._folded(module.first), relu=True)
            second = self._folded(module.second)
            if module.linear:
                return self._backend.output(inner, second, residual=x)
            return self._backend.conv(inner, second, relu=True, residual=x)
        for child in module:
            x = self._layer(child, x)
        return x

    def run_images(self, images: T) -> tuple[T, T]:
        """-> F_B and the logits of the perceived mask."""
        trunk, backend = self._net.trunk, self._backend
        x8 = self._layer(trunk.stage8, self._layer(trunk.stage4, self._layer(trunk.stem, images)))
        up = backend.upsample(self._layer(trunk.lateral16, self._layer(trunk.stage16, x8)))
        merged = backend.conv(x8, self._folded(trunk.lateral8), relu=True, residual=up)
        view = backend.gather(self._layer(trunk.smooth, merged), trunk.smooth.conv.out_channels)
        bev = self._layer(self._net.bev_encoder, view)
        head = self._layer(self._net.head.first, bev)
        mask = backend.depth_to_space(backend.output(head, self._folded(self._net.head.second)))
        return self._layer(self._net.bev_compress, bev), mask

    def run_map(self, raster: T) -> T:
        """-> F_M."""
        x = self._backend.space_to_depth(raster)
        return self._layer(self._net.map_compress, self._layer(self._net.map_encoder.layers, x))
