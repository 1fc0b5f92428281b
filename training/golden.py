"""Writes the golden vectors against which the C++ code is tested.

    /usr/bin/python3 -m training.golden --checkpoint training/runs/nano/checkpoint.pt \\
        --out tests/golden

solver/   synthetic features and the results of every solver (tests/pipeline/solver), written by
          training/golden_solver.py; needs no checkpoint
network/  simulated samples and the outputs of the float and the quantized network
          (tests/pipeline/network); needs quantization.pt and solvers.pt next to the checkpoint
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import torch

from tooling.errors import run_program
from training.checkpoint import load_network
from training.config import FIRST_GOLDEN_SEED
from training.data import Batch, SamplerStream
from training.errors import TrainingError
from training.evaluate import Inference, float_inference
from training.export_onnx import QUANTIZATION_FILE, SOLVERS_FILE
from training.golden_solver import write_solver_vectors
from training.quantize import Quantization, int8_inference
from training.solver import PoseSolvers, Posterior, standardise

# Every FEATURE_STRIDE-th feature value is written. The stride is coprime to the numbers of rows and
# columns, so all of them occur.
FEATURE_STRIDE = 7


def _distributions(posterior: Posterior) -> np.ndarray:
    """P(x), P(y), P(yaw) side by side, [batch, 21 + 11 + 21]."""
    return torch.cat(posterior.axes(), dim=1).numpy()


def golden_batch() -> Batch:
    """Two samples: one with all cameras, one with missing cameras."""
    parts = []
    for drop_camera_probability in (0.0, 1.0):
        stream = SamplerStream(FIRST_GOLDEN_SEED, 0, 1, drop_camera_probability)
        parts.append(stream.next(1))
        stream.close()
    return Batch.joined(parts)


def _write_outputs(
    out: Path, name: str, infer: Inference, solvers: PoseSolvers, batch: Batch
) -> None:
    bev, features_map, mask = infer(batch)
    np.save(out / f"{name}_bev.npy", bev.flatten(1)[:, ::FEATURE_STRIDE].numpy())
    np.save(out / f"{name}_map.npy", features_map.flatten(1)[:, ::FEATURE_STRIDE].numpy())
    statistics = torch.stack((mask.mean((2, 3)), mask.std((2, 3), unbiased=False)), dim=2)
    np.save(out / f"{name}_mask_mean_std.npy", statistics.numpy())
    sides = standardise(bev), standardise(features_map)
    np.save(out / f"{name}_decoupled.npy", _distributions(solvers.decoupled(*sides, None)))
    np.save(out / f"{name}_joint.npy", _distributions(solvers.joint(*sides)))


def check_exported(checkpoint: Path) -> None:
    """TrainingError if a file that training.export_onnx writes next to a checkpoint is missing."""
    for name in (QUANTIZATION_FILE, SOLVERS_FILE):
        if not (path := checkpoint.with_name(name)).is_file():
            raise TrainingError(f"{path}: no such file, wanted it; run training.export_onnx first")


@torch.no_grad()
def write_network_vectors(checkpoint: Path, out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    net = load_network(checkpoint)
    quantization = Quantization.load(net, checkpoint.with_name(QUANTIZATION_FILE))
    net.solvers.load_state_dict(torch.load(checkpoint.with_name(SOLVERS_FILE)))
    batch = golden_batch()
    np.save(out / "images.npy", batch.images.numpy())
    np.save(out / "raster.npy", batch.raster_prior.numpy())
    np.save(out / "cameras.npy", batch.camera_mask.numpy())
    _write_outputs(out, "float", float_inference(net), net.solvers, batch)
    _write_outputs(out, "int8", int8_inference(net, quantization), net.solvers, batch)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--checkpoint", type=Path, help="without it, only solver/ is written")
    parser.add_argument("--out", type=Path, default=Path("tests/golden"))
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    if arguments.checkpoint:
        check_exported(arguments.checkpoint)
    write_solver_vectors(arguments.out / "solver")
    if arguments.checkpoint:
        write_network_vectors(arguments.checkpoint, arguments.out / "network")
    size = sum(path.stat().st_size for path in arguments.out.rglob("*.npy"))
    print(f"{arguments.out}: {size / 2**20:.2f} MiB")


if __name__ == "__main__":
    run_program(main)
