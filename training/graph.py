"""The data flow of the exported network, written once for calibration, simulated int8 and export.

`Walk.run_images` and `Walk.run_map` go through a trained network and pass each step to a backend:
float that records ranges (calibration), simulated int8 (golden vectors) or ONNX nodes (export).
"""

from __future__ import annotations

from dataclasses import dataclass
from collections.abc import Iterable
from typing import Generic, Protocol, TypeVar

import torch
from torch import Tensor, nn

from training.errors import TrainingError
from training.model import RASTER_SCALE
from training.models.config import RESIDUAL_TRUNKS, VIEW_COLS, VIEW_ROWS, ModelConfig
from training.models.layers import ConvBn, Residual, bias_of, running_statistics
from training.models.network import BevNetwork
from training.models.trunks import ResidualTrunk

T = TypeVar("T")

# Step of the raster in the graph: a power of two like the steps of all activations
# (training/quantize.py). Training uses 1 / 255; the weights of RASTER_LAYER compensate for that.
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
    """Executes or records the steps of a walk; T is its tensor type."""

    def conv(self, x: T, conv: FoldedConv, relu: bool, residual: T | None = None) -> T:
        """Convolution, sum with `residual`, ReLU. The result is quantized."""

    def output(self, x: T, conv: FoldedConv, residual: T | None = None) -> T:
        """Convolution and sum with `residual` at the network's end. The result stays real."""

    def upsample(self, x: T) -> T: ...

    def gather(self, x: T, channels: int) -> T:
        """View transform of `channels` feature channels. The result is quantized."""

    def space_to_depth(self, x: T) -> T:
        """Moves blocks of 2 x 2 into channels, in the order of torch.pixel_unshuffle."""

    def depth_to_space(self, x: T) -> T: ...


def check_exportable(config: ModelConfig) -> None:
    """TrainingError if the network has a part that the backends and the executor do not support."""
    parts = (
        ("trunk", config.trunk, RESIDUAL_TRUNKS),
        ("view transform", config.view, ("lut",)),
        ("BEV size", config.bev_size, ((VIEW_ROWS, VIEW_COLS),)),
    )
    for part, found, wanted in parts:
        if found not in wanted:
            raise TrainingError(
                f"network '{config.name}' cannot be exported: its {part} is {found}, but the "
                f"executor supports only {', '.join(map(str, wanted))}"
            )


def fold(name: str, module: ConvBn | nn.Conv2d) -> FoldedConv:
    if isinstance(module, nn.Conv2d):
        return FoldedConv(name, module.weight.detach().clone(), bias_of(module).detach().clone())
    bn = module.bn
    mean, variance = running_statistics(bn)
    gain = (bn.weight / torch.sqrt(variance + bn.eps)).detach()
    weight = module.conv.weight.detach() * gain[:, None, None, None]
    bias = (bn.bias - mean * gain).detach()
    return FoldedConv(name, weight, bias, module.conv.stride[0])


def folded_convolutions(net: BevNetwork) -> dict[str, FoldedConv]:
    """Every convolution of the network by its module's name. RASTER_LAYER expects a raster in units
    of RASTER_STEP."""
    folded = {}
    for name, module in net.named_modules():
        if isinstance(module, ConvBn):
            folded[name] = fold(name, module)
    folded["head.second"] = fold("head.second", net.head.second)
    folded[RASTER_LAYER].weight *= RASTER_GAIN
    return folded


def submodule_convolution(net: BevNetwork, name: str) -> ConvBn | nn.Conv2d:
    """The module that folded_convolutions() lists under `name`."""
    module = net.get_submodule(name)
    assert isinstance(module, (ConvBn, nn.Conv2d))
    return module


class Walk(Generic[T]):
    """Passes the steps of a network to one backend."""

    def __init__(
        self, net: BevNetwork, convolutions: dict[str, FoldedConv], backend: Backend[T]
    ) -> None:
        check_exportable(net.config)
        assert isinstance(net.trunk, ResidualTrunk)
        self._convolutions = convolutions
        self._names = {id(module): name for name, module in net.named_modules()}
        self._net = net
        self._trunk = net.trunk
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
        assert isinstance(module, nn.Sequential)
        layers: Iterable[nn.Module] = module
        for layer in layers:
            x = self._layer(layer, x)
        return x

    def run_images(self, images: T) -> tuple[T, T]:
        """-> F_B and the logits of the perceived mask."""
        trunk, backend = self._trunk, self._backend
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
