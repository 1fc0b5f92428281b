"""Builds a model operator by operator, and computes it at the same time."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.pipeline.network.fixture_models import arithmetic
from tests.pipeline.network.fixture_models.arithmetic import Array
from tests.pipeline.network.fixture_models.graph import Graph, Real
from tests.pipeline.network.fixture_models.pseudo_random import SLOTS, view_table


class Model(Graph):
    """A graph with pseudo-random weights, whose scales are powers of two unless `odd_scales`."""

    def __init__(self, name: str, quantized: bool, evaluate: bool = True, odd_scales: bool = False):
        super().__init__(name, evaluate)
        self.quantized, self.odd = quantized, odd_scales
        self.rng = np.random.default_rng(sum(name.encode()))

    def odd_factor(self) -> float:
        return float(self.rng.uniform(0.7, 1.4)) if self.odd else 1.0

    # --- operators ---------------------------------------------------------------------------

    def quantize(self, x: Real, kind: str, scale: float) -> Real:
        if not self.quantized:
            return x
        zero = self.constant(np.zeros((), kind), "zero")
        q = self.node("QuantizeLinear", [x.name, self.constant(np.float32(scale)), zero])
        data = arithmetic.rounded(x.values, kind, scale) if self.evaluate else None
        return Real(self.dequantize(q, kind, scale), x.shape, scale, data)

    def conv(self, x: Real, channels: int, size: int = 3, stride: int = 1, groups: int = 1,
             pads: tuple[int, int, int, int] | None = None, with_bias: bool = True,
             gain: float = 1.0) -> Real:
        """Adds a convolution. `gain`: about the ratio of output to input (weight scales)."""
        pads = pads or (size // 2,) * 4
        depth = x.shape[1] // groups
        q = self.rng.integers(-63, 64, (channels, depth, size, size))
        spread = 36.0 * np.sqrt(depth * size * size)
        exponent = np.round(np.log2(gain / spread) + self.rng.integers(-1, 2, channels))
        w_scale = np.array([2.0**e * self.odd_factor() for e in exponent], np.float32)
        bias_scale = (w_scale * np.float32(x.scale)).astype(np.float32)
        bias_q = self.rng.integers(-2000, 2000, channels)
        weight = q * w_scale.astype(float)[:, None, None, None]
        bias = bias_q * bias_scale.astype(float)
        if self.quantized:
            w = self.per_channel(q.astype(np.int8), "w", w_scale)
            b = self.per_channel(bias_q.astype(np.int32), "b", bias_scale)
        else:
            w = self.constant(weight.astype(np.float32), "w")
            b = self.constant(bias.astype(np.float32), "b")
        inputs = [x.name, w] + ([b] if with_bias else [])
        name = self.node("Conv", inputs, kernel_shape=[size, size], strides=[stride, stride],
                         pads=list(pads), group=groups)
        shape = (x.shape[0], channels,
                 (x.shape[2] + pads[0] + pads[2] - size) // stride + 1,
                 (x.shape[3] + pads[1] + pads[3] - size) // stride + 1)
        data = None
        if self.evaluate:
            data = arithmetic.convolve(x.values, weight, stride, pads, groups)
            data = data + (bias[None, :, None, None] if with_bias else 0.0)
        return Real(name, shape, 0.0, data)

    def per_channel(self, data: Array, stem: str, scales: Array) -> str:
        """Adds a constant with a DequantizeLinear that has a scale for each output channel."""
        inputs = [self.constant(data, stem), self.constant(scales, f"{stem}s")]
        return self.node("DequantizeLinear", inputs, axis=0)

    def relu(self, x: Real) -> Real:
        data = np.maximum(x.values, 0.0) if self.evaluate else None
        return Real(self.node("Relu", [x.name]), x.shape, x.scale, data)

    def add(self, x: Real, y: Real) -> Real:
        data = x.values + y.values if self.evaluate else None
        return Real(self.node("Add", [x.name, y.name]), x.shape, 0.0, data)

    def max_pool(self, x: Real, size: int, stride: int) -> Real:
        name = self.node("MaxPool", [x.name], kernel_shape=[size, size], strides=[stride, stride],
                         pads=[size // 2] * 4)
        data = arithmetic.max_pool(x.values, size, stride)
        return Real(name, data.shape, x.scale, data)

    def upsample(self, x: Real, mode: str = "nearest") -> Real:
        scales = self.constant(np.array([1, 1, 2, 2], np.float32))
        extra = ({"coordinate_transformation_mode": "asymmetric", "nearest_mode": "floor"}
                 if mode == "nearest" else {"coordinate_transformation_mode": "half_pixel"})
        name = self.node("Resize", [x.name, "", scales], mode=mode, **extra)
        n, c, h, w = x.shape
        data = arithmetic.upsample(x.values, mode) if self.evaluate else None
        return Real(name, (n, c, 2 * h, 2 * w), x.scale, data)

    def depth_to_space(self, x: Real, block: int, mode: str = "DCR") -> Real:
        name = self.node("DepthToSpace", [x.name], blocksize=block, mode=mode)
        n, c, h, w = x.shape
        data = arithmetic.depth_to_space(x.values, block, mode) if self.evaluate else None
        return Real(name, (n, c // (block * block), h * block, w * block), x.scale, data)

    def space_to_depth(self, x: Real, block: int) -> Real:
        name = self.node("SpaceToDepth", [x.name], blocksize=block)
        n, c, h, w = x.shape
        data = arithmetic.space_to_depth(x.values, block) if self.evaluate else None
        return Real(name, (n, c * block * block, h // block, w // block), x.scale, data)

    def concat(self, parts: list[Real]) -> Real:
        name = self.node("Concat", [p.name for p in parts], axis=1)
        data = np.concatenate([p.values for p in parts], 1)
        return Real(name, data.shape, parts[0].scale, data)

    def view(self, x: Real, rows: int, cols: int, channels_first: bool = False) -> Real:
        """The view transform: Gather, Mul and ReduceSum, with the channels last or first."""
        n, c, h, w = x.shape
        cells = rows * cols
        if channels_first:
            table = self.reshape(self.node("Transpose", [x.name], perm=[1, 0, 2, 3]), (c, -1))
            gathered = self.node("Gather", [table, "view_index"], axis=1)
            weighted = self.node("Mul", [gathered, "view_weight"])
            summed = self.node("ReduceSum", [weighted, self.constant(np.array([1], np.int64))],
                               keepdims=0)
        else:
            table = self.reshape(self.node("Transpose", [x.name], perm=[0, 2, 3, 1]), (-1, c))
            gathered = self.node("Gather", [table, "view_index"], axis=0)
            weighted = self.node("Mul", [gathered, self.reshape("view_weight", (SLOTS, cells, 1))])
            summed = self.node("ReduceSum", [weighted, self.constant(np.array([0], np.int64))],
                               keepdims=0)
            summed = self.node("Transpose", [summed], perm=[1, 0])
        shape = (1, c, rows, cols)
        name = self.reshape(summed, shape)
        data = None
        if self.evaluate:
            index, weight = view_table(cells, n * h * w)
            data = arithmetic.view_transform(x.values, index, weight).reshape(shape)
        return Real(name, shape, 0.0, data)

    # --- blocks ------------------------------------------------------------------------------

    def unit(self, x: Real, channels: int, scale: float, **options: Any) -> Real:
        """Convolution, ReLU and quantization to uint8."""
        return self.quantize(self.relu(self.conv(x, channels, **options)), "uint8", scale)

    def residual(self, x: Real, scale: float, linear: bool = False) -> Real:
        y = self.add(self.conv(self.unit(x, x.shape[1], scale), x.shape[1]), x)
        return y if linear else self.quantize(self.relu(y), "uint8", scale)
