"""Compares two model files on the held-back places of recorded drives.

    /usr/bin/python3 -m training.drive_report models/nano.onnx RUN/nano.onnx --recordings DIR \\
        --map FILE --out RUN/report.md

Both run on the daemon's own network and solvers, with the same priors. The report says what the
drives contain, and for both models the errors, how often they lie within three sigma, and how well
they perceive.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from tooling.errors import run_program
from tooling.markdown import table
from tooling.option_types import positive, writable
from training.evaluate import AXES, CLASSES, evaluate_native
from training.export_onnx import SHIPPED_SOLVER
from training.options import add_drive_options, drives_of
from training.runtime import NativeNetwork
from training.sampler_process import Drives
from training.sources import FEWEST_SAMPLES, drive_batches

UNITS = ("m", "m", "degrees")
NAMES = ("longitudinal", "lateral", "yaw")


def figures_table(before: dict[str, float], after: dict[str, float]) -> str:
    """The figures of both models as a Markdown table."""
    rows = []

    def add(name: str, key: str, percent: bool = False) -> None:
        shown = [f"{100 * m[key]:.1f} %" if percent else f"{m[key]:.3f}" for m in (before, after)]
        rows.append([name, *shown])

    for axis, name, unit in zip(AXES, NAMES, UNITS):
        add(f"{name}, mean error, {unit}", f"{SHIPPED_SOLVER}_{axis}_mae")
        add(f"{name}, 90 % below, {unit}", f"{SHIPPED_SOLVER}_{axis}_p90")
        add(f"{name}, within 3 sigma", f"{SHIPPED_SOLVER}_{axis}_within_3_sigma", percent=True)
    for name in CLASSES:
        add(f"IoU of {name}", f"iou_{name}")
    return table(("figure", "before", "after"), rows)


def remarks(drives: Drives, used: int) -> list[str]:
    """What limits the trust in the figures of so many samples, in lines."""
    lines = []
    if used < FEWEST_SAMPLES:
        lines += [f"Fewer than {FEWEST_SAMPLES} samples: do not trust these figures.", ""]
    if drives.reference == "own":
        lines += [
            "The reference is what the appliance sent itself. So the errors are too small where"
            " both models err as the appliance did, and the sigmas of the new model are too small"
            " by the same errors.",
            "",
        ]
    return lines


def report(
    before: Path, after: Path, drives: Drives, samples: int, threads: int
) -> str:
    """The text of the report."""
    networks = [NativeNetwork(model, threads) for model in (before, after)]
    counts = drives.facts().samples
    batches = drive_batches(drives, "held-back", samples, threads)
    metrics = [evaluate_native(network, batches) for network in networks]
    used = sum(len(batch) for batch in batches)
    lines = [
        "# Recorded drives, before and after training",
        "",
        f"- Drives: `{drives.recordings}` with the map `{drives.map}`",
        f"- Reference poses: {drives.reference}",
        f"- Samples: {counts['training']} for training, {counts['calibration']} for calibration, "
        f"{counts['held-back']} held back, {used} of them used here.",
        f"- Before: `{before}`; after: `{after}`; int8, {SHIPPED_SOLVER}. Each sample has a random"
        " prior of up to 2 m, 1 m and 2 degrees.",
        "",
        figures_table(metrics[0], metrics[1]),
    ]
    return "\n".join(lines + remarks(drives, used))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    add_drive_options(parser)
    parser.add_argument("--samples", type=positive, default=512)
    parser.add_argument("--threads", type=positive, default=1)
    parser.add_argument("--out", type=writable, required=True)
    options = parser.parse_args()
    drives = drives_of(options)
    text = report(options.before, options.after, drives, options.samples, options.threads)
    options.out.write_text(text)
    print(text)


if __name__ == "__main__":
    run_program(main)
