"""An ONNX graph while it is built, together with the outputs that numpy computes for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from onnx import NodeProto, TensorProto, ValueInfoProto, helper, numpy_helper, save

from tests.pipeline.network.fixture_models.arithmetic import Array
from tests.pipeline.network.fixture_models.pseudo_random import SLOTS, input_bytes


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


class Graph:
    """Nodes, constants and ports of a model, and its files. If `evaluate`, outputs are computed."""

    def __init__(self, name: str, evaluate: bool):
        self.name, self.evaluate = name, evaluate
        self.nodes: list[NodeProto] = []
        self.constants: list[TensorProto] = []
        self.inputs: list[ValueInfoProto] = []
        self.outputs: list[ValueInfoProto] = []
        self.expected: list[Array] = []
        self.metadata: dict[str, str] = {}
        self.count = 0

    # --- nodes -------------------------------------------------------------------------------

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

    def reshape(self, name: str, shape: tuple[int, ...]) -> str:
        return self.node("Reshape", [name, self.constant(np.array(shape, np.int64))])

    def dequantize(self, name: str, kind: str, scale: float) -> str:
        zero = self.constant(np.zeros((), kind), "zero")
        return self.node("DequantizeLinear", [name, self.constant(np.float32(scale)), zero])

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
            real = self.reshape(real, shape)
        return Real(real, shape, scale, data)

    def view_ports(self, cells: int) -> None:
        shape = (SLOTS, cells)
        self.inputs.append(helper.make_tensor_value_info("view_index", TensorProto.INT32, shape))
        self.inputs.append(helper.make_tensor_value_info("view_weight", TensorProto.FLOAT, shape))

    def output(self, x: Real, name: str, stride: int = 1) -> None:
        """Adds an output, of which every `stride`-th value is expected."""
        self.node("Identity", [x.name], name)
        self.outputs.append(helper.make_tensor_value_info(name, TensorProto.FLOAT, x.shape))
        if self.evaluate:
            self.expected.append(x.values.reshape(-1)[::stride])

    # --- files -------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Writes the ONNX file."""
        graph = helper.make_graph(self.nodes, self.name, self.inputs, self.outputs, self.constants)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
        model.ir_version = 8
        for key, value in self.metadata.items():
            model.metadata_props.add(key=key, value=value)
        save(model, str(path))

    def save_expected(self, path: Path) -> None:
        """Writes the computed outputs as float32, one after the other."""
        values = np.concatenate([e.reshape(-1) for e in self.expected]).astype("<f4")
        values.tofile(path)
