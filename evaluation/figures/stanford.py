"""The Stanford diagrams of docs/integrity.md: error against protection level, axis by axis."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypedDict

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from evaluation.figures import style
from evaluation.figures.source import SourceError

FILE = "stanford.png"
PANEL = 270
GAP = 62
LEFT = 70
TOP = 72
BOTTOM = 58
RIGHT = 20


class Axis(TypedDict):
    axis: str
    unit: str
    alert_limit: float
    bin: float
    bins: int
    counts: list[int]  # [protection level, error], row by row
    misleading: int
    hazardous: int


class Diagram(TypedDict):
    """One element of the output of `bevloc eval integrity --json`."""

    name: str
    drives: int
    drives_with_pose: int
    valid_poses: int
    axes: list[Axis]


def data_of(document: Any, file: Path) -> list[Diagram]:
    """The diagrams with poses of the file with this JSON. SourceError if it has none."""
    keys = {"valid_poses", "drives", "drives_with_pose"}
    if not isinstance(document, list) or not all(
        isinstance(part, dict) and keys <= part.keys() for part in document
    ):
        raise SourceError(
            f"{file}: found no diagrams with {', '.join(sorted(keys))}, wanted the output of "
            "`bevloc eval integrity --json`"
        )
    drawn: list[Diagram] = [diagram for diagram in document if diagram["valid_poses"] > 0]
    if not drawn:
        raise SourceError(f"{file}: found no valid pose in any diagram, wanted some to draw")
    return drawn


def draw_axis(axes: Axes, data: Axis) -> None:
    """Draws the counts over the error (to the right) and the protection level (upwards)."""
    end = data["bin"] * data["bins"]
    counts = np.array(data["counts"], dtype=float).reshape(data["bins"], data["bins"])
    shown = np.ma.masked_equal(counts, 0)
    axes.imshow(
        shown, origin="lower", extent=(0, end, 0, end), aspect="auto", cmap="viridis",
        norm=LogNorm(1, max(counts.max(), 2)), interpolation="nearest",
    )
    limit = data["alert_limit"]
    axes.plot([0, end], [0, end], color=style.INK, linewidth=1)
    axes.axhline(limit, color=style.ORANGE, linewidth=1)
    axes.axvline(limit, color=style.ORANGE, linewidth=1)
    axes.fill([limit, end, end, limit], [0, 0, end, limit], color=style.TRUTH, alpha=0.12)
    axes.set_xlim(0, end)
    axes.set_ylim(0, end)
    axes.set_title(
        f"{data['axis']}: misleading {data['misleading']}, hazardous {data['hazardous']}",
        fontsize=9, color=style.INK,
    )
    axes.set_xlabel(f"error, {data['unit']}", fontsize=9, color=style.INK)
    axes.set_ylabel(f"protection level, {data['unit']}", fontsize=9, color=style.INK)


def heading(diagram: Diagram) -> str:
    drives = f"{diagram['drives_with_pose']} of {diagram['drives']} drives had a pose"
    return f"{diagram['name']}: {diagram['valid_poses']} valid poses, {drives}"


def draw(data: list[Diagram], path: Path) -> None:
    """Draws a row of three panels per diagram. Below the diagonal the error is beyond the
    protection level. In the red part it is beyond the alert limit too."""
    row = TOP + PANEL + BOTTOM
    width = LEFT + 3 * PANEL + 2 * GAP + RIGHT
    figure = style.new_figure(width, row * len(data))
    for number, diagram in enumerate(data):
        top = number * row
        style.add_text(figure, 12, top + 28, heading(diagram), 12)
        for column, axis in enumerate(diagram["axes"]):
            left = LEFT + column * (PANEL + GAP)
            draw_axis(style.add_axes(figure, left, top + TOP, PANEL, PANEL), axis)
    style.save(figure, path)
