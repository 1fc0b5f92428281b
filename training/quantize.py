"""Post-training quantization: int8 weights per channel, 8-bit activations per tensor.

Weights are limited to 7 bits (|q| <= 63), because on processors without VNNI the sum of two
products of uint8 and int8 saturates. Activations are uint8 after ReLU and int8 elsewhere, zero
point 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import torch
import torch.nn.functional as F
from torch import Tensor

from training.data import Batch
from training.evaluate import Inference
from training.graph import FoldedConv, Walk, folded_convolutions
from training.model import (
    IMAGE_SCALE,
    RASTER_SCALE,
    Nano,
    gather_views,
    real_images,
    real_raster,
)

MAX_WEIGHT = 63
MAX_UNSIGNED, MAX_SIGNED = 255, 127
_SAMPLED_VALUES = 5_000  # of an activation and batch


@dataclass
class Scale:
    """real = scale * element; uint8 elements if `unsigned`, else int8."""

    scale: float
    unsigned: bool

    def quantize(self, x: Tensor) -> Tensor:
        """The real values that x becomes."""
        low, high = (0, MAX_UNSIGNED) if self.unsigned else (-MAX_SIGNED - 1, MAX_SIGNED)
        return torch.clamp(torch.round(x / self.scale), low, high) * self.scale


@dataclass
class QuantizedConv:
    """int8 weights [out, in, rows, cols] with a scale per output channel, and the real bias."""

    weight: Tensor
    scale: Tensor
    bias: Tensor

    def real_weight(self) -> Tensor:
        return self.weight.float() * self.scale[:, None, None, None]


@dataclass
class Quantization:
    """Everything that turns the float network into the int8 one."""

    convolutions: dict[str, FoldedConv]
    quantized: dict[str, QuantizedConv] = field(default_factory=dict)
    activations: dict[str, Scale] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """What cannot be had from the network's checkpoint."""
        state = {
            "quantized": {name: vars(conv) for name, conv in self.quantized.items()},
            "activations": {name: vars(scale) for name, scale in self.activations.items()},
        }
        torch.save(state, path)

    @staticmethod
    def load(net: Nano, path: Path) -> Quantization:
        """Of the network that it was saved for."""
        state = torch.load(path, map_location="cpu")
        return Quantization(
            folded_convolutions(net),
            {name: QuantizedConv(**conv) for name, conv in state["quantized"].items()},
            {name: Scale(**scale) for name, scale in state["activations"].items()},
        )


class FloatBackend:
    """Runs in float; subclasses change the weights and look at the activations."""

    def __init__(self, batch: Batch) -> None:
        self._batch = batch

    def _weights(self, conv: FoldedConv) -> tuple[Tensor, Tensor]:
        return conv.weight, conv.bias

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        return x

    def _compute(self, x: Tensor, conv: FoldedConv, residual: Tensor | None) -> Tensor:
        weight, bias = self._weights(conv)
        y = F.conv2d(x, weight, bias, conv.stride, conv.padding)
        return y if residual is None else y + residual

    def conv(
        self, x: Tensor, conv: FoldedConv, relu: bool, residual: Tensor | None = None
    ) -> Tensor:
        y = self._compute(x, conv, residual)
        return self._activation(conv.name, F.relu(y) if relu else y, relu)

    def output(self, x: Tensor, conv: FoldedConv, residual: Tensor | None = None) -> Tensor:
        return self._compute(x, conv, residual)

    def upsample(self, x: Tensor) -> Tensor:
        return F.interpolate(x, scale_factor=2, mode="nearest")

    def gather(self, x: Tensor, channels: int) -> Tensor:
        bev = gather_views(x, self._batch.index, self._batch.weight)
        return self._activation("view", bev, unsigned=True)

    def space_to_depth(self, x: Tensor) -> Tensor:
        return F.pixel_unshuffle(x, 2)

    def depth_to_space(self, x: Tensor) -> Tensor:
        return F.pixel_shuffle(x, 4)


class _Recorder(FloatBackend):
    """Keeps a sample of every activation's values."""

    def __init__(self, batch: Batch, seen: dict[str, list[Tensor]], unsigned: dict[str, bool]):
        super().__init__(batch)
        self._seen, self._unsigned = seen, unsigned

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        flat = x.flatten()
        self._unsigned[name] = unsigned
        picked = torch.randint(len(flat), (_SAMPLED_VALUES,))
        extremes = torch.stack(flat.aminmax())
        self._seen.setdefault(name, []).append(torch.cat((flat[picked], extremes)))
        return x


class Int8Backend(FloatBackend):
    """Computes in float what the int8 network computes: rounded weights, rounded activations."""

    def __init__(self, batch: Batch, quantization: Quantization) -> None:
        super().__init__(batch)
        self._quantization = quantization

    def _weights(self, conv: FoldedConv) -> tuple[Tensor, Tensor]:
        quantized = self._quantization.quantized[conv.name]
        return quantized.real_weight(), quantized.bias

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        return self._quantization.activations[name].quantize(x)


class _BiasRounder:
    """Rounds each bias to whole steps of input times weight, as int32 holds it. Its tensors are the
    scales of their elements; None: real values."""

    def __init__(self, quantization: Quantization) -> None:
        self._quantization = quantization

    def conv(
        self, x: Scale, conv: FoldedConv, relu: bool, residual: Scale | None = None
    ) -> Scale:
        self.output(x, conv)
        return self._quantization.activations[conv.name]

    def output(self, x: Scale, conv: FoldedConv, residual: Scale | None = None) -> None:
        quantized = self._quantization.quantized[conv.name]
        step = quantized.scale * x.scale
        quantized.bias = torch.round(quantized.bias / step) * step

    def upsample(self, x: Scale) -> Scale:
        return x

    def gather(self, x: Scale, channels: int) -> Scale:
        return self._quantization.activations["view"]

    def space_to_depth(self, x: Scale) -> Scale:
        return x

    def depth_to_space(self, x: None) -> None:
        return x


def best_scale(values: Tensor, unsigned: bool) -> Scale:
    """The scale with the least squared error of rounding and clipping."""
    levels = MAX_UNSIGNED if unsigned else MAX_SIGNED
    largest = float(values.abs().max().clamp(min=1e-6))
    candidates = [Scale(largest * i / 80 / levels, unsigned) for i in range(8, 81)]

    def error(scale: Scale) -> float:
        return float((scale.quantize(values) - values).square().mean())

    return min(candidates, key=error)


def quantize_weights(conv: FoldedConv) -> QuantizedConv:
    """The scale of each output channel has the least squared error among clipped ones."""
    rows = conv.weight.flatten(1)
    # Where next to nothing is added to the bias, the bias must still fit into int32 steps.
    largest = torch.maximum(rows.abs().amax(1), 1e-4 * conv.bias.abs()).clamp(min=1e-8)
    best_error, best = torch.full_like(largest, float("inf")), largest / MAX_WEIGHT
    for ratio in torch.linspace(0.6, 1.0, 41).tolist():
        scale = largest * ratio / MAX_WEIGHT
        rounded = torch.clamp(torch.round(rows / scale[:, None]), -MAX_WEIGHT, MAX_WEIGHT)
        error = (rounded * scale[:, None] - rows).square().sum(1)
        better = error < best_error
        best_error, best = torch.where(better, error, best_error), torch.where(better, scale, best)
    elements = torch.clamp(torch.round(rows / best[:, None]), -MAX_WEIGHT, MAX_WEIGHT)
    return QuantizedConv(elements.reshape(conv.weight.shape).to(torch.int8), best, conv.bias)


@torch.no_grad()
def quantize(net: Nano, calibration: list[Batch]) -> Quantization:
    """Scales from calibration batches of the training range."""
    net.eval()
    torch.manual_seed(0)  # of the values that the recorder picks
    result = Quantization(folded_convolutions(net))
    seen: dict[str, list[Tensor]] = {}
    unsigned: dict[str, bool] = {}
    for batch in calibration:
        run(net, result.convolutions, _Recorder(batch, seen, unsigned), batch)
    for name, values in seen.items():
        result.activations[name] = best_scale(torch.cat(values), unsigned[name])
    for name, conv in result.convolutions.items():
        result.quantized[name] = quantize_weights(conv)
    rounder, inputs = Walk(net, result.convolutions, _BiasRounder(result)), input_scales()
    rounder.run_images(inputs["images"])
    rounder.run_map(inputs["raster"])
    return result


@torch.no_grad()
def run(
    net: Nano, convolutions: dict[str, FoldedConv], backend: FloatBackend, batch: Batch
) -> tuple[Tensor, Tensor, Tensor]:
    """F_B, F_M and the logits of the perceived mask on a backend."""
    walk = Walk(net, convolutions, backend)
    images = real_images(batch.images).flatten(0, 1)
    bev, mask = walk.run_images(images)
    return bev, walk.run_map(real_raster(batch.raster_prior)), mask


def int8_inference(net: Nano, quantization: Quantization) -> Inference:
    """The quantized network for training.evaluate."""

    def infer(batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        backend = Int8Backend(batch, quantization)
        return run(net, quantization.convolutions, backend, batch)

    return infer


def input_scales() -> dict[str, Scale]:
    """images int8 and raster uint8: how the graph's inputs become real."""
    return {"images": Scale(IMAGE_SCALE, False), "raster": Scale(RASTER_SCALE, True)}
