"""Draws the losses of a run and its errors on the validation scenes.

    /usr/bin/python3 -m training.curves training/runs/nano models/nano_curves.png
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import matplotlib
import numpy as np

from training.run_table import CURVES, VALIDATION

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (imported after the backend is chosen)

Table = dict[str, np.ndarray]
_LOSS_PANELS = (
    ("Semantic losses", ("perceived", "reconstructed")),
    ("Joint solver: -log P(truth)", ("joint_x", "joint_y", "joint_yaw")),
    ("Decoupled solver: -log P(truth)", ("dec_x", "dec_y", "dec_yaw")),
    ("Refined solver: -log P(truth)", ("ref_x", "ref_y", "ref_yaw")),
)
_VALIDATION_PANELS = (
    ("Validation scenes: MAE (m, m, degrees)", ("joint_x_mae", "joint_y_mae", "joint_yaw_mae")),
    ("Validation scenes: IoU", ("iou_divider", "iou_crossing", "iou_boundary")),
)
_SMOOTHED_ROWS = 9


def read_table(path: Path) -> Table:
    """The columns of a run's CSV file."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def _smoothed(values: np.ndarray) -> np.ndarray:
    """Moving median."""
    half = _SMOOTHED_ROWS // 2
    padded = np.pad(values, half, mode="edge")
    return np.median(np.lib.stride_tricks.sliding_window_view(padded, _SMOOTHED_ROWS), axis=1)


def _draw_losses(axes: plt.Axes, title: str, curves: Table, names: tuple[str, ...]) -> None:
    axes.set_title(title)
    if not all(name in curves for name in names):
        return  # the run is older than this loss
    seen = np.any([curves[name] > 0 for name in names], axis=0)
    seen[1:] &= seen[:-1]  # the first row of stage 2 still averages zeros of stage 1
    samples = curves["samples"][seen] / 1000
    for name in names:
        values = curves[name][seen]
        (line,) = axes.plot(samples, values, linewidth=0.5, alpha=0.35)
        axes.plot(samples, _smoothed(values), color=line.get_color(), label=name)


def draw(run: Path, out: Path) -> None:
    """Writes a figure with the losses in curves.csv of a run, and with the errors in its
    validation.csv if there is one."""
    curves = read_table(run / CURVES)
    validated = (run / VALIDATION).exists()
    columns = 3 if validated else 2
    size = (4.7 * columns, 6.5)
    figure, panels = plt.subplots(2, columns, figsize=size, constrained_layout=True)
    for axes, (title, names) in zip(panels.flat, _LOSS_PANELS):
        _draw_losses(axes, title, curves, names)
    if validated:
        validation = read_table(run / VALIDATION)
        for axes, (title, names) in zip(panels.flat[len(_LOSS_PANELS) :], _VALIDATION_PANELS):
            axes.set_title(title)
            for name in names:
                axes.plot(validation["samples"] / 1000, validation[name], marker=".", label=name)
    for axes in panels.flat:
        axes.set_xlabel("training samples (thousands)")
        axes.grid(alpha=0.3)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize="small")
    figure.savefig(out, dpi=100)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="folder of the run")
    parser.add_argument("image", type=Path)
    arguments = parser.parse_args()
    draw(arguments.run, arguments.image)
    print(arguments.image)


if __name__ == "__main__":
    main()
