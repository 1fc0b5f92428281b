"""The paper's Fig. 5d: the distributions that several solvers compute for the same scenes."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from evaluation.figures import style

FILE = "solver_distributions.png"
WIDTH_PX = 1568
MARGIN = 30
TOP = 96
IMAGE = (140, 280)
PLOT_WIDTH = 390
PLOT_GAP = 66
ROW = IMAGE[1] + 92
SOLVER_COLOURS = (style.GREEN, style.ORANGE, style.BLUE)
LABELS = {"x_m": "x, m", "y_m": "y, m", "yaw_deg": "yaw, degrees"}
HEADING = (
    "Probability of the correction. Below: mean and reported ±1 sigma of each solver. "
    "Left: the perceived lines over the map at the prior pose."
)


class Solution(TypedDict):
    probability: list[float]
    mean: float
    sigma: float


class AxisData(TypedDict):
    truth: float
    hypotheses: list[float]
    solutions: list[Solution]


class Scene(TypedDict):
    road: str
    perceived: list[list[list[int]]]
    raster_prior: list[list[list[int]]]
    axes: dict[str, AxisData]


class Distributions(TypedDict):
    """The data that evaluation/solver/distribution_figure.h describes."""

    solvers: list[str]
    scenes: list[Scene]


def height_px(scenes: int) -> int:
    return TOP + scenes * ROW


def _draw_axis(figure: Figure, left: float, top: float, name: str, data: AxisData) -> None:
    axes = style.add_axes(figure, left, top, PLOT_WIDTH, IMAGE[1])
    highest = max(max(solution["probability"]) for solution in data["solutions"])
    axes.grid(color=style.GRID)
    axes.axhline(0, color=style.INK, linewidth=1)
    axes.axvline(data["truth"], color=style.TRUTH, linewidth=1.8)
    for k, (solution, colour) in enumerate(zip(data["solutions"], SOLVER_COLOURS)):
        axes.plot(data["hypotheses"], solution["probability"], color=colour, linewidth=1.8)
        axes.errorbar(
            solution["mean"], -0.1 * (k + 1) * highest, xerr=solution["sigma"],
            fmt="o", color=colour, elinewidth=1.8, markersize=6,
        )
    end = data["hypotheses"][-1]
    axes.set_xlim(-end, end)
    axes.set_ylim(-0.42 * highest, 1.08 * highest)
    axes.set_xticks(np.linspace(-end, end, 5))
    axes.set_yticks([tick for tick in axes.get_yticks() if 0 <= tick <= highest])
    axes.set_xlabel(LABELS[name], color=style.INK)


def _draw_scene(figure: Figure, top: float, scene: Scene) -> None:
    image = style.bev_image(np.array(scene["perceived"]) / 255)
    image = style.over_grey(image, np.array(scene["raster_prior"]) / 255)
    axes = style.add_axes(figure, MARGIN, top, *IMAGE)
    style.show_image(axes, image, interpolation="antialiased")
    axes.set_xlabel(scene["road"].replace("_", " "), color=style.INK)
    left = MARGIN + IMAGE[0] + PLOT_GAP
    for name, data in scene["axes"].items():
        _draw_axis(figure, left, top, name, data)
        left += PLOT_WIDTH + PLOT_GAP


def draw(data: Distributions, path: Path) -> None:
    """Draws one row per scene: what was perceived, then P(x), P(y) and P(yaw)."""
    height = height_px(len(data["scenes"]))
    figure = style.new_figure(WIDTH_PX, height)
    style.add_text(figure, MARGIN, 34, HEADING, 12)
    names = [*zip(data["solvers"], SOLVER_COLOURS), ("truth", style.TRUTH)]
    figure.legend(
        handles=[Line2D([], [], color=colour, linewidth=3, label=name) for name, colour in names],
        loc="upper left", ncols=len(names), frameon=False,
        bbox_to_anchor=((MARGIN - 10) / WIDTH_PX, 1 - 42 / height),
    )
    for row, scene in enumerate(data["scenes"]):
        _draw_scene(figure, TOP + row * ROW, scene)
    style.save(figure, path)
