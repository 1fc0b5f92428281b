"""Prints the cost of each preset of training/models; --write updates docs/network-variants.md.

    OMP_NUM_THREADS=1 /usr/bin/python3 -m training.model_table [--write]
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from dataclasses import replace
from pathlib import Path

import torch

from tooling.errors import run_program
from tooling.markdown import row, table, write_between_marks
from training.models.config import PRESETS, VIEWS, ModelConfig
from training.models.cost import Cost, cost_of, deployed_outputs, sample_inputs
from training.models.layers import channels_last
from training.models.network import BevNetwork

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "network-variants.md"
BEGIN, END = "<!-- model_table: begin -->\n", "<!-- model_table: end -->\n"
_RUNS = 3
_LONGEST_REPEATED_S = 10.0
_LONGEST_S = 60.0
_MOST_BYTES = 8 * 2**30
_FLOAT_BYTES = 4
# Columns of the table and the network parts that each column adds up.
_COLUMNS = {
    "trunk": ("trunk",),
    "view": ("view",),
    "BEV encoder": ("bev_encoder",),
    "map encoder": ("map_encoder",),
    "to F_B, F_M": ("bev_compress", "map_compress"),
    "head": ("head",),
}
_HEADINGS = (
    *("network", "images", "view", "parameters, M"),
    *(f"{column}, GMAC" for column in _COLUMNS),
    *("all, GMAC", "activations, MiB", "latency, ms"),
)
_TEXT_COLUMNS = 3


def configurations() -> list[ModelConfig]:
    """The presets, and the smallest one with every other view transform."""
    nano = PRESETS["nano"]
    others = [replace(nano, name=f"nano, {view}", view=view) for view in VIEWS if view != nano.view]
    return [nano, *others, *(config for config in PRESETS.values() if config is not nano)]


def counted_cells(config: ModelConfig, cost: Cost) -> list[str]:
    """All cells of a row except the latency."""
    parts = [sum(cost.macs.get(part, 0) for part in parts) for parts in _COLUMNS.values()]
    rows, cols = config.image_size
    return [
        config.name,
        f"{cols} x {rows}",
        config.view,
        f"{cost.parameters / 1e6:.2f}",
        *(f"{macs / 1e9:.3f}" for macs in parts),
        f"{sum(parts) / 1e9:.2f}",
        f"{cost.peak_bytes / 2**20:.0f}",
    ]


@torch.no_grad()
def latency_s(config: ModelConfig) -> float:
    """Processor time of one thread, which depends little on other processes: the median of _RUNS
    runs after a warm-up run, or of a slow network the first run."""
    network = channels_last(BevNetwork(config).eval())
    inputs = sample_inputs(config, "cpu")
    seconds = _seconds(network, inputs)
    if seconds > _LONGEST_REPEATED_S:
        return seconds
    return statistics.median(_seconds(network, inputs) for _ in range(_RUNS))


def _seconds(network: BevNetwork, inputs: tuple) -> float:
    start = time.process_time()
    deployed_outputs(network, *inputs)
    return time.process_time() - start


def measured_table() -> str:
    """Measures all networks and prints each row at once. Networks that need too much memory, or
    would take too long at the lowest speed measured so far, are not run."""
    rows: list[list[str]] = []
    print(table(_HEADINGS, rows, _TEXT_COLUMNS), end="", flush=True)
    least_speed = math.inf  # multiply-accumulates a second
    for config in configurations():
        cost = cost_of(config)
        macs = sum(cost.macs.values())
        if cost.peak_bytes + _FLOAT_BYTES * cost.parameters > _MOST_BYTES:
            latency = f"not run: over {_MOST_BYTES / 2**30:.0f} GiB"
        elif macs / least_speed > _LONGEST_S:
            latency = f"not run: over {_LONGEST_S:.0f} s expected"
        else:
            seconds = latency_s(config)
            least_speed = min(least_speed, macs / seconds)
            latency = f"{1e3 * seconds:.0f}"
        rows.append([*counted_cells(config, cost), latency])
        print(row(rows[-1]), flush=True)
    return table(_HEADINGS, rows, _TEXT_COLUMNS)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="update docs/network-variants.md")
    write = parser.parse_args().write
    torch.set_num_threads(1)
    new_table = measured_table()
    if write:
        write_between_marks(DOCUMENT, BEGIN, END, new_table)


if __name__ == "__main__":
    run_program(main)
