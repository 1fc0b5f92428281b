"""Where the time of a frame goes: a bar for each stage that `bevloc bench` measures."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypedDict, cast

from matplotlib.lines import Line2D

from evaluation.figures import style
from evaluation.figures.source import SourceError

FILE = "frame_stages.png"
WIDTH_PX = 1000
ROW = 34
NAMES = 190
TOP = 76
BOTTOM = 60
RIGHT = 30
BAR_HEIGHT = 0.6  # of a row
ROOM_FOR_NUMBERS = 1.12  # the axis ends at this multiple of the longest time


class Stage(TypedDict):
    name: str
    in_frame: bool
    p50_ms: float
    p99_ms: float
    ideal_ms: float


class WholeFrame(TypedDict):
    p50_ms: float
    p99_ms: float
    sum_of_ideals_ms: float


class Bench(TypedDict):
    """The part of the output of `bevloc bench --json` that the figure shows."""

    model: str
    instruction_set: str
    threads: int
    stages: list[Stage]
    frame: WholeFrame


def data_of(document: Any, file: Path) -> Bench:
    """The data of the file with this JSON. SourceError if it lacks what the figure shows."""
    wanted = "wanted the output of `bevloc bench --json`"
    if not isinstance(document, dict) or "stages" not in document:
        raise SourceError(f"{file}: found no stages, {wanted}")
    if "frame" not in document:
        raise SourceError(f"{file}: found no whole frame, {wanted} without --stage")
    if document["frame"]["sum_of_ideals_ms"] is None:
        raise SourceError(f"{file}: found no ideal times, {wanted} without --no-peak")
    return cast(Bench, document)


def rows(data: Bench) -> list[Stage]:
    """The stages of the frame, and the frame itself."""
    frame = data["frame"]
    whole = Stage(
        name="whole frame", in_frame=True, p50_ms=frame["p50_ms"], p99_ms=frame["p99_ms"],
        ideal_ms=frame["sum_of_ideals_ms"],
    )
    return [*(stage for stage in data["stages"] if stage["in_frame"]), whole]


def height_px(bars: int) -> int:
    return TOP + bars * ROW + BOTTOM


def draw(data: Bench, path: Path) -> None:
    """Draws each median as a bar with its number, with a line to the 99th percentile and a mark at
    the ideal time."""
    bars = rows(data)
    height = height_px(len(bars))
    figure = style.new_figure(WIDTH_PX, height)
    axes = style.add_axes(figure, NAMES, TOP, WIDTH_PX - NAMES - RIGHT, len(bars) * ROW)
    longest_ms = max(max(bar["p99_ms"], bar["ideal_ms"]) for bar in bars)
    for row, bar in enumerate(bars):
        colour = style.GREEN if bar["name"] == "whole frame" else style.BLUE
        axes.barh(row, bar["p50_ms"], BAR_HEIGHT, color=colour)
        axes.hlines(row, bar["p50_ms"], bar["p99_ms"], color=style.INK, linewidth=2)
        if bar["ideal_ms"] > 0:
            axes.vlines(bar["ideal_ms"], row - 0.4, row + 0.4, color=style.ORANGE, linewidth=3)
        end_ms = max(bar["p50_ms"], bar["p99_ms"])
        axes.annotate(
            f"{bar['p50_ms']:.3f}", (end_ms, row), (5, 0), textcoords="offset points",
            va="center", fontsize=9, color=style.INK,
        )
    axes.set_yticks(range(len(bars)), [bar["name"] for bar in bars], fontsize=11)
    axes.set_ylim(len(bars) - 0.5, -0.5)
    axes.set_xlim(0, ROOM_FOR_NUMBERS * longest_ms)
    axes.set_xlabel("ms", color=style.INK)
    axes.grid(axis="x", color=style.GRID)
    axes.tick_params(axis="y", length=0)
    subject = f"{data['model']}, {data['instruction_set']}, threads: {data['threads']}"
    style.add_text(figure, 12, 28, subject, 12)
    looks = (
        ("median, with its number", style.BLUE),
        ("to the 99th percentile", style.INK),
        ("ideal", style.ORANGE),
    )
    figure.legend(
        handles=[Line2D([], [], color=colour, linewidth=3, label=label) for label, colour in looks],
        loc="upper left", ncols=3, frameon=False, bbox_to_anchor=(0, 1 - 34 / height),
    )
    style.save(figure, path)
