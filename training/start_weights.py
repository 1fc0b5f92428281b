"""The weights that a new run starts with: those of a checkpoint or of a float model file.

A model file holds each batch normalisation folded into its convolution. The run needs them apart,
so this module measures the statistics that unfold them on some samples.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from training.checkpoint import load_weights, read_checkpoint
from training.data import Batch
from training.errors import CheckpointError
from training.graph import RASTER_GAIN, RASTER_LAYER
from training.model import RASTER_CHANNELS, real_images, real_raster
from training.models.layers import ConvBn, bias_of, running_statistics
from training.models.network import BevNetwork

_SCALE = "bevloc.solver.{}_scale"


def start_with(net: BevNetwork, path: Path, make_batches: Callable[[], list[Batch]]) -> None:
    """Loads the averaged weights of a checkpoint, or the weights of a float model file (.onnx) into
    a network on the CPU. `make_batches` makes the samples on which the statistics of a model file
    are measured. CheckpointError if the file is unreadable or holds another network."""
    if path.suffix == ".onnx":
        load_model_file(net, path)
        _unfold(net, make_batches())
    else:
        load_weights(net, read_checkpoint(path), "ema", path)


def load_model_file(net: BevNetwork, path: Path) -> None:
    """Loads the folded convolutions; the batch normalisations only add the bias. CheckpointError if
    the file is unreadable or holds another network."""
    import onnx  # a training bundle starts from a checkpoint and does without it
    from onnx import numpy_helper

    try:
        model = onnx.load(str(path))
    except Exception as error:  # a damaged file makes protobuf raise anything
        raise CheckpointError(f"{path}: unreadable as a model ({error})") from error
    values = {item.name: numpy_helper.to_array(item) for item in model.graph.initializer}
    stated = {item.key: item.value for item in model.metadata_props}
    if (found := stated.get("bevloc.model", "")) != net.config.name:
        raise CheckpointError(f"{path}: holds the network '{found}', wanted '{net.config.name}'")
    with torch.no_grad():
        for name, module in net.named_modules():
            if isinstance(module, ConvBn):
                weight = _tensor(values, f"{name}.weight", module.conv.weight, path)
                module.conv.weight.copy_(_of_raster(weight) if name == RASTER_LAYER else weight)
                mean, variance = running_statistics(module.bn)
                mean.zero_()
                variance.fill_(1.0 - module.bn.eps)
                module.bn.weight.fill_(1.0)
                module.bn.bias.copy_(_tensor(values, f"{name}.bias", module.bn.bias, path))
        last = net.head.second
        last.weight.copy_(_tensor(values, "head.second.weight", last.weight, path))
        bias_of(last).copy_(_tensor(values, "head.second.bias", bias_of(last), path))
        for name, logarithm in net.solvers.log_scale.items():
            if _SCALE.format(name) not in stated:
                raise CheckpointError(f"{path}: found no {_SCALE.format(name)} in the metadata")
            logarithm.fill_(float(np.log(float(stated[_SCALE.format(name)]))))


def _of_raster(weight: Tensor) -> Tensor:
    """The weights of RASTER_LAYER from those of the file, which orders the blocks of the raster
    (row, column, channel) and has another step of its values (training/onnx_graph.py)."""
    blocks = weight.unflatten(1, (2, 2, RASTER_CHANNELS))
    return blocks.permute(0, 3, 1, 2, 4, 5).flatten(1, 3) / RASTER_GAIN


def _tensor(values: dict[str, np.ndarray], name: str, wanted: Tensor, path: Path) -> Tensor:
    found = values.get(name)
    if found is None or found.shape != wanted.shape or found.dtype != np.float32:
        what = "nothing" if found is None else f"{found.dtype} {list(found.shape)}"
        raise CheckpointError(f"{path}: {name}: found {what}, wanted float32 {list(wanted.shape)}")
    return torch.from_numpy(found.copy())


@torch.no_grad()
def _unfold(net: BevNetwork, batches: list[Batch]) -> None:
    """Gives each batch normalisation the mean and variance of its input, and a gain and bias that
    leave its output as it is."""
    sums: dict[nn.Module, list[Tensor]] = {}

    def measure(bn: nn.Module, inputs: tuple[Tensor, ...]) -> None:
        x = inputs[0].double().transpose(0, 1).flatten(1)
        count = torch.tensor(float(x.shape[1]))
        parts = [count, x.sum(1), x.square().sum(1)]
        before = sums.get(bn)
        sums[bn] = parts if before is None else [a + b for a, b in zip(before, parts)]

    layers = [module.bn for module in net.modules() if isinstance(module, ConvBn)]
    hooks = [bn.register_forward_pre_hook(measure) for bn in layers]
    net.eval()
    for batch in batches:
        net(real_images(batch.images), batch.index, batch.weight, real_raster(batch.raster_prior))
    for hook in hooks:
        hook.remove()
    for bn in layers:
        count, total, squares = sums[bn]
        mean = total / count
        variance = (squares / count - mean.square()).clamp_min(0.0)
        old_mean, old_variance = running_statistics(bn)
        gain = bn.weight / torch.sqrt(old_variance + bn.eps)
        bn.bias.add_(gain * (mean.float() - old_mean))
        bn.weight.copy_(gain * torch.sqrt(variance + bn.eps).float())
        old_mean.copy_(mean)
        old_variance.copy_(variance)
