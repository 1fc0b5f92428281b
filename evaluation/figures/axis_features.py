"""The paper's Fig. 4: what axis matching compares, and how it scores the hypotheses."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evaluation.figures import style

FILE = "solver_axis_features.png"
SIZE_PX = (1464, 888)
MARGIN = 64
TOP = 110
IMAGE = (200, 400)
PROFILE = 96
GAP = 10
BLOCK_GAP = 50
SCORE_MARGIN = (60, 50)
HEADROOM = 0.4  # above the highest value of a profile, as a share of its range

Grid = list[list[float]]


class Side(TypedDict):
    """Features [channel][row][column], and one profile per channel."""

    features: list[Grid]
    x_profile: Grid
    y_profile: Grid


class PerceivedSide(Side):
    x_score: list[float]
    y_score: list[float]


class AxisFeatures(TypedDict):
    """The data that evaluation/solver/axis_figure.h describes."""

    channels: list[str]
    shift_m: float
    x_m: list[float]
    y_m: list[float]
    hypotheses_m: list[float]
    map: Side
    perceived: list[PerceivedSide]


def _draw_features(figure: Figure, left: float, caption: str, features: list[Grid]) -> Axes:
    axes = style.add_axes(figure, left, TOP, *IMAGE)
    style.show_image(axes, style.bev_image(features), extent=(15, -15, -30, 30))
    style.add_text(figure, left, TOP - 40, caption, 12)
    return axes


def _value_range(*profiles: list[float]) -> tuple[float, float]:
    low = min(-0.1, *(min(profile) for profile in profiles))
    high = max(0.1, *(max(profile) for profile in profiles))
    return low - 0.1 * (high - low), high + HEADROOM * (high - low)


def _prepare_profile(axes: Axes) -> None:
    axes.set_xticks([])
    axes.set_yticks([])


def _draw_profiles(figure: Figure, left: float, data: AxisFeatures, side: Side) -> None:
    """Draws the profiles along x on the right of the features, and those along y below them."""
    right = left + IMAGE[0] + GAP
    below = TOP + IMAGE[1] + GAP
    for k, channel in enumerate(data["channels"]):
        step = k * (PROFILE + GAP)
        curves = (
            (data["map"], {"color": style.INK, "linewidth": 1}),
            (side, {"color": style.BLUE, "linewidth": 1.8}),
        )
        axes = style.add_axes(figure, right + step, TOP, PROFILE, IMAGE[1])
        for source, look in curves:
            axes.plot(source["x_profile"][k], data["x_m"], **look)
        axes.set_xlim(_value_range(data["map"]["x_profile"][k], side["x_profile"][k]))
        axes.set_ylim(-30, 30)
        axes.axvline(0, color=style.GRID, linewidth=1, zorder=0)
        axes.set_title(channel, fontsize=9, color=style.INK)
        _prepare_profile(axes)
        axes = style.add_axes(figure, left, below + step, IMAGE[0], PROFILE)
        for source, look in curves:
            axes.plot(data["y_m"], source["y_profile"][k], **look)
        axes.set_xlim(15, -15)
        axes.set_ylim(_value_range(data["map"]["y_profile"][k], side["y_profile"][k]))
        axes.axhline(0, color=style.GRID, linewidth=1, zorder=0)
        axes.text(
            0.03, 0.95, channel, transform=axes.transAxes, va="top", fontsize=9, color=style.INK
        )
        _prepare_profile(axes)


def _draw_scores(figure: Figure, left: float, data: AxisFeatures, side: PerceivedSide) -> None:
    right, down = SCORE_MARGIN
    block = 3 * (PROFILE + GAP)
    axes = style.add_axes(
        figure, left + IMAGE[0] + right, TOP + IMAGE[1] + down, block - right, block - down
    )
    hypotheses = np.array(data["hypotheses_m"])
    for name, score, colour in (
        ("s(x)", side["x_score"], style.GREEN),
        ("s(y)", side["y_score"], style.ORANGE),
    ):
        best = int(np.argmax(score))
        axes.plot(hypotheses, score, color=colour, linewidth=1.8, label=name)
        axes.plot(hypotheses[best], score[best], "o", color=colour, markersize=6)
    axes.set_xlim(hypotheses[0], hypotheses[-1])
    axes.set_ylim(-0.2, 1)
    axes.set_xlabel("hypothesis, m", color=style.INK)
    axes.grid(color=style.GRID)
    axes.legend(
        loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False, borderaxespad=0.2
    )


def draw(data: AxisFeatures, path: Path) -> None:
    """Draws the map, and the perceived lines in place and moved, with profiles and scores."""
    figure = style.new_figure(*SIZE_PX)
    axes = _draw_features(figure, MARGIN, "map, at the true pose", data["map"]["features"])
    axes.set_xticks([15, 0, -15])
    axes.set_yticks(range(-30, 31, 10))
    axes.set_xlabel("y, m", color=style.INK)
    axes.set_ylabel("x, m", color=style.INK, labelpad=0)
    captions = (
        "perceived, at the true pose",
        f"the same, moved by {data['shift_m']:g} m forward and left",
    )
    left = MARGIN + IMAGE[0] + BLOCK_GAP
    for caption, side in zip(captions, data["perceived"]):
        _draw_features(figure, left, caption, side["features"])
        _draw_profiles(figure, left, data, side)
        _draw_scores(figure, left, data, side)
        left += IMAGE[0] + 3 * (PROFILE + GAP) + BLOCK_GAP
    handles = [
        figure.axes[1].plot([], [], color=colour, linewidth=width, label=label)[0]
        for label, colour, width in (
            ("axis features of the map", style.INK, 1),
            ("axis features of the perceived lines", style.BLUE, 1.8),
        )
    ]
    figure.legend(
        handles=handles, loc="upper left", ncols=2, frameon=False,
        bbox_to_anchor=((MARGIN - 10) / SIZE_PX[0], 1),
    )
    style.save(figure, path)
