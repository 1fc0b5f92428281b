"""Counts a network's multiply-accumulates per part and its activation memory. It runs the network
on PyTorch's meta device, which computes and allocates nothing."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor, nn
from torch.utils._python_dispatch import TorchDispatchMode

from training.models.config import (
    CAMERAS,
    RASTER_CHANNELS,
    RASTER_COLS,
    RASTER_ROWS,
    VIEW_COLS,
    VIEW_ROWS,
    VIEW_SLOTS,
    ModelConfig,
)
from training.models.network import BevNetwork

_SEED = 1
_BLOCK = "block"  # attribute of a tensor: the _Block that it occupies


@dataclass(frozen=True)
class Cost:
    """The cost of one sample with six cameras."""

    parameters: int
    macs: dict[str, int]  # multiply-accumulates by part (the children of BevNetwork)
    # Peak of the float32 activations that are alive between PyTorch's operations, without inputs,
    # parameters and the scratch memory inside an operation.
    peak_bytes: int


def sample_inputs(config: ModelConfig, device: str) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Random images, a random view table (two cameras see each cell) and a random raster."""
    generator = torch.Generator().manual_seed(_SEED)
    cells = VIEW_ROWS * VIEW_COLS
    rows, cols = config.feature_grid
    images = torch.randn(1, CAMERAS, 3, *config.image_size, generator=generator)
    camera = torch.randint(CAMERAS, (1, 2, 1, cells), generator=generator)
    cell = torch.randint(rows * cols, (1, 2, VIEW_SLOTS // 2, cells), generator=generator)
    index = (camera * rows * cols + cell).flatten(1, 2)
    weight = torch.full(index.shape, 1.0 / VIEW_SLOTS)
    raster = torch.rand(1, RASTER_CHANNELS, RASTER_ROWS, RASTER_COLS, generator=generator)
    return images.to(device), index.to(device), weight.to(device), raster.to(device)


def deployed_outputs(
    network: BevNetwork, images: Tensor, index: Tensor, weight: Tensor, raster: Tensor
) -> tuple[Tensor, Tensor, Tensor]:
    """F_B, F_M and the perceived mask. This is what the appliance computes; the reconstructed mask
    is needed only in training."""
    bev = network.perceive(images, index, weight)
    features_map = network.map_compress(network.map_encoder(raster))
    return network.bev_compress(bev), features_map, network.head(bev)


@torch.no_grad()
def measure(network: nn.Module, run: Callable[[], object]) -> Cost:
    """The cost of `run`, which calls `network`. The parts are the network's children."""
    meter = _Meter()
    hooks = [
        child.register_forward_pre_hook(meter.enter(name))
        for name, child in network.named_children()
    ]
    with meter:
        run()
    for hook in hooks:
        hook.remove()
    parameters = sum(parameter.numel() for parameter in network.parameters())
    return Cost(parameters, dict(meter.macs), meter.peak_bytes)


def cost_of(config: ModelConfig) -> Cost:
    network = BevNetwork(config).eval().to("meta")
    inputs = sample_inputs(config, "meta")
    return measure(network, lambda: deployed_outputs(network, *inputs))


class _Block:
    """Memory that one or more tensors share. The meter counts it as freed when the last of them is
    gone."""

    def __init__(self, meter: _Meter, size_bytes: int) -> None:
        self.meter, self.size_bytes = meter, size_bytes
        meter.grow(size_bytes)

    def __del__(self) -> None:
        self.meter.grow(-self.size_bytes)


class _Meter(TorchDispatchMode):
    """Counts the operations that run inside it."""

    def __init__(self) -> None:
        super().__init__()
        self.macs: Counter[str] = Counter()
        self.part = ""
        self.peak_bytes = 0
        self._live_bytes = 0

    def enter(self, part: str) -> Callable[[nn.Module, object], None]:
        """A forward hook after which operations count for `part`."""

        def hook(_module: nn.Module, _inputs: object) -> None:
            self.part = part

        return hook

    def grow(self, size_bytes: int) -> None:
        self._live_bytes += size_bytes
        self.peak_bytes = max(self.peak_bytes, self._live_bytes)

    def __torch_dispatch__(
        self, func: Any, types: object, args: tuple = (), kwargs: dict | None = None
    ) -> Any:
        outputs = func(*args, **(kwargs or {}))
        several = isinstance(outputs, (tuple, list))
        for i, output in enumerate(outputs if several else (outputs,)):
            if isinstance(output, Tensor):
                self._own(func, i, output, args)
        self.macs[self.part] += _macs(func, args, outputs)
        return outputs

    def _own(self, func: Any, position: int, output: Tensor, args: tuple) -> None:
        """Attaches to an output the memory block that it occupies."""
        returns = func._schema.returns
        if returns[min(position, len(returns) - 1)].alias_info is None:
            block = _Block(self, output.numel() * output.element_size())
            setattr(output, _BLOCK, block)
        elif hasattr(args[0], _BLOCK):  # a view of its input, or the input changed in place
            setattr(output, _BLOCK, getattr(args[0], _BLOCK))


def _macs(func: Any, args: tuple, outputs: Any) -> int:
    name = func._schema.name
    if name == "aten::convolution":
        return outputs.numel() * math.prod(args[1].shape[1:])
    if name in ("aten::mm", "aten::bmm"):
        return outputs.numel() * args[0].shape[-1]
    if name == "aten::addmm":
        return outputs.numel() * args[1].shape[-1]
    if name.startswith("aten::_embedding_bag"):
        table, keys = args[:2]
        return keys.numel() * table.shape[1]
    return 0
