"""Measures the quantization error of each layer: if only this one is quantized, and if all are."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import torch
from torch import Tensor

from training.data import Batch
from training.graph import FoldedConv, Walk
from training.models.network import BevNetwork
from training.quantize import FloatBackend, Int8Backend, Quantization, graph_inputs, run

Pair = tuple[Tensor, Tensor]  # exact and quantized values
OptionalPair = tuple[Tensor, Tensor] | tuple[None, None]


@dataclass
class LayerError:
    """The error of one layer. dB: ratio of signal to quantization noise, infinite if the values do
    not change."""

    name: str
    largest_weight: float | None  # None: the layer has no weights
    largest_output: float
    step: float | None  # None: the output stays real
    saturated: float | None  # share of output values that are clipped; None: the output stays real
    alone_db: float  # of the output: exact input, only this layer quantized
    together_db: float  # of the output: all layers quantized
    bev_db: float  # of F_B: only this layer quantized
    map_db: float  # of F_M: only this layer quantized


@dataclass
class _Noise:
    signal: float = 0.0
    noise: float = 0.0

    def add(self, exact: Tensor, rounded: Tensor) -> None:
        self.signal += float(exact.square().sum())
        self.noise += float((rounded - exact).square().sum())

    def decibels(self) -> float:
        if self.noise == 0:
            return math.inf
        return 10 * math.log10(self.signal / self.noise) if self.signal > 0 else -math.inf


@dataclass
class _Seen:
    """Statistics of a layer's output."""

    alone: _Noise = field(default_factory=_Noise)
    together: _Noise = field(default_factory=_Noise)
    largest: float = 0.0
    clipped: int = 0
    values: int = 0


class _Pairs:
    """Backend that carries the exact and the quantized values side by side and compares them."""

    def __init__(
        self, batch: Batch, quantization: Quantization, seen: dict[str, _Seen]
    ) -> None:
        self._exact, self._int8 = FloatBackend(batch), Int8Backend(batch, quantization)
        self._activations = quantization.activations
        self._seen = seen

    def _compare(self, name: str, exact: Tensor, alone: Tensor, together: Tensor) -> Pair:
        seen = self._seen.setdefault(name, _Seen())
        seen.alone.add(exact, alone)
        seen.together.add(exact, together)
        seen.largest = max(seen.largest, float(exact.abs().max()))
        seen.values += exact.numel()
        if name in self._activations:
            seen.clipped += int(self._activations[name].clips(exact).sum())
        return exact, together

    def conv(self, x: Pair, conv: FoldedConv, relu: bool, residual: Pair | None = None) -> Pair:
        skip: OptionalPair = (None, None) if residual is None else residual
        return self._compare(
            conv.name,
            self._exact.conv(x[0], conv, relu, skip[0]),
            self._int8.conv(x[0], conv, relu, skip[0]),
            self._int8.conv(x[1], conv, relu, skip[1]),
        )

    def output(self, x: Pair, conv: FoldedConv, residual: Pair | None = None) -> Pair:
        skip: OptionalPair = (None, None) if residual is None else residual
        return self._compare(
            conv.name,
            self._exact.output(x[0], conv, skip[0]),
            self._int8.output(x[0], conv, skip[0]),
            self._int8.output(x[1], conv, skip[1]),
        )

    def gather(self, x: Pair, channels: int) -> Pair:
        return self._compare(
            "view",
            self._exact.gather(x[0], channels),
            self._int8.gather(x[0], channels),
            self._int8.gather(x[1], channels),
        )

    def upsample(self, x: Pair) -> Pair:
        return self._exact.upsample(x[0]), self._exact.upsample(x[1])

    def space_to_depth(self, x: Pair) -> Pair:
        return self._exact.space_to_depth(x[0]), self._exact.space_to_depth(x[1])

    def depth_to_space(self, x: Pair) -> Pair:
        return self._exact.depth_to_space(x[0]), self._exact.depth_to_space(x[1])


class _OneLayer(Int8Backend):
    """Quantizes one layer only."""

    def __init__(self, batch: Batch, quantization: Quantization, name: str) -> None:
        super().__init__(batch, quantization)
        self._name = name

    def _weights(self, conv: FoldedConv) -> tuple[Tensor, Tensor]:
        return super()._weights(conv) if conv.name == self._name else (conv.weight, conv.bias)

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        return super()._activation(name, x, unsigned) if name == self._name else x


def _walk_in_pairs(
    net: BevNetwork, quantization: Quantization, batches: list[Batch]
) -> dict[str, _Seen]:
    seen: dict[str, _Seen] = {}
    for batch in batches:
        walk = Walk(net, quantization.convolutions, _Pairs(batch, quantization, seen))
        images, raster = graph_inputs(batch)
        walk.run_images((images, images))
        walk.run_map((raster, raster))
    return seen


def _effect(
    net: BevNetwork,
    quantization: Quantization,
    name: str,
    batches: list[Batch],
    exact: list[tuple[Tensor, Tensor]],
) -> tuple[float, float]:
    """Signal-to-noise ratio in dB of F_B and F_M when only the layer `name` is quantized."""
    noises = _Noise(), _Noise()
    for batch, sides in zip(batches, exact):
        backend = _OneLayer(batch, quantization, name)
        rounded = run(net, quantization.convolutions, backend, batch)
        for noise, a, b in zip(noises, sides, rounded):
            noise.add(a, b)
    return noises[0].decibels(), noises[1].decibels()


@torch.no_grad()
def layer_errors(
    net: BevNetwork, quantization: Quantization, batches: list[Batch]
) -> list[LayerError]:
    """The errors of all layers, in the order in which the network computes them."""
    convolutions, activations = quantization.convolutions, quantization.activations
    exact = [run(net, convolutions, FloatBackend(batch), batch)[:2] for batch in batches]
    errors = []
    for name, seen in _walk_in_pairs(net, quantization, batches).items():
        bev_db, map_db = _effect(net, quantization, name, batches, exact)
        conv, scale = convolutions.get(name), activations.get(name)
        errors.append(
            LayerError(
                name,
                None if conv is None else float(conv.weight.abs().max()),
                seen.largest,
                None if scale is None else scale.scale,
                None if scale is None else seen.clipped / seen.values,
                seen.alone.decibels(),
                seen.together.decibels(),
                bev_db,
                map_db,
            )
        )
    return errors
