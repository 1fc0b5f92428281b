"""Quantizes a trained network and writes it as standard ONNX.

    /usr/bin/python3 -m training.export_onnx training/runs/nano/checkpoint.pt models

Writes NETWORK.onnx (int8, QDQ) and NETWORK_float.onnx into the folder. The ranges of int8 and the
scales of the solvers are those of simulated samples, or with `--recordings DIR --map FILE` of the
calibration part of recorded drives. Writes quantization.pt and solvers.pt (the solvers with the
scales of the model files) next to the checkpoint.

Inputs of the model: images int8 [6, 3, 96, 320] (RGB - 128), raster uint8 [1, 3, 400, 200],
view_index int32 [8, 5000] and view_weight float [8, 5000] (pipeline/network/view/view_table.h).
Outputs, in float: bev_features and map_features [1, 16, 100, 50], bev_mask (logits)
[1, 3, 400, 200].
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import onnx
import torch
import yaml
from onnx import TensorProto, helper

from tooling.errors import run_program
from tooling.option_types import positive
from training.checkpoint import load_network, nuisances_of, read_checkpoint
from training.config import CALIBRATION_SEEDS, FIRST_TRAINING_SEED, TrainingConfig
from training.data import Batch, SamplerStream
from training.errors import TrainingError
from training.fit_scales import ResultScales, fit_scales, fit_score_scale, fit_sigma_scale
from training.graph import FoldedConv, Walk, check_exportable, folded_convolutions
from training.model import (
    BEV_COLS,
    BEV_ROWS,
    CAMERAS,
    IMAGE_COLS,
    IMAGE_ROWS,
    RASTER_CHANNELS,
    VIEW_SLOTS,
)
from training.models.network import BevNetwork
from training.onnx_graph import MASK_OUTPUT, FloatOnnxBackend, Int8OnnxBackend
from training.options import DRIVE_FIELDS, add_drive_options, drives_of, option_name
from training.quantize import Quantization, input_scales, int8_inference, quantize
from training.rig_ranges import RANGE_KEYS, RigRanges, drawn_ranges, stored_ranges
from training.runtime import NativeNetwork, NativeSolver
from training.sampler_process import DriveFacts, Drives
from training.sources import calibration_set

OPSET, IR_VERSION = 13, 8
QUANTIZATION_FILE = "quantization.pt"
SOLVERS_FILE = "solvers.pt"
# The simulator's cameras vary around this rig.
TRAINED_RIG = Path(__file__).parent.parent / "config/rig_demo.yaml"
SHIPPED_SOLVER = "banded+refine"  # config/demo.yaml
# Training scenes that no run reaches.
CALIBRATION_SEED = FIRST_TRAINING_SEED + CALIBRATION_SEEDS


def _info(name: str, kind: int, shape: list[int]) -> onnx.ValueInfoProto:
    return helper.make_tensor_value_info(name, kind, shape)


def _inputs() -> list[onnx.ValueInfoProto]:
    table_shape = [VIEW_SLOTS, BEV_ROWS * BEV_COLS]
    raster_shape = [1, RASTER_CHANNELS, 4 * BEV_ROWS, 4 * BEV_COLS]
    return [
        _info("images", TensorProto.INT8, [CAMERAS, 3, IMAGE_ROWS, IMAGE_COLS]),
        _info("raster", TensorProto.UINT8, raster_shape),
        _info("view_index", TensorProto.INT32, table_shape),
        _info("view_weight", TensorProto.FLOAT, table_shape),
    ]


def _outputs(net: BevNetwork) -> list[onnx.ValueInfoProto]:
    feature_shape = [1, net.bev_compress[-1].second.conv.out_channels, BEV_ROWS, BEV_COLS]
    mask_shape = [1, RASTER_CHANNELS, 4 * BEV_ROWS, 4 * BEV_COLS]
    return [
        _info("bev_features", TensorProto.FLOAT, feature_shape),
        _info("map_features", TensorProto.FLOAT, feature_shape),
        _info(MASK_OUTPUT, TensorProto.FLOAT, mask_shape),
    ]


def metadata(net: BevNetwork, result: ResultScales) -> dict[str, str]:
    """The model's metadata: the solver parameters that the C++ code reads."""
    scales = {
        f"bevloc.solver.{name}_scale": f"{net.solvers.scale(name).item():.6g}"
        for name in net.solvers.log_scale
    }
    return {
        "bevloc.model": net.config.name,
        **scales,
        "bevloc.solver.sigma_scale": f"{result.sigma:.6g}",
        "bevloc.solver.score_scale": f"{result.score:.6g}",
        "bevloc.solver.gem_omega": "1",
    }


def _range_statements(rigs: list[RigRanges]) -> dict[str, str]:
    """The ranges that the model states if it was trained on several rigs; empty for one rig."""
    if not rigs:
        return {}
    fields = [rig.focal_px for rig in rigs], [rig.height_m for rig in rigs]
    values = [[value for found in field for value in found] for field in fields]
    return {key: f"{min(found):.4g} {max(found):.4g}" for key, found in zip(RANGE_KEYS, values)}


def rig_statements(
    nuisances: str = "usual",
    facts: DriveFacts | None = None,
    rig_file: Path = TRAINED_RIG,
    stored: list[RigRanges] | None = None,
) -> dict[str, str]:
    """What the model states about the cameras that it was trained with, so that bevlocd can refuse
    a rig of very different ones (pipeline/network/model/model_rig.h). `nuisances`: of training.
    `facts`: those of the drives of training, if any. `stored`: stored_ranges(), which are those of
    the training where there are any. A network that knows other rigs knows the one of `rig_file`
    too."""
    cameras = yaml.safe_load(rig_file.read_text())["cameras"]
    focal_px = [c["fx_px"] * IMAGE_COLS / c["image_size_px"][0] for c in cameras.values()]
    height_m = [c["vehicle_from_camera"]["translation_m"][2] for c in cameras.values()]
    ranges = drawn_ranges(nuisances) if stored is None else list(stored)
    if facts is not None:
        ranges.append(RigRanges.of_drives(facts))
    if ranges:
        ranges.append(RigRanges((min(focal_px), max(focal_px)), (min(height_m), max(height_m))))
    return _range_statements(ranges) | {
        "bevloc.rig.cameras": " ".join(cameras),
        "bevloc.rig.image_size_px": f"{IMAGE_COLS} {IMAGE_ROWS}",
        "bevloc.rig.focal_px": " ".join(f"{value:.4g}" for value in focal_px),
        "bevloc.rig.height_m": " ".join(f"{value:.4g}" for value in height_m),
    }


def build_model(
    net: BevNetwork,
    convolutions: dict[str, FoldedConv],
    backend: FloatOnnxBackend,
    result: ResultScales = ResultScales(),
    rig: Mapping[str, str] | None = None,
) -> onnx.ModelProto:
    """The whole network as one ONNX model, written by `backend`. `rig`: rig_statements(); None:
    those of a network that was trained on one rig."""
    inputs = input_scales()
    walk = Walk(net, convolutions, backend)
    bev, _ = walk.run_images(backend.dequantize("images", inputs["images"]))
    features_map = walk.run_map(backend.dequantize("raster", inputs["raster"]))
    backend.node("Identity", [bev], "bev_features")
    backend.node("Identity", [features_map], "map_features")
    graph = helper.make_graph(
        backend.nodes, net.config.name, _inputs(), _outputs(net), backend.initializers
    )
    model = helper.make_model(
        graph,
        producer_name="bevloc",
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
    )
    stated = rig_statements() if rig is None else dict(rig)
    helper.set_model_props(model, metadata(net, result) | stated)
    onnx.checker.check_model(model, full_check=True)
    return model


def calibration_batches(
    samples: int, threads: int = 1, nuisances: str = "usual"
) -> list[Batch]:
    """Samples with the nuisances of training, so that int8 ranges and sigmas hold for them."""
    stream = SamplerStream(CALIBRATION_SEED, 0, threads, 0.1, nuisances=nuisances)
    batches = [stream.next(8) for _ in range(0, samples, 8)]
    stream.close()
    return batches


def check_source(config: Mapping[str, Any], checkpoint: Path, drives: Drives | None) -> None:
    """TrainingError if a run had other samples than those of this export. `config`: of the run."""
    if folder := config.get("nuscenes"):
        raise TrainingError(
            f"{checkpoint}: found a run on nuScenes ({folder}), which cannot be exported; give a "
            "run on the simulator, or one on recorded drives with --recordings and --map"
        )
    if config.get("recordings"):
        _check_drives(config, checkpoint, drives)


def _check_drives(config: Mapping[str, Any], checkpoint: Path, drives: Drives | None) -> None:
    """TrainingError if an export does not have the drives of its run, or has other calibrations or
    reference poses of them. The files may have been moved. `config`: of the run."""
    reference = config.get("reference", TrainingConfig.reference)
    if drives and bool(drives.rig) == bool(config.get("rig")) and drives.reference == reference:
        return
    defaults = TrainingConfig().as_dict()
    options = " ".join(
        f"{option_name(field)} {config[field]}"
        for field in DRIVE_FIELDS
        if config.get(field, defaults[field]) != defaults[field]
    )
    raise TrainingError(
        f"{checkpoint}: found a run on recorded drives, wanted these drives, with the same rig and "
        f"reference poses, for the ranges of int8 and sigma; give {options}"
    )


def check_simulated(config: Mapping[str, Any], checkpoint: Path) -> None:
    """TrainingError if a run had other samples than simulated ones, for programs that use only
    those. `config`: of the run."""
    for option, samples in (("nuscenes", "nuScenes"), ("recordings", "recorded drives")):
        if folder := config.get(option):
            raise TrainingError(
                f"{checkpoint}: found a run on {samples} ({folder}), wanted one on the simulator"
            )


def fitting_batches(
    drives: Drives | None, nuisances: str, samples: int, threads: int
) -> tuple[list[Batch], list[Batch]]:
    """Samples for the ranges of int8 and for sigma, and those for the score. Training used none of
    them."""
    if drives is not None:
        batches = calibration_set(drives, samples, threads)
        return batches, batches
    batches = calibration_batches(samples, threads, nuisances)
    # Samples with rare nuisances have lower scores, and most of a drive has no such nuisance.
    return batches, batches if nuisances == "usual" else calibration_batches(samples, threads)


def quantization_of(net: BevNetwork, checkpoint: Path, calibration: list[Batch]) -> Quantization:
    """The checkpoint's own quantization if it has one (training.qat), else a new one from
    `calibration`."""
    trained = read_checkpoint(checkpoint).get("quantization")
    return Quantization.of_state(net, trained) if trained else quantize(net, calibration)


def write_model(
    net: BevNetwork,
    quantization: Quantization,
    result: ResultScales,
    rig: Mapping[str, str],
    folder: Path,
) -> None:
    """Writes both model files. `rig`: rig_statements()."""
    name = net.config.name
    int8_backend = Int8OnnxBackend(quantization)
    int8_model = build_model(net, quantization.convolutions, int8_backend, result, rig)
    onnx.save(int8_model, str(folder / f"{name}.onnx"))
    float_model = build_model(net, folded_convolutions(net), FloatOnnxBackend(), result, rig)
    onnx.save(float_model, str(folder / f"{name}_float.onnx"))


def fit_result(
    net: BevNetwork,
    quantization: Quantization,
    rig: Mapping[str, str],
    batches: list[Batch],
    usual: list[Batch],
    threads: int,
) -> ResultScales:
    """Fits the scales of sigma (`batches`) and score (`usual`) on the daemon's own network and
    solver. TrainingError if the daemon would refuse them."""
    with tempfile.TemporaryDirectory() as folder:
        write_model(net, quantization, ResultScales(), rig, Path(folder))
        network = NativeNetwork(Path(folder) / f"{net.config.name}.onnx", threads)
        solver = NativeSolver(network, SHIPPED_SOLVER)
        return ResultScales(
            fit_sigma_scale(network, solver, batches), fit_score_scale(network, solver, usual)
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("models", type=Path, help="folder for the model files")
    parser.add_argument("--calibration", type=positive, default=384, help="number of samples")
    parser.add_argument("--threads", type=positive, default=1)
    add_drive_options(parser)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    net = load_network(arguments.checkpoint)
    check_exportable(net.config)
    nuisances = nuisances_of(arguments.checkpoint)
    drives = drives_of(arguments) if arguments.recordings else None
    config = read_checkpoint(arguments.checkpoint)["config"]
    check_source(config, arguments.checkpoint, drives)
    facts = drives.facts() if drives else None
    rig = rig_statements(nuisances, facts, stored=stored_ranges(config))
    batches, usual = fitting_batches(drives, nuisances, arguments.calibration, arguments.threads)
    quantization = quantization_of(net, arguments.checkpoint, batches)
    quantization.save(arguments.checkpoint.with_name(QUANTIZATION_FILE))
    fit_scales(net.solvers, int8_inference(net, quantization), batches)
    torch.save(net.solvers.state_dict(), arguments.checkpoint.with_name(SOLVERS_FILE))
    result = fit_result(net, quantization, rig, batches, usual, arguments.threads)
    arguments.models.mkdir(parents=True, exist_ok=True)
    shipped = arguments.models / f"{net.config.name}.onnx"
    write_model(net, quantization, result, rig, arguments.models)
    for path in (shipped, shipped.with_name(f"{net.config.name}_float.onnx")):
        print(f"{path}: {path.stat().st_size / 1e6:.2f} MB", flush=True)


if __name__ == "__main__":
    run_program(main)
