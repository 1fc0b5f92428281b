"""The quantized network with gradients. The forward pass computes what the int8 network computes.
The backward pass treats rounding as the identity (straight-through estimator); clipped values get
no gradient."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from training.data import Batch
from training.graph import RASTER_GAIN, RASTER_LAYER, FoldedConv, submodule_convolution
from training.models.layers import ConvBn, bias_of, running_statistics
from training.models.network import BevNetwork
from training.quantize import (
    MAX_WEIGHT,
    FloatBackend,
    Quantization,
    QuantizedConv,
    bias_steps,
    round_bias,
    round_weights,
    run,
)


class _StraightThrough(torch.autograd.Function):
    """Returns `rounded` for x. The gradient passes to x except where x was clipped."""

    @staticmethod
    def forward(  # type: ignore[override]  # named arguments in place of *args
        ctx: Any, x: Tensor, rounded: Tensor, clipped: Tensor
    ) -> Tensor:
        ctx.save_for_backward(clipped)
        return rounded.clone()

    @staticmethod
    def backward(  # type: ignore[override]  # named argument in place of *args
        ctx: Any, gradient: Tensor
    ) -> tuple[Tensor, None, None]:
        (clipped,) = ctx.saved_tensors
        return gradient.masked_fill(clipped, 0.0), None, None


class _Backend(FloatBackend):
    def __init__(self, batch: Batch, network: FakeQuantized) -> None:
        super().__init__(batch)
        self._network = network

    def _weights(self, conv: FoldedConv) -> tuple[Tensor, Tensor]:
        rounded = self._network.rounded(conv)
        clipped = conv.weight.abs() > MAX_WEIGHT * rounded.scale[:, None, None, None]
        return (
            _StraightThrough.apply(conv.weight, rounded.real_weight(), clipped),
            _StraightThrough.apply(conv.bias, rounded.bias, torch.zeros_like(conv.bias).bool()),
        )

    def _activation(self, name: str, x: Tensor, unsigned: bool) -> Tensor:
        scale = self._network.activations[name]
        return _StraightThrough.apply(x, scale.quantize(x), scale.clips(x))


class FakeQuantized:
    """A network that computes what its int8 model computes. It learns the folded weights and
    biases. The scales stay as calibrated: they are optimal for the initial weights."""

    def __init__(self, net: BevNetwork, quantization: Quantization) -> None:
        self.net = net
        self.convolutions = quantization.convolutions
        self.activations = quantization.activations
        self._weight_scales = {n: conv.scale for n, conv in quantization.quantized.items()}
        self._bias_steps = bias_steps(net, quantization)
        for name, conv in self.convolutions.items():
            conv.bias = quantization.quantized[name].bias.clone()  # the corrected bias
            conv.weight.requires_grad_()
            conv.bias.requires_grad_()

    def parameters(self) -> list[Tensor]:
        return [p for conv in self.convolutions.values() for p in (conv.weight, conv.bias)]

    def __call__(self, batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        """F_B, F_M and the logits of the perceived mask."""
        return run(self.net, self.convolutions, _Backend(batch, self), batch)

    @torch.no_grad()
    def rounded(self, conv: FoldedConv) -> QuantizedConv:
        scale = self._weight_scales[conv.name]
        elements = round_weights(conv.weight, scale).to(torch.int8)
        return QuantizedConv(elements, scale, round_bias(conv.bias, self._bias_steps[conv.name]))

    @torch.no_grad()
    def finish(self) -> Quantization:
        """The learned weights as a quantization. The network gets the same weights, unrounded."""
        for name, conv in self.convolutions.items():
            unfold(submodule_convolution(self.net, name), conv)
        convolutions = {
            name: FoldedConv(name, conv.weight.detach(), conv.bias.detach(), conv.stride)
            for name, conv in self.convolutions.items()
        }
        rounded = {name: self.rounded(conv) for name, conv in convolutions.items()}
        return Quantization(convolutions, rounded, self.activations)


def unfold(module: ConvBn | torch.nn.Conv2d, conv: FoldedConv) -> None:
    """Sets the module's weights so that it computes what the folded convolution computes: the
    inverse of training.graph.folded_convolutions."""
    if isinstance(module, torch.nn.Conv2d):
        module.weight.copy_(conv.weight)
        bias_of(module).copy_(conv.bias)
        return
    module.conv.weight.copy_(conv.weight / (RASTER_GAIN if conv.name == RASTER_LAYER else 1.0))
    mean, variance = running_statistics(module.bn)
    mean.zero_()
    module.bn.bias.copy_(conv.bias)
    module.bn.weight.copy_(torch.sqrt(variance + module.bn.eps))
