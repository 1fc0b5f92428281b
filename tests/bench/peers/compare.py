"""Times bevloc and its peers alternately and prints one table of ratios (tests/bench/peers/run).

Each round runs bevloc, onnxruntime and PyTorch once per number of threads, each in its own process.
A cell is the median over the rounds of the medians within each round.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from evaluation.figures.program import bevloc_program
from tests.bench.document import ROOT, write_table
from tests.training.onnxruntime_check import modules_folder, what_is_missing
from tooling.errors import run_program
from tooling.markdown import table
from training.data import view_table
from training.model import IMAGE_OFFSET

_HERE = Path(__file__).resolve().parent
_GOLDEN = ROOT / "tests/golden/network"
_ALL_CAMERAS = 0x3F


@dataclass
class Comparison:
    """The medians of the rounds in ms, by number of threads, for one piece of work."""

    title: str
    ours: dict[int, list[float]] = field(default_factory=dict)
    theirs: dict[int, list[float]] = field(default_factory=dict)

    def add(self, threads: int, ours_ms: float, theirs_ms: float) -> None:
        self.ours.setdefault(threads, []).append(ours_ms)
        self.theirs.setdefault(threads, []).append(theirs_ms)

    def ratio(self, threads: int) -> float:
        return statistics.median(self.theirs[threads]) / statistics.median(self.ours[threads])


def write_inputs(folder: Path) -> None:
    """Writes a simulated frame (tests/golden) for onnxruntime."""
    index, weight = view_table(_ALL_CAMERAS)
    images = np.load(_GOLDEN / "images.npy")[0].astype(np.int16) - IMAGE_OFFSET
    inputs = {
        "images": images.astype(np.int8),
        "raster": np.load(_GOLDEN / "raster.npy")[0],
        "view_index": index.numpy().astype(np.int32),
        "view_weight": weight.numpy(),
    }
    for name, values in inputs.items():
        values.tofile(folder / f"{name}.bin")


def run_bevloc(config: Path, folder: Path, threads: int, frames: int) -> dict:
    """Returns what `bevloc bench --json` writes."""
    result = folder / "bevloc.json"
    command: list[str | Path] = [bevloc_program(), "bench", "--config", config, "--json", result]
    command += ["--frames", str(frames), "--threads", str(threads)]
    subprocess.run(command, check=True, stdout=subprocess.PIPE)
    return json.loads(result.read_text())


def run_onnxruntime(model: Path, folder: Path, threads: int, runs: int) -> float:
    script = _HERE / "onnxruntime.cjs"
    command: list[str | Path] = ["node", script, model, folder, str(threads), str(runs)]
    environment = os.environ | {"NODE_PATH": str(modules_folder())}
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, env=environment)
    return statistics.median(json.loads(done.stdout))


def run_torch(threads: int, runs: int) -> dict[str, float]:
    """Returns the median time of each part."""
    command = [sys.executable, "-m", "tests.bench.peers.torch_pipeline"]
    done = subprocess.run(
        [*command, "--threads", str(threads), "--runs", str(runs)],
        check=True,
        stdout=subprocess.PIPE,
        env=os.environ | {"OMP_NUM_THREADS": str(threads)},
    )
    return {part: statistics.median(times) for part, times in json.loads(done.stdout).items()}


def network_ms(bench: dict) -> float:
    """Median time of the image and the map branch together."""
    stages = {stage["name"]: stage["p50_ms"] for stage in bench["stages"]}
    return stages["network-images"] + stages["network-map"]


def configuration_with(model: Path, folder: Path) -> Path:
    """Writes the demo's configuration with another model."""
    demo = ROOT / "config/demo.yaml"
    text = demo.read_text().replace("rig_demo.yaml", str(demo.parent / "rig_demo.yaml"))
    config = folder / "bench.yaml"
    config.write_text(text.replace("../models/nano.onnx", str(model.resolve())))
    return config


def compare(model: Path, rounds: int, frames: int, thread_counts: list[int]) -> list[Comparison]:
    onnxruntime = Comparison("network: onnxruntime, same int8 file")
    torch_network = Comparison("network: PyTorch, float32")
    torch_frame = Comparison("decoded images to pose: PyTorch, float32")
    torch_part = Comparison("the same, PyTorch without its NumPy raster, bevloc with raster")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_inputs(folder)
        config = configuration_with(model, folder)
        for done in range(rounds):
            for threads in thread_counts:
                ours = run_bevloc(config, folder, threads, frames)
                theirs = run_onnxruntime(model, folder, threads, frames)
                reference = run_torch(threads, max(3, frames // 4))
                onnxruntime.add(threads, network_ms(ours), theirs)
                torch_network.add(threads, network_ms(ours), reference["network"])
                frame_ms, reference_ms = ours["frame"]["p50_ms"], sum(reference.values())
                torch_frame.add(threads, frame_ms, reference_ms)
                torch_part.add(threads, frame_ms, reference_ms - reference["raster"])
            print(f"round {done + 1} of {rounds}", file=sys.stderr, flush=True)
    return [onnxruntime, torch_network, torch_frame, torch_part]


def table_of(comparisons: list[Comparison], thread_counts: list[int]) -> str:
    """Markdown table; "peer / bevloc" is how many times as long the peer takes."""
    headings = ["work: peer"]
    for threads in thread_counts:
        unit = "thread" if threads == 1 else "threads"
        headings += [f"bevloc, ms, {threads} {unit}", "peer, ms", "peer / bevloc"]
    rows = []
    for comparison in comparisons:
        cells = [comparison.title]
        for threads in thread_counts:
            sides = comparison.ours[threads], comparison.theirs[threads]
            cells += [f"{statistics.median(side):.2f}" for side in sides]
            cells.append(f"{comparison.ratio(threads):.2f}")
        rows.append(cells)
    return table(headings, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--frames", type=int, default=80, help="of each run; PyTorch: a quarter")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--model", type=Path, default=ROOT / "models/nano.onnx")
    parser.add_argument("--write", action="store_true", help="update docs/performance.md")
    arguments = parser.parse_args()
    if missing := what_is_missing():
        sys.exit(missing)
    comparisons = compare(
        arguments.model, arguments.rounds, arguments.frames, arguments.threads
    )
    text = table_of(comparisons, arguments.threads)
    print(text, end="")
    if arguments.write:
        write_table("peers", text)


if __name__ == "__main__":
    run_program(main)
