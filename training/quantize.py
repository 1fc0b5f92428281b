"""Post-training quantization: int8 weights per channel, 8-bit activations per tensor.

Weights are limited to 7 bits (|q| <= 63), because the sum of two products of uint8 and int8
saturates on processors without VNNI. Activations are uint8 after ReLU and int8 elsewhere, with zero
point 0.

Scales of activations are powers of two and scales of weights have short mantissas. Then every
product and nearly every sum is exact in float32 as well, so any runtime rounds the same numbers, no
matter whether it computes in integers or floats and in which order (docs/quantization.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional

import torch
import torch.nn.functional as F
from torch import Tensor

from training.data import Batch
from training.evaluate import Inference
from training.graph import RASTER_STEP, Backend, FoldedConv, Walk, folded_convolutions
from training.model import IMAGE_SCALE, real_images
from training.models.network import BevNetwork
from training.models.view_lut import gather_views

MAX_WEIGHT = 63
MAX_UNSIGNED, MAX_SIGNED = 255, 127
SCALE_BITS = 6  # mantissa bits of a weight's scale
_CANDIDATES = 5  # scales tried for an activation; each one halves the largest value it can hold
_BIAS_BATCHES = 8  # upper limit, because bias correction processes them as one batch
_SAMPLED_VALUES = 20_000  # values kept per activation and batch


@dataclass
class Scale:
    """real = scale * element. Elements are uint8 if `unsigned`, else int8."""

    scale: float
    unsigned: bool

    def limits(self) -> tuple[int, int]:
        """The smallest and the largest element."""
        return (0, MAX_UNSIGNED) if self.unsigned else (-MAX_SIGNED - 1, MAX_SIGNED)

    def quantize(self, x: Tensor) -> Tensor:
        """x, rounded and clipped to the values that elements can hold."""
        return torch.clamp(torch.round(x / self.scale), *self.limits()) * self.scale

    def clips(self, x: Tensor) -> Tensor:
        """Where x lies outside the range of the elements, bool."""
        low, high = self.limits()
        return (x < low * self.scale) | (x > high * self.scale)


@dataclass
class QuantizedConv:
    """int8 weights [out, in, rows, cols], a scale per output channel and the real-valued bias."""

    weight: Tensor
    scale: Tensor
    bias: Tensor

    def real_weight(self) -> Tensor:
        return self.weight.float() * self.scale[:, None, None, None]


@dataclass
class Quantization:
    """Everything that defines the int8 network: folded convolutions, their quantized weights, and
    the scales of the activations, each by name."""

    convolutions: dict[str, FoldedConv]
    quantized: dict[str, QuantizedConv] = field(default_factory=dict)
    activations: dict[str, Scale] = field(default_factory=dict)

    def state(self) -> dict[str, Any]:
        """What cannot be recomputed from the network's weights, for a checkpoint."""
        return {
            "quantized": {name: vars(conv) for name, conv in self.quantized.items()},
            "activations": {name: vars(scale) for name, scale in self.activations.items()},
        }

    def save(self, path: Path) -> None:
        torch.save(self.state(), path)

    @staticmethod
    def load(net: BevNetwork, path: Path) -> Quantization:
        return Quantization.of_state(net, torch.load(path, map_location="cpu"))

    @staticmethod
    def of_state(net: BevNetwork, state: dict[str, Any]) -> Quantization:
        """Restores a state() of the same network."""
        return Quantization(
            folded_convolutions(net),
            {name: QuantizedConv(**conv) for name, conv in state["quantized"].items()},
            {name: Scale(**scale) for name, scale in state["activations"].items()},
        )


class FloatBackend:
    """Runs the network in float. Subclasses replace the weights and process the activations."""

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
    """Records a random sample of every activation's values."""

    def __init__(self, batch: Batch, seen: dict[str, list[Tensor]], unsigned: dict[str, bool]):
        super().__init__(batch)
        self._seen, self._unsigned = seen, unsigned

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        flat = x.flatten()
        self._unsigned[name] = unsigned
        picked = torch.randint(len(flat), (_SAMPLED_VALUES,))
        self._seen.setdefault(name, []).append(flat[picked])
        return x


class Int8Backend(FloatBackend):
    """Simulates the int8 network in float: rounded weights and rounded activations."""

    def __init__(self, batch: Batch, quantization: Quantization) -> None:
        super().__init__(batch)
        self._quantization = quantization

    def _weights(self, conv: FoldedConv) -> tuple[Tensor, Tensor]:
        quantized = self._quantization.quantized[conv.name]
        return quantized.real_weight(), quantized.bias

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        return self._quantization.activations[name].quantize(x)


class _MeanRecorder(FloatBackend):
    """Records the mean of every convolution's output per channel, before the activation."""

    def __init__(self, batch: Batch) -> None:
        super().__init__(batch)
        self.means: dict[str, Tensor] = {}

    def _compute(self, x: Tensor, conv: FoldedConv, residual: Tensor | None) -> Tensor:
        y = super()._compute(x, conv, residual)
        self.means[conv.name] = y.mean((0, 2, 3))
        return y


class _BiasCorrector(Int8Backend):
    """Shifts each bias so that the mean of its channel equals that of the float network. Later
    layers already see the corrected outputs of earlier ones."""

    def __init__(
        self, batch: Batch, quantization: Quantization, means: dict[str, Tensor]
    ) -> None:
        super().__init__(batch, quantization)
        self._means = means

    def _compute(self, x: Tensor, conv: FoldedConv, residual: Tensor | None) -> Tensor:
        y = super()._compute(x, conv, residual)
        missing = self._means[conv.name] - y.mean((0, 2, 3))
        quantized = self._quantization.quantized[conv.name]
        quantized.bias = quantized.bias + missing
        return y + missing[:, None, None]


class _BiasSteps(Backend[Optional[Scale]]):
    """Collects the step of every bias, which is the input's scale times the weights' scale. The
    tensors of this backend are scales; None stands for real values."""

    def __init__(self, quantization: Quantization) -> None:
        self._quantization = quantization
        self.steps: dict[str, Tensor] = {}

    def conv(
        self, x: Scale | None, conv: FoldedConv, relu: bool, residual: Scale | None = None
    ) -> Scale | None:
        self.output(x, conv)
        return self._quantization.activations[conv.name]

    def output(
        self, x: Scale | None, conv: FoldedConv, residual: Scale | None = None
    ) -> Scale | None:
        assert x is not None
        self.steps[conv.name] = self._quantization.quantized[conv.name].scale * x.scale
        return None

    def upsample(self, x: Scale | None) -> Scale | None:
        return x

    def gather(self, x: Scale | None, channels: int) -> Scale | None:
        return self._quantization.activations["view"]

    def space_to_depth(self, x: Scale | None) -> Scale | None:
        return x

    def depth_to_space(self, x: Scale | None) -> Scale | None:
        return x


def bias_steps(net: BevNetwork, quantization: Quantization) -> dict[str, Tensor]:
    """The step of each convolution's bias, [out]. The model file stores biases as int32 multiples
    of their step."""
    backend, inputs = _BiasSteps(quantization), input_scales()
    walk = Walk(net, quantization.convolutions, backend)
    walk.run_images(inputs["images"])
    walk.run_map(inputs["raster"])
    return backend.steps


def round_bias(bias: Tensor, step: Tensor) -> Tensor:
    return torch.round(bias / step) * step


def best_scale(values: Tensor, unsigned: bool) -> Scale:
    """The power of two with the least squared error of rounding and clipping."""
    levels = MAX_UNSIGNED if unsigned else MAX_SIGNED
    largest = float(values.abs().max().clamp(min=1e-6))
    unclipped = math.ceil(math.log2(largest / levels))
    candidates = [Scale(2.0 ** (unclipped - i), unsigned) for i in range(_CANDIDATES)]

    def error(scale: Scale) -> float:
        return float((scale.quantize(values) - values).square().mean())

    return min(candidates, key=error)


def round_weights(weight: Tensor, scale: Tensor) -> Tensor:
    """The 7-bit elements of weights [out, ...] for a scale per output channel [out]."""
    per_channel = scale.reshape(-1, *[1] * (weight.ndim - 1))
    return torch.clamp(torch.round(weight / per_channel), -MAX_WEIGHT, MAX_WEIGHT)


def _shortened(scale: Tensor) -> Tensor:
    """The scale, rounded up to a mantissa of SCALE_BITS."""
    mantissa, exponent = torch.frexp(scale)
    return torch.ldexp(torch.ceil(mantissa * 2**SCALE_BITS) / 2**SCALE_BITS, exponent)


def quantize_weights(conv: FoldedConv) -> QuantizedConv:
    """Quantizes weights. For each output channel it takes the scale with the least squared error
    among candidates with short mantissas; scales that clip are candidates too."""
    rows = conv.weight.flatten(1)
    # A lower limit, so that the bias of a channel with tiny weights still fits into int32 steps.
    largest = torch.maximum(rows.abs().amax(1), 1e-4 * conv.bias.abs()).clamp(min=1e-8)
    best_error, best = torch.full_like(largest, float("inf")), torch.empty_like(largest)
    for ratio in torch.linspace(0.6, 1.0, 41).tolist():
        scale = _shortened(largest * ratio / MAX_WEIGHT)
        error = (round_weights(rows, scale) * scale[:, None] - rows).square().sum(1)
        better = error < best_error
        best_error, best = torch.where(better, error, best_error), torch.where(better, scale, best)
    return QuantizedConv(round_weights(conv.weight, best).to(torch.int8), best, conv.bias)


def correct_biases(net: BevNetwork, quantization: Quantization, batch: Batch) -> None:
    """Removes the mean rounding error of each channel (Nagel et al. 2019, "Data-free quantization
    through weight equalization and bias correction", section 4.2, with measured means)."""
    recorder = _MeanRecorder(batch)
    run(net, quantization.convolutions, recorder, batch)
    corrector = _BiasCorrector(batch, quantization, recorder.means)
    run(net, quantization.convolutions, corrector, batch)


@torch.no_grad()
def quantize(net: BevNetwork, calibration: list[Batch]) -> Quantization:
    """Quantizes a network; scales and biases come from the calibration batches."""
    net.eval()
    torch.manual_seed(0)  # for the values that _Recorder samples
    result = Quantization(folded_convolutions(net))
    seen: dict[str, list[Tensor]] = {}
    unsigned: dict[str, bool] = {}
    for batch in calibration:
        run(net, result.convolutions, _Recorder(batch, seen, unsigned), batch)
    for name, values in seen.items():
        result.activations[name] = best_scale(torch.cat(values), unsigned[name])
    for name, conv in result.convolutions.items():
        result.quantized[name] = quantize_weights(conv)
    stride = math.ceil(len(calibration) / _BIAS_BATCHES)
    correct_biases(net, result, Batch.joined(calibration[::stride]))
    for name, step in bias_steps(net, result).items():
        result.quantized[name].bias = round_bias(result.quantized[name].bias, step)
    return result


def graph_inputs(batch: Batch) -> tuple[Tensor, Tensor]:
    """The inputs of a walk as real values: images [n * 6, 3, 96, 320], raster [n, 3, 400, 200]."""
    return real_images(batch.images).flatten(0, 1), batch.raster_prior.float() * RASTER_STEP


def run(
    net: BevNetwork, convolutions: dict[str, FoldedConv], backend: Backend[Tensor], batch: Batch
) -> tuple[Tensor, Tensor, Tensor]:
    """F_B, F_M and the logits of the perceived mask, computed by a backend."""
    walk = Walk(net, convolutions, backend)
    images, raster = graph_inputs(batch)
    bev, mask = walk.run_images(images)
    return bev, walk.run_map(raster), mask


def int8_inference(net: BevNetwork, quantization: Quantization) -> Inference:
    """The simulated int8 network."""

    def infer(batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        backend = Int8Backend(batch, quantization)
        return run(net, quantization.convolutions, backend, batch)

    return infer


def input_scales() -> dict[str, Scale]:
    """The scales of the graph's inputs, images int8 and raster uint8."""
    return {"images": Scale(IMAGE_SCALE, False), "raster": Scale(RASTER_STEP, True)}
