"""Compares the daemon's executor with onnxruntime on a model file (script/check-onnxruntime).

Prints the share of values of each output that differ by at most one quantization step. Outputs are
real numbers; as their step counts the one of an 8-bit representation, the largest value / 127.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch

from tooling.markdown import row, table
from training.data import Batch, view_table
from training.model import IMAGE_OFFSET
from training.runtime import NativeNetwork
from training.sources import simulator_batches

OUTPUTS = ("bev_features", "map_features", "bev_mask")
LEVELS = ("disabled", "all")  # onnxruntime's graph optimisation
REQUIRED_SHARE = 0.999
_HERE = Path(__file__).resolve().parent
_GOLDEN = _HERE.parent / "golden/network"
_LEVELS_OF_8_BITS = 127


@dataclass
class Agreement:
    """The agreement of one output over all samples."""

    share_within_one: float  # share of values within one step
    share_equal: float  # share of values within 0.01 steps, which allows for float rounding
    worst: float  # largest difference in steps


def modules_folder() -> Path:
    """The folder into which script/check-onnxruntime installs onnxruntime."""
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(cache) / "bevloc/onnxruntime/node_modules"


def what_is_missing() -> str:
    """The reason why the check cannot run on this machine; empty if it can."""
    if not shutil.which("node"):
        return "node is not installed"
    if not (modules_folder() / "onnxruntime-node").is_dir():
        return f"{modules_folder()}: found no onnxruntime-node; run script/check-onnxruntime"
    return ""


def golden_samples() -> Batch:
    """The simulated samples of tests/golden: one with all cameras, one with missing cameras."""
    images, raster, cameras = (
        torch.from_numpy(np.load(_GOLDEN / f"{name}.npy"))
        for name in ("images", "raster", "cameras")
    )
    tables = [view_table(int(mask)) for mask in cameras]
    return Batch(
        images=images,
        camera_mask=cameras,
        raster_prior=raster,
        raster_truth=raster,
        correction=torch.zeros(len(images), 3),
        index=torch.stack([index for index, _ in tables]),
        weight=torch.stack([weight for _, weight in tables]),
    )


def _write_inputs(folder: Path, batch: Batch, i: int) -> None:
    folder.mkdir()
    inputs = {
        "images": (batch.images[i].numpy().astype(np.int16) - IMAGE_OFFSET).astype(np.int8),
        "raster": batch.raster_prior[i].numpy(),
        "view_index": batch.index[i].numpy().astype(np.int32),
        "view_weight": batch.weight[i].numpy(),
    }
    for name, values in inputs.items():
        values.tofile(folder / f"{name}.bin")


def run_onnxruntime(model: Path, batch: Batch, level: str) -> list[np.ndarray]:
    """The outputs in the order of OUTPUTS, [samples, values] each."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for i in range(len(batch)):
            _write_inputs(folder / str(i), batch, i)
        script = _HERE / "run_onnxruntime.cjs"
        subprocess.run(
            ["node", script, model, folder, str(len(batch)), level],
            check=True,
            env=os.environ | {"NODE_PATH": str(modules_folder())},
        )
        return [
            np.stack([np.fromfile(folder / f"{i}/{output}.bin", np.float32)
                      for i in range(len(batch))])
            for output in OUTPUTS
        ]


def compare(found: np.ndarray, expected: np.ndarray) -> Agreement:
    step = np.abs(expected).max() / _LEVELS_OF_8_BITS
    error = np.abs(found - expected) / step
    return Agreement(float((error <= 1).mean()), float((error <= 0.01).mean()), float(error.max()))


def agreements(model: Path, batches: list[Batch], level: str) -> dict[str, Agreement]:
    """The agreement of each output."""
    network = NativeNetwork(model)
    ours = [[side.flatten(1).numpy() for side in network(batch)] for batch in batches]
    theirs = [run_onnxruntime(model, batch, level) for batch in batches]
    return {
        name: compare(np.concatenate([t[k] for t in theirs]), np.concatenate([o[k] for o in ours]))
        for k, name in enumerate(OUTPUTS)
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("--samples", type=int, default=16, help="number of evaluation scenes")
    arguments = parser.parse_args()
    if missing := what_is_missing():
        sys.exit(missing)
    batches = [golden_samples(), *simulator_batches(arguments.samples, 1)]
    head = ("onnxruntime's optimisation", "output", "within one step", "equal", "worst, steps")
    print(table(head, (), text_columns=2), end="")
    agree = True
    for level in LEVELS:
        for name, a in agreements(arguments.model, batches, level).items():
            within, equal = f"{100 * a.share_within_one:.4f} %", f"{100 * a.share_equal:.2f} %"
            print(row([str(level), name, within, equal, f"{a.worst:.2f}"]), flush=True)
            agree &= a.share_within_one >= REQUIRED_SHARE
    sys.exit(0 if agree else f"wanted {100 * REQUIRED_SHARE} % within one step of each output")


if __name__ == "__main__":
    main()
