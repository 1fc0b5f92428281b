#!/usr/bin/python3
"""Writes the test models of this folder, and their outputs as numpy computes them.

    make_fixtures.py                 writes fixtures/*.onnx and fixtures/*.expected
    make_fixtures.py --nano FILE     writes a model of the shipped size with random weights

Computes each model while building it, in float64 and independently of the C++ code. Scales are
powers of two unless stated otherwise, so that int8 results are exact on every machine.
`x.expected` holds the outputs as float32, one after the other. For whole networks it holds only
every 61st value (NETWORK_STRIDE).
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from onnx import NodeProto, TensorProto, ValueInfoProto, helper, numpy_helper, save

FIXTURES = Path(__file__).parent / "fixtures"
NETWORK_STRIDE = 61
SLOTS = 8
Array = np.ndarray


def hashed(count: int, seed: int) -> Array:
    """The pseudo-random numbers of the test inputs (tests/pipeline/network/model_inputs.h)."""
    mask = np.uint64(0xFFFFFFFF)
    x = (np.arange(count, dtype=np.uint64) * 2654435761 + np.uint64(seed * 40503)) & mask
    x ^= x >> np.uint64(15)
    x = (x * np.uint64(2246822519)) & mask
    return x ^ (x >> np.uint64(13))


def input_bytes(count: int, seed: int) -> Array:
    return (hashed(count, seed) >> np.uint64(24)).astype(np.int64)


def view_table(cells: int, keys: int) -> tuple[Array, Array]:
    """Index and weight [SLOTS, cells]. 1/5 of the weights, and those of the last cell, are zero."""
    h = hashed(SLOTS * cells, 77)
    weight = np.where(h % 5 == 0, 0, (h >> np.uint64(8)) & np.uint64(127)) / 1024.0
    weight = weight.reshape(SLOTS, cells)
    weight[:, -1] = 0.0
    return (h % np.uint64(keys)).astype(np.int64).reshape(SLOTS, cells), weight


@dataclass
class Real:
    """A real-valued tensor of the graph. `data` is None if the model is not computed."""

    name: str
    shape: tuple[int, ...]
    scale: float
    data: Array | None

    @property
    def values(self) -> Array:
        """The data of a computed tensor."""
        assert self.data is not None
        return self.data


class Model:
    """Builds an ONNX graph and computes its outputs at the same time."""

    def __init__(self, name: str, quantized: bool, evaluate: bool = True, odd_scales: bool = False):
        self.name, self.quantized, self.evaluate, self.odd = name, quantized, evaluate, odd_scales
        self.rng = np.random.default_rng(sum(name.encode()))
        self.nodes: list[NodeProto] = []
        self.constants: list[TensorProto] = []
        self.inputs: list[ValueInfoProto] = []
        self.outputs: list[ValueInfoProto] = []
        self.expected: list[Array] = []
        self.metadata: dict[str, str] = {}
        self.count = 0

    def fresh(self, stem: str) -> str:
        self.count += 1
        return f"{stem}_{self.count}"

    def constant(self, data: Array | np.float32, stem: str = "c") -> str:
        name = self.fresh(stem)
        self.constants.append(numpy_helper.from_array(data, name))
        return name

    def node(
        self, op: str, inputs: list[str], output: str | None = None, **attributes: Any
    ) -> str:
        output = output or self.fresh(op.lower())
        self.nodes.append(helper.make_node(op, inputs, [output], name=f"{output}", **attributes))
        return output

    def real(self, name: str, data: Array | None, shape: tuple[int, ...], scale: float) -> Real:
        return Real(name, tuple(shape), scale, data)

    def odd_factor(self) -> float:
        return float(self.rng.uniform(0.7, 1.4)) if self.odd else 1.0

    # --- ports -------------------------------------------------------------------------------

    def input(self, name: str, kind: str, shape: tuple[int, ...], scale: float, seed: int,
              declared: tuple[int, ...] | None = None) -> Real:
        """Adds an 8-bit input and its DequantizeLinear.

        `declared` is the shape in the file, if it differs from `shape`.
        """
        declared = declared or shape
        values = input_bytes(int(np.prod(shape)), seed).reshape(shape)
        values = values - (128 if kind == "int8" else 0)
        data = values * scale if self.evaluate else None
        types = {"int8": TensorProto.INT8, "uint8": TensorProto.UINT8}
        self.inputs.append(helper.make_tensor_value_info(name, types[kind], declared))
        real = self.dequantize(name, kind, scale)
        if declared != shape:
            real = self.node("Reshape", [real, self.constant(np.array(shape, np.int64))])
        return self.real(real, data, shape, scale)

    def output(self, x: Real, name: str, stride: int = 1) -> None:
        self.node("Identity", [x.name], name)
        self.outputs.append(helper.make_tensor_value_info(name, TensorProto.FLOAT, x.shape))
        if self.evaluate:
            self.expected.append(x.values.reshape(-1)[::stride])

    # --- quantization ------------------------------------------------------------------------

    def dequantize(self, name: str, kind: str, scale: float) -> str:
        zero = self.constant(np.zeros((), kind), "zero")
        return self.node("DequantizeLinear", [name, self.constant(np.float32(scale)), zero])

    def quantize(self, x: Real, kind: str, scale: float) -> Real:
        if not self.quantized:
            return x
        zero = self.constant(np.zeros((), kind), "zero")
        q = self.node("QuantizeLinear", [x.name, self.constant(np.float32(scale)), zero])
        data = None
        if self.evaluate:
            limits = np.iinfo(kind)
            step = float(np.float32(scale))
            data = np.clip(np.rint(x.values / step), limits.min, limits.max) * step
        return self.real(self.dequantize(q, kind, scale), data, x.shape, scale)

    # --- operators ---------------------------------------------------------------------------

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
        weight = q * w_scale.astype(float)[:, None, None, None]
        bias_scale = (w_scale * np.float32(x.scale)).astype(np.float32)
        bias_q = self.rng.integers(-2000, 2000, channels)
        bias = bias_q * bias_scale.astype(float)
        if self.quantized:
            channel_axis: dict[str, Any] = {"axis": 0}
            w = self.node("DequantizeLinear", [self.constant(q.astype(np.int8), "w"),
                                               self.constant(w_scale, "ws")], **channel_axis)
            b = self.node("DequantizeLinear", [self.constant(bias_q.astype(np.int32), "b"),
                                               self.constant(bias_scale, "bs")], **channel_axis)
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
            data = convolve(x.values, weight, stride, pads, groups)
            data = data + (bias[None, :, None, None] if with_bias else 0.0)
        return self.real(name, data, shape, 0.0)

    def relu(self, x: Real) -> Real:
        data = np.maximum(x.values, 0.0) if self.evaluate else None
        return self.real(self.node("Relu", [x.name]), data, x.shape, x.scale)

    def add(self, x: Real, y: Real) -> Real:
        data = x.values + y.values if self.evaluate else None
        return self.real(self.node("Add", [x.name, y.name]), data, x.shape, 0.0)

    def max_pool(self, x: Real, size: int, stride: int) -> Real:
        pad = size // 2
        name = self.node("MaxPool", [x.name], kernel_shape=[size, size], strides=[stride, stride],
                         pads=[pad] * 4)
        padded = np.pad(x.values, ((0, 0), (0, 0), (pad, pad), (pad, pad)), constant_values=-np.inf)
        data = windows_of(padded, size)[:, :, ::stride, ::stride].max((-1, -2))
        return self.real(name, data, data.shape, x.scale)

    def upsample(self, x: Real, mode: str = "nearest") -> Real:
        scales = self.constant(np.array([1, 1, 2, 2], np.float32))
        extra = ({"coordinate_transformation_mode": "asymmetric", "nearest_mode": "floor"}
                 if mode == "nearest" else {"coordinate_transformation_mode": "half_pixel"})
        name = self.node("Resize", [x.name, "", scales], mode=mode, **extra)
        n, c, h, w = x.shape
        data = None
        if self.evaluate and mode == "nearest":
            data = x.values.repeat(2, 2).repeat(2, 3)
        elif self.evaluate:
            data = twice_linear(twice_linear(x.values, 2), 3)
        return self.real(name, data, (n, c, 2 * h, 2 * w), x.scale)

    def depth_to_space(self, x: Real, block: int, mode: str = "DCR") -> Real:
        name = self.node("DepthToSpace", [x.name], blocksize=block, mode=mode)
        n, c, h, w = x.shape
        c //= block * block
        shape = (n, c, h * block, w * block)
        data = None
        if self.evaluate and mode == "DCR":
            data = x.values.reshape(n, block, block, c, h, w).transpose(0, 3, 4, 1, 5, 2)
        elif self.evaluate:
            data = x.values.reshape(n, c, block, block, h, w).transpose(0, 1, 4, 2, 5, 3)
        return self.real(name, None if data is None else data.reshape(shape), shape, x.scale)

    def space_to_depth(self, x: Real, block: int) -> Real:
        name = self.node("SpaceToDepth", [x.name], blocksize=block)
        n, c, h, w = x.shape
        shape = (n, c * block * block, h // block, w // block)
        data = None
        if self.evaluate:
            data = x.values.reshape(n, c, h // block, block, w // block, block)
            data = data.transpose(0, 3, 5, 1, 2, 4).reshape(shape)
        return self.real(name, data, shape, x.scale)

    def concat(self, parts: list[Real]) -> Real:
        name = self.node("Concat", [p.name for p in parts], axis=1)
        data = np.concatenate([p.values for p in parts], 1)
        return self.real(name, data, data.shape, parts[0].scale)

    def view_ports(self, cells: int) -> None:
        shape = (SLOTS, cells)
        self.inputs.append(helper.make_tensor_value_info("view_index", TensorProto.INT32, shape))
        self.inputs.append(helper.make_tensor_value_info("view_weight", TensorProto.FLOAT, shape))

    def view(self, x: Real, rows: int, cols: int, channels_first: bool = False) -> Real:
        """The view transform: Gather, Mul and ReduceSum, with the channels last or first."""
        n, c, h, w = x.shape
        cells = rows * cols

        def shaped(name: str, shape: list[int]) -> str:
            return self.node("Reshape", [name, self.constant(np.array(shape, np.int64))])

        if channels_first:
            table = shaped(self.node("Transpose", [x.name], perm=[1, 0, 2, 3]), [c, -1])
            gathered = self.node("Gather", [table, "view_index"], axis=1)
            weighted = self.node("Mul", [gathered, "view_weight"])
            summed = self.node("ReduceSum", [weighted, self.constant(np.array([1], np.int64))],
                               keepdims=0)
        else:
            table = shaped(self.node("Transpose", [x.name], perm=[0, 2, 3, 1]), [-1, c])
            gathered = self.node("Gather", [table, "view_index"], axis=0)
            weighted = self.node("Mul", [gathered, shaped("view_weight", [SLOTS, cells, 1])])
            summed = self.node("ReduceSum", [weighted, self.constant(np.array([0], np.int64))],
                               keepdims=0)
            summed = self.node("Transpose", [summed], perm=[1, 0])
        name = shaped(summed, [1, c, rows, cols])
        data = None
        if self.evaluate:
            index, weight = view_table(cells, n * h * w)
            features = x.values.transpose(0, 2, 3, 1).reshape(-1, c)
            data = (features[index] * weight[:, :, None]).sum(0).T.reshape(1, c, rows, cols)
        return self.real(name, data, (1, c, rows, cols), 0.0)

    # --- blocks ------------------------------------------------------------------------------

    def unit(self, x: Real, channels: int, scale: float, **options: Any) -> Real:
        """Convolution, ReLU and quantization to uint8."""
        return self.quantize(self.relu(self.conv(x, channels, **options)), "uint8", scale)

    def residual(self, x: Real, scale: float, linear: bool = False) -> Real:
        y = self.add(self.conv(self.unit(x, x.shape[1], scale), x.shape[1]), x)
        return y if linear else self.quantize(self.relu(y), "uint8", scale)

    # --- files -------------------------------------------------------------------------------

    def save(self, path: Path | None = None) -> None:
        graph = helper.make_graph(self.nodes, self.name, self.inputs, self.outputs, self.constants)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
        model.ir_version = 8
        for key, value in self.metadata.items():
            model.metadata_props.add(key=key, value=value)
        save(model, str(path or FIXTURES / f"{self.name}.onnx"))
        if self.evaluate:
            values = np.concatenate([e.reshape(-1) for e in self.expected]).astype("<f4")
            values.tofile(FIXTURES / f"{self.name}.expected")


def windows_of(x: Array, size: int) -> Array:
    """All windows of size x size: [n, c, rows, cols] -> [n, c, row, col, size, size]."""
    # NumPy 1.24 declares only a single axis.
    return np.lib.stride_tricks.sliding_window_view(  # type: ignore[call-overload]
        x, (size, size), (2, 3)
    )


def convolve(x: Array, weight: Array, stride: int, pads: tuple[int, ...], groups: int) -> Array:
    x = np.pad(x, ((0, 0), (0, 0), (pads[0], pads[2]), (pads[1], pads[3])))
    windows = windows_of(x, weight.shape[2])[:, :, ::stride, ::stride]
    n, c, h, w = windows.shape[:4]
    outputs = []
    for g in range(groups):
        w_g = np.split(weight, groups)[g].reshape(weight.shape[0] // groups, -1)
        columns = windows[:, g * c // groups:(g + 1) * c // groups].transpose(0, 2, 3, 1, 4, 5)
        outputs.append((columns.reshape(n * h * w, -1) @ w_g.T).reshape(n, h, w, -1))
    return np.concatenate(outputs, -1).transpose(0, 3, 1, 2)


def twice_linear(x: Array, axis: int) -> Array:
    """Interpolates at half-pixel positions: 3/4 of a cell plus 1/4 of its neighbour."""
    x = np.moveaxis(x, axis, -1)
    before = np.concatenate([x[..., :1], x[..., :-1]], -1)
    after = np.concatenate([x[..., 1:], x[..., -1:]], -1)
    pairs = np.stack([0.75 * x + 0.25 * before, 0.75 * x + 0.25 * after], -1)
    return np.moveaxis(pairs.reshape(*x.shape[:-1], -1), -1, axis)


# --- models of single operators ------------------------------------------------------------------


def operator_models(quantized: bool) -> list[Model]:
    """Models of single operators or small blocks. Each exists quantized and in float."""
    models = []

    def start(
        name: str, kind: str = "uint8", shape: tuple[int, ...] = (2, 6, 9, 11)
    ) -> tuple[Model, Real]:
        model = Model(f"{name}_{'int8' if quantized else 'float'}", quantized)
        models.append(model)
        return model, model.input("x", kind, shape, 2.0**-6, seed=1)

    model, x = start("conv", "int8")
    model.output(model.unit(x, 20, 2.0**-6), "y")

    model, x = start("conv_strided")
    y = model.conv(x, 7, stride=2, pads=(1, 0, 1, 2), with_bias=False)
    model.output(model.quantize(y, "int8", 2.0**-5), "y")

    model, x = start("conv_depthwise", shape=(1, 16, 8, 8))
    model.output(model.unit(x, 16, 2.0**-6, groups=16), "y")

    model, x = start("conv_unrounded")
    model.output(model.conv(x, 5, size=1), "y")

    model, x = start("residual")
    y = model.residual(model.unit(x, 16, 2.0**-6), 2.0**-5)
    model.output(model.residual(y, 2.0**-5), "y")

    # The residual is read again at the end, so its memory must not be overwritten.
    model, x = start("residual_kept")
    y = model.unit(x, 16, 2.0**-6)
    z = model.residual(y, 2.0**-5)
    model.output(model.quantize(model.add(model.conv(z, 16), y), "int8", 2.0**-4), "y")

    # The residual comes from a convolution and is int8, as in a strided block.
    model, x = start("residual_projected")
    y = model.unit(x, 16, 2.0**-6)
    skip = model.quantize(model.conv(y, 24, size=1, stride=2), "int8", 2.0**-5)
    inner = model.unit(y, 24, 2.0**-6, stride=2)
    z = model.relu(model.add(model.conv(inner, 24), skip))
    model.output(model.quantize(z, "uint8", 2.0**-5), "y")

    model, x = start("residual_unrounded")
    model.output(model.residual(model.unit(x, 16, 2.0**-6), 2.0**-5, linear=True), "y")

    # Both terms are rounded before the sum, so nothing can be folded.
    model, x = start("add")
    y = model.quantize(model.conv(x, 8), "int8", 2.0**-5)
    z = model.unit(x, 8, 2.0**-6)
    model.output(model.quantize(model.relu(model.add(y, z)), "uint8", 2.0**-5), "y")

    model, x = start("max_pool")
    model.output(model.max_pool(model.unit(x, 16, 2.0**-6), 3, 2), "y")

    # One step of a feature pyramid: adds the coarse level to the fine level.
    model, x = start("upsample_nearest", shape=(2, 6, 8, 12))
    fine = model.conv(model.unit(x, 16, 2.0**-6), 8, size=1)
    coarse = model.conv(model.unit(x, 16, 2.0**-6, stride=2), 8, size=1)
    up = model.upsample(model.quantize(coarse, "int8", 2.0**-5))
    model.output(model.quantize(model.relu(model.add(fine, up)), "uint8", 2.0**-5), "y")

    model, x = start("upsample_linear")
    y = model.upsample(model.unit(x, 8, 2.0**-6), "linear")
    model.output(model.quantize(y, "uint8", 2.0**-5), "y")

    model, x = start("depth_to_space_dcr", shape=(1, 6, 4, 5))
    y = model.depth_to_space(model.unit(x, 18, 2.0**-6), 3)
    model.output(model.unit(y, 4, 2.0**-6), "y")

    model, x = start("depth_to_space_crd", shape=(1, 6, 4, 5))
    model.output(model.depth_to_space(model.conv(x, 12), 2, "CRD"), "y")

    model, x = start("space_to_depth", shape=(1, 3, 8, 12))
    model.output(model.unit(model.space_to_depth(x, 2), 8, 2.0**-6), "y")

    model, x = start("concat")
    parts = [model.unit(x, 8, 2.0**-6), model.unit(x, 5, 2.0**-6)]
    model.output(model.unit(model.concat(parts), 4, 2.0**-6), "y")

    # The scales differ, so the parts must be concatenated as real values.
    model, x = start("concat_rescaled")
    parts = [model.unit(x, 8, 2.0**-6), model.unit(x, 5, 2.0**-5)]
    y = model.quantize(model.concat(parts), "uint8", 2.0**-5)
    model.output(model.unit(y, 4, 2.0**-6), "y")

    for channels_first in (False, True):
        model, x = start("view_channels_first" if channels_first else "view_channels_last",
                         shape=(3, 6, 4, 5))
        model.view_ports(21)
        y = model.view(model.unit(x, 20, 2.0**-6), 7, 3, channels_first)
        model.output(model.unit(model.quantize(y, "uint8", 2.0**-7), 4, 2.0**-6), "y")

    return models


# --- whole networks -------------------------------------------------------------------------------


def solver_metadata(model: Model) -> None:
    values = {"joint_scale": "150.5", "x_scale": "90", "y_scale": "120", "yaw_scale": "2000",
              "gem_omega": "1.25"}
    model.metadata = {f"bevloc.solver.{key}": value for key, value in values.items()}


def tiny_network(quantized: bool) -> Model:
    """All parts of the shipped network, with few channels and scales other than powers of two."""
    model = Model(f"tiny_network_{'int8' if quantized else 'float'}", quantized, odd_scales=True)
    model.rng = np.random.default_rng(7)
    s = 1.0 / 50.0
    images = model.input("images", "int8", (6, 3, 96, 320), 1.0 / 64.0, seed=1)
    model.view_ports(5000)
    raster = model.input("raster", "uint8", (1, 3, 400, 200), 1.0 / 255.0, seed=2,
                         declared=(3, 400, 200))

    x8 = model.unit(model.unit(model.unit(images, 8, s, stride=2), 8, s, stride=2), 8, s, stride=2)
    x8 = model.residual(x8, s)
    coarse = model.quantize(model.conv(model.unit(x8, 8, s, stride=2), 8, size=1), "int8", 2 * s)
    x8 = model.add(model.conv(x8, 8, size=1), model.upsample(coarse))
    x8 = model.quantize(model.relu(x8), "uint8", s)
    bev = model.residual(model.quantize(model.view(x8, 100, 50), "uint8", 0.37 * s), s)
    model.output(model.residual(model.unit(bev, 16, s, size=1), s, linear=True), "bev_features",
                 NETWORK_STRIDE)

    encoded = model.unit(model.unit(model.space_to_depth(raster, 2), 8, s), 8, s, stride=2)
    model.output(model.residual(model.unit(encoded, 16, s, size=1), s, linear=True),
                 "map_features", NETWORK_STRIDE)

    logits = model.conv(model.unit(bev, 8, s), 48, size=1)
    model.output(model.depth_to_space(logits, 4, "CRD"), "bev_mask", NETWORK_STRIDE)
    solver_metadata(model)
    return model


def nano_network() -> Model:
    """A network of the shipped size (training/model.py) with random weights. Not computed."""
    model = Model("nano-random", quantized=True, evaluate=False, odd_scales=True)
    s = 1.0 / 50.0
    images = model.input("images", "int8", (6, 3, 96, 320), 1.0 / 64.0, seed=1)
    model.view_ports(5000)
    raster = model.input("raster", "uint8", (1, 3, 400, 200), 1.0 / 255.0, seed=2)

    def compress(x: Real) -> Real:
        x = model.residual(model.residual(model.unit(x, 16, s), s), s)
        return model.residual(x, s, linear=True)

    x4 = model.residual(model.unit(model.unit(images, 12, s, stride=2), 24, s, stride=2), s)
    x8 = model.residual(model.residual(model.unit(x4, 40, s, stride=2), s), s)
    x16 = model.residual(model.residual(model.unit(x8, 80, s, stride=2), s), s)
    up = model.upsample(model.quantize(model.conv(x16, 48, size=1), "int8", s))
    merged = model.relu(model.add(model.conv(x8, 48, size=1), up))
    features = model.unit(model.quantize(merged, "uint8", s), 48, s)
    bev = model.residual(model.quantize(model.view(features, 100, 50), "uint8", s), s)
    model.output(compress(bev), "bev_features")

    encoded = model.unit(model.unit(model.space_to_depth(raster, 2), 16, s), 32, s, stride=2)
    model.output(compress(model.unit(encoded, 48, s)), "map_features")

    logits = model.conv(model.unit(bev, 32, s), 48, size=1)
    model.output(model.depth_to_space(logits, 4, "CRD"), "bev_mask")
    solver_metadata(model)
    return model


def wrong_shape() -> Model:
    """A model whose images do not have the size that Network requires."""
    model = Model("wrong_shape", quantized=True)
    x = model.input("images", "int8", (6, 3, 4, 4), 1.0 / 64.0, seed=1)
    model.output(model.conv(x, 2), "bev_features")
    return model


def small_features() -> Model:
    """A model with the ports that Network requires, but with image features of half the size."""
    model = Model("small_features", quantized=True, evaluate=False)
    s = 1.0 / 50.0
    images = model.input("images", "int8", (6, 3, 96, 320), 1.0 / 64.0, seed=1)
    model.view_ports(5000)
    raster = model.input("raster", "uint8", (1, 3, 400, 200), 1.0 / 255.0, seed=2)
    bev = model.quantize(model.view(model.unit(images, 4, s, stride=16), 100, 50), "uint8", s)
    model.output(model.conv(bev, 16, size=1), "bev_features")
    model.output(model.conv(raster, 16, stride=4), "map_features")
    model.output(model.depth_to_space(model.conv(bev, 48, size=1), 4), "bev_mask")
    solver_metadata(model)
    return model


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nano", type=Path)
    arguments = parser.parse_args()
    if arguments.nano:
        nano_network().save(arguments.nano)
        return
    FIXTURES.mkdir(exist_ok=True)
    for quantized in (True, False):
        for model in operator_models(quantized):
            model.save()
        tiny_network(quantized).save()
    wrong_shape().save()
    small_features().save()


if __name__ == "__main__":
    main()
