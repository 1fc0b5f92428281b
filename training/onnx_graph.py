"""Backends for training/graph.py that write ONNX nodes: in float or quantized (QDQ)."""

from __future__ import annotations

from typing import Any

import numpy as np
import onnx
from onnx import helper, numpy_helper

from training.graph import FoldedConv
from training.model import BEV_COLS, BEV_ROWS, CAMERAS, FEATURE_COLS, FEATURE_ROWS, VIEW_SLOTS
from training.quantize import Quantization, Scale

MASK_OUTPUT = "bev_mask"
_CELLS = BEV_ROWS * BEV_COLS


def _zero_point(scale: Scale) -> np.ndarray:
    return np.zeros((), np.uint8 if scale.unsigned else np.int8)


class FloatOnnxBackend:
    """Writes each step as float nodes. Its tensors are names of ONNX values."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.initializers: list[onnx.TensorProto] = []
        self._shuffled_inputs: set[str] = set()

    def constant(self, name: str, values: np.ndarray | np.float32) -> str:
        self.initializers.append(numpy_helper.from_array(np.ascontiguousarray(values), name))
        return name

    def node(self, operator: str, inputs: list[str], output: str, **attributes: Any) -> str:
        self.nodes.append(helper.make_node(operator, inputs, [output], name=output, **attributes))
        return output

    def dequantize(self, name: str, scale: Scale) -> str:
        """The real values of an 8-bit graph input."""
        step = self.constant(f"{name}.scale", np.float32(scale.scale))
        zero = self.constant(f"{name}.zero", _zero_point(scale))
        return self.node("DequantizeLinear", [name, step, zero], f"{name}.real")

    def _parameters(self, x: str, conv: FoldedConv) -> tuple[str, str]:
        """Writes the weights and the bias of a convolution of x; returns their names."""
        weight = self._in_input_order(x, conv.weight.numpy())
        return (
            self.constant(f"{conv.name}.weight", weight),
            self.constant(f"{conv.name}.bias", conv.bias.numpy()),
        )

    def _activation(self, name: str, x: str) -> str:
        return x

    def _in_input_order(self, x: str, weight: np.ndarray) -> np.ndarray:
        """Reorders the weights of a convolution after SpaceToDepth, which orders its channels (row,
        column, channel); torch.pixel_unshuffle orders them (channel, row, column)."""
        if x not in self._shuffled_inputs:
            return weight
        out, channels = weight.shape[:2]
        parts = weight.reshape(out, channels // 4, 4, *weight.shape[2:])
        return parts.transpose(0, 2, 1, 3, 4).reshape(weight.shape)

    def conv(self, x: str, conv: FoldedConv, relu: bool, residual: str | None = None) -> str:
        y = self.output(x, conv, residual)
        if relu:
            y = self.node("Relu", [y], f"{conv.name}.relu")
        return self._activation(conv.name, y)

    def output(self, x: str, conv: FoldedConv, residual: str | None = None) -> str:
        kernel = conv.weight.shape[2]
        y = self.node(
            "Conv",
            [x, *self._parameters(x, conv)],
            f"{conv.name}.conv",
            kernel_shape=[kernel, kernel],
            strides=[conv.stride, conv.stride],
            pads=[conv.padding] * 4,
        )
        return y if residual is None else self.node("Add", [y, residual], f"{conv.name}.sum")

    def upsample(self, x: str) -> str:
        scales = self.constant("upsample.scales", np.array([1, 1, 2, 2], np.float32))
        return self.node(
            "Resize",
            [x, "", scales],
            "upsample.real",
            mode="nearest",
            coordinate_transformation_mode="asymmetric",
            nearest_mode="floor",
        )

    def gather(self, x: str, channels: int) -> str:
        turned = self.node("Transpose", [x], "view.turned", perm=[0, 2, 3, 1])
        cells = CAMERAS * FEATURE_ROWS * FEATURE_COLS
        table_shape = self.constant("view.table.shape", np.array([cells, channels], np.int64))
        table = self.node("Reshape", [turned, table_shape], "view.table")
        found = self.node("Gather", [table, "view_index"], "view.found", axis=0)
        weight_shape = self.constant(
            "view.weight.shape", np.array([VIEW_SLOTS, _CELLS, 1], np.int64)
        )
        weight = self.node("Reshape", ["view_weight", weight_shape], "view.weight")
        weighted = self.node("Mul", [found, weight], "view.weighted")
        axes = self.constant("view.axes", np.array([0], np.int64))
        summed = self.node("ReduceSum", [weighted, axes], "view.sum", keepdims=0)
        planes = self.node("Transpose", [summed], "view.planes", perm=[1, 0])
        shape = self.constant("view.shape", np.array([1, channels, BEV_ROWS, BEV_COLS], np.int64))
        return self._activation("view", self.node("Reshape", [planes, shape], "view.grid"))

    def space_to_depth(self, x: str) -> str:
        y = self.node("SpaceToDepth", [x], "raster.blocks", blocksize=2)
        self._shuffled_inputs.add(y)
        return y

    def depth_to_space(self, x: str) -> str:
        return self.node("DepthToSpace", [x], MASK_OUTPUT, blocksize=4, mode="CRD")


class Int8OnnxBackend(FloatOnnxBackend):
    """Writes QuantizeLinear and DequantizeLinear around 8-bit elements."""

    def __init__(self, quantization: Quantization) -> None:
        super().__init__()
        self._quantization = quantization
        self._step_of: dict[str, float] = {}

    def dequantize(self, name: str, scale: Scale) -> str:
        real = super().dequantize(name, scale)
        self._step_of[real] = scale.scale
        return real

    def _activation(self, name: str, x: str) -> str:
        scale = self._quantization.activations[name]
        step = self.constant(f"{name}.out.scale", np.float32(scale.scale))
        zero = self.constant(f"{name}.out.zero", _zero_point(scale))
        quantized = self.node("QuantizeLinear", [x, step, zero], f"{name}.quantized")
        real = self.node("DequantizeLinear", [quantized, step, zero], f"{name}.real")
        self._step_of[real] = scale.scale
        return real

    def _parameters(self, x: str, conv: FoldedConv) -> tuple[str, str]:
        quantized = self._quantization.quantized[conv.name]
        scale = quantized.scale.numpy().astype(np.float32)
        weight = self._in_input_order(x, quantized.weight.numpy())
        step = np.float32(self._step_of[x]) * scale
        bias = np.round(quantized.bias.numpy().astype(np.float64) / step).astype(np.int32)
        return (
            self._per_channel(f"{conv.name}.weight", weight, scale),
            self._per_channel(f"{conv.name}.bias", bias, step),
        )

    def _per_channel(self, name: str, elements: np.ndarray, scale: np.ndarray) -> str:
        inputs = [
            self.constant(name, elements),
            self.constant(f"{name}.scale", scale),
            self.constant(f"{name}.zero", np.zeros(len(scale), elements.dtype)),
        ]
        return self.node("DequantizeLinear", inputs, f"{name}.real", axis=0)

    def upsample(self, x: str) -> str:
        y = super().upsample(x)
        self._step_of[y] = self._step_of[x]
        return y

    def space_to_depth(self, x: str) -> str:
        y = super().space_to_depth(x)
        self._step_of[y] = self._step_of[x]
        return y
