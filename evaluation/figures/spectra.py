"""The paper's Fig. 3: amplitude spectra rotate with the map, and so do the yaw signatures."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from evaluation.figures import style

FILE = "solver_spectra.png"
SIZE_PX = (1860, 868)
MARGIN = 24
TOP = 44
MASK_WIDTH = 192
SPECTRUM = 384
GAP = 12
PLOT = (MARGIN + 30, TOP + SPECTRUM + 130, 1240, 250)
SCORE_GAP = 90
VIEW_COLOURS = (style.INK, style.BLUE, style.ORANGE)
BAND = "#962896"
OTHER_BANDS = "#78c8be"
# Amplitudes below this share of the largest are white, because they show no direction.
WHITE_SHARE = 0.33


class View(TypedDict):
    raster: list[list[list[int]]]
    log_amplitude: list[list[float]]
    signature: list[float]
    score: list[float]


class Spectra(TypedDict):
    """The data that evaluation/solver/spectra_figure.h describes."""

    turn_deg: float
    shift_m: float
    band: int
    band_edges_per_m: list[float]
    frequency_limit_per_m: float
    angles_deg: list[float]
    hypotheses_deg: list[float]
    views: list[View]


def _captions(data: Spectra) -> list[str]:
    turn, shift = f"{data['turn_deg']:g}°", f"{data['shift_m']:g} m"
    return [
        "(a) map",
        f"(b) rotated by {turn}",
        f"(c) rotated by {turn}, moved by {shift} along x and y",
    ]


def _draw_view(figure: Figure, left: float, caption: str, view: View, data: Spectra) -> None:
    style.add_text(figure, left, TOP - 12, caption, 12)
    mask = style.add_axes(figure, left, TOP, MASK_WIDTH, SPECTRUM)
    image = style.bev_image(np.array(view["raster"]) / 255)
    style.show_image(mask, image, interpolation="antialiased")
    mask.set_xlabel("60 m x 30 m", color=style.INK)

    amplitude = np.array(view["log_amplitude"])
    limit = data["frequency_limit_per_m"]
    axes = style.add_axes(figure, left + MASK_WIDTH + GAP, TOP, SPECTRUM, SPECTRUM)
    style.show_image(
        axes,
        amplitude,
        cmap="gray_r",
        vmin=WHITE_SHARE * amplitude.max(),
        vmax=amplitude.max(),
        extent=(-limit, limit, -limit, limit),
        interpolation="nearest",
    )
    for edge, frequency in enumerate(data["band_edges_per_m"]):
        shown = edge in (data["band"], data["band"] + 1)
        axes.add_patch(
            Circle(
                (0, 0), frequency, fill=False,
                color=BAND if shown else OTHER_BANDS, linewidth=1.8 if shown else 0.9,
            )
        )
    label = f"\N{MINUS SIGN}{limit:.2f} to {limit:.2f} cycles/m, forward up"
    axes.set_xlabel(label, color=style.INK)


def _draw_signatures(figure: Figure, data: Spectra) -> None:
    left, top, width, height = PLOT
    axes = style.add_axes(figure, left, top, width, height)
    for caption, view, colour in zip(_captions(data), data["views"], VIEW_COLOURS):
        axes.plot(data["angles_deg"], view["signature"], color=colour, linewidth=1.8, label=caption)
    axes.set_xlim(0, 180)
    axes.set_ylim(-2, 5)
    axes.set_xticks(range(0, 181, 10))
    axes.set_xlabel(
        "direction of the frequency, degrees counter-clockwise from forward", color=style.INK
    )
    axes.grid(color=style.GRID)
    axes.legend(
        loc="lower left", bbox_to_anchor=(-0.01, 1), ncols=3, frameon=False, borderaxespad=0.1
    )
    style.add_text(
        figure, left, top - 38, "yaw signature of the purple band (standardised amplitude)", 12
    )


def _draw_scores(figure: Figure, data: Spectra) -> None:
    left = PLOT[0] + PLOT[2] + SCORE_GAP
    axes = style.add_axes(figure, left, PLOT[1], SIZE_PX[0] - MARGIN - left, PLOT[3])
    for view, colour in zip(data["views"], VIEW_COLOURS):
        axes.plot(data["hypotheses_deg"], view["score"], color=colour, linewidth=1.8)
    axes.set_xlim(data["hypotheses_deg"][0], data["hypotheses_deg"][-1])
    axes.set_ylim(-2, 0)
    axes.set_yticks(np.arange(-2, 0.1, 0.5))
    axes.set_xlabel("hypothesis, degrees", color=style.INK)
    axes.grid(color=style.GRID)
    axes.axvline(data["turn_deg"], color=style.INK, linewidth=1)
    style.add_text(figure, left - 40, PLOT[1] - 38, "score of the yaw hypotheses, all bands", 12)


def draw(data: Spectra, path: Path) -> None:
    """Draws three views of a map with their spectra; below, the signatures and the scores."""
    figure = style.new_figure(*SIZE_PX)
    left = MARGIN
    for caption, view in zip(_captions(data), data["views"]):
        _draw_view(figure, left, caption, view, data)
        left += MASK_WIDTH + GAP + SPECTRUM + MARGIN
    _draw_signatures(figure, data)
    _draw_scores(figure, data)
    style.save(figure, path)
