"""Measures the cost of quantization: the error of every layer and of the pose.

    /usr/bin/python3 -m training.quantization_report CHECKPOINT [--write docs/quantization.md]

It uses the checkpoint's own quantization (training.qat) or makes a new one like
training.export_onnx. Errors are measured on evaluation scenes, --layer-samples for the layers and
--samples for the pose.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import torch
from torch import Tensor

from tooling.errors import run_program
from tooling.markdown import table, write_between_marks
from tooling.option_types import positive
from training.checkpoint import load_network, nuisances_of, read_checkpoint
from training.data import Batch
from training.evaluate import AXES, Inference
from training.export_onnx import calibration_batches, check_simulated, quantization_of
from training.layer_errors import LayerError, layer_errors
from training.models.network import BevNetwork
from training.quantize import FloatBackend, Quantization, int8_inference, run
from training.solver import PoseSolvers
from training.sources import BATCH, simulator_batches

BEGIN, END = "<!-- quantization_report: begin -->\n", "<!-- quantization_report: end -->\n"
SOLVER = "block"
_UNITS = ("m", "m", "degrees")


def _decibels(ratio: float) -> str:
    return "exact" if math.isinf(ratio) else f"{ratio:.1f}"


def _percent(share: float) -> str:
    return f"{100 * share:.3f}"


def layer_table(errors: list[LayerError]) -> str:
    header = [
        *("layer", "largest weight", "largest output", "step", "saturated, %"),
        *("output, only this layer int8, dB", "output, all layers int8, dB"),
        *("F_B, only this layer int8, dB", "F_M, only this layer int8, dB"),
    ]
    rows = [
        [
            f"`{e.name}`",
            "" if e.largest_weight is None else f"{e.largest_weight:.2f}",
            f"{e.largest_output:.2f}",
            "float" if e.step is None else f"{e.step:.4f}",
            "" if e.saturated is None else _percent(e.saturated),
            *map(_decibels, (e.alone_db, e.together_db, e.bev_db, e.map_db)),
        ]
        for e in errors
    ]
    return table(header, rows)


def float_inference_of(net: BevNetwork, quantization: Quantization) -> Inference:
    """The network with folded batch normalisation, not quantized."""
    return lambda batch: run(net, quantization.convolutions, FloatBackend(batch), batch)


@torch.no_grad()
def pose_errors(
    infer: Inference, solvers: PoseSolvers, batches: list[Batch]
) -> Tensor:
    """The absolute errors of SOLVER, [samples, 3]: m, m, degrees."""
    errors: list[Tensor] = []
    for batch in batches:
        bev, features_map, _ = infer(batch)
        error = solvers.solve(SOLVER, bev, features_map).estimate - batch.correction
        errors.append(error.abs())
    return torch.cat(errors) * torch.tensor([1.0, 1.0, 180.0 / math.pi])


def pose_table(exact: Tensor, rounded: Tensor) -> str:
    """A table of both MAE and the mean of the paired differences with its standard error."""
    difference = rounded - exact
    spread = difference.std(0) / math.sqrt(len(difference))
    rows = [
        [
            f"{SOLVER}, {axis} ({_UNITS[i]})",
            f"{exact[:, i].mean():.4f}",
            f"{rounded[:, i].mean():.4f}",
            f"{difference[:, i].mean():+.4f} ± {spread[i]:.4f}",
        ]
        for i, axis in enumerate(AXES)
    ]
    return table(["MAE", "float", "int8", "int8 - float"], rows)


def report(
    net: BevNetwork, quantization: Quantization, layer_batches: list[Batch], batches: list[Batch]
) -> str:
    """Both tables as Markdown."""
    layers = layer_table(layer_errors(net, quantization, layer_batches))
    infer = float_inference_of(net, quantization), int8_inference(net, quantization)
    exact, rounded = (pose_errors(side, net.solvers, batches) for side in infer)
    layer_scenes, pose_scenes = (sum(map(len, part)) for part in (layer_batches, batches))
    return (
        f"Pose, {pose_scenes} evaluation scenes:\n\n{pose_table(exact, rounded)}\n"
        f"Layers, {layer_scenes} evaluation scenes:\n\n{layers}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("--samples", type=positive, default=256, help="scenes for the pose errors")
    parser.add_argument(
        "--layer-samples", type=positive, default=16, help="scenes for the layer errors"
    )
    parser.add_argument(
        "--calibration", type=positive, default=384, help="number of calibration samples"
    )
    parser.add_argument("--threads", type=positive, default=1)
    parser.add_argument("--write", type=Path, help="document whose tables are updated")
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    check_simulated(read_checkpoint(arguments.checkpoint)["config"], arguments.checkpoint)
    net = load_network(arguments.checkpoint)
    calibration = calibration_batches(
        arguments.calibration, arguments.threads, nuisances_of(arguments.checkpoint)
    )
    quantization = quantization_of(net, arguments.checkpoint, calibration)
    batches = simulator_batches(arguments.samples, arguments.threads)
    layer_batches = batches[: math.ceil(arguments.layer_samples / BATCH)]
    text = report(net, quantization, layer_batches, batches)
    print(text, end="")
    if arguments.write:
        write_between_marks(arguments.write, BEGIN, END, text)


if __name__ == "__main__":
    run_program(main)
