"""What all figures share: sizes in pixels, colours, BEV images, and the PNG file."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray
from PIL import Image

INK = "#282828"
GRID = "#e1e1e1"
GREEN = "#32963c"
ORANGE = "#f07d0a"
BLUE = "#145fcd"
TRUTH = "#dc2828"
# Lane divider, pedestrian crossing, road boundary: the paper's colours.
CLASS_COLOURS = ((0, 80, 255), (0, 200, 0), (255, 0, 0))
SHADE = 200 / 255
DOTS_PER_INCH = 100
FILE_LEVELS = 16  # per colour channel: the file gets half as large


def new_figure(width_px: int, height_px: int) -> Figure:
    return Figure(
        figsize=(width_px / DOTS_PER_INCH, height_px / DOTS_PER_INCH), dpi=DOTS_PER_INCH
    )


def add_axes(figure: Figure, left: float, top: float, width: float, height: float) -> Axes:
    """Axes at a place in pixels, counted from the figure's top left corner."""
    width_px, height_px = figure.get_size_inches() * DOTS_PER_INCH
    axes = figure.add_axes(
        (left / width_px, 1 - (top + height) / height_px, width / width_px, height / height_px)
    )
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, labelsize=9)
    for spine in axes.spines.values():
        spine.set_color(INK)
    return axes


def add_text(figure: Figure, left: float, base: float, text: str, size: float = 11) -> None:
    """Text whose base line begins at a place in pixels, counted from the top left corner."""
    width_px, height_px = figure.get_size_inches() * DOTS_PER_INCH
    figure.text(left / width_px, 1 - base / height_px, text, color=INK, fontsize=size)


def show_image(axes: Axes, image: ArrayLike, **options: object) -> None:
    """Fills the axes with an image, without ticks."""
    axes.imshow(image, aspect="auto", **options)
    axes.set_xticks([])
    axes.set_yticks([])


def bev_image(planes: ArrayLike) -> NDArray[np.float64]:
    """[row, column, RGB] from planes [class, row, column] between 0 and 1; 0 is white."""
    masks = np.clip(np.asarray(planes, dtype=float), 0.0, 1.0)
    image = np.ones((*masks.shape[1:], 3))
    for mask, colour in zip(masks, CLASS_COLOURS):
        image += mask[..., np.newaxis] * (np.array(colour) / 255 - image)
    return image


def over_grey(image: NDArray[np.float64], raster: ArrayLike) -> NDArray[np.float64]:
    """The image over a raster [class, row, column], whose lines become grey."""
    lines = np.asarray(raster, dtype=float).max(axis=0)
    return image * (1 - (1 - SHADE) * lines)[..., np.newaxis]


def save(figure: Figure, path: Path) -> None:
    """Writes a PNG. Makes the folder if it is missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    png = io.BytesIO()
    figure.savefig(png, format="png")
    step = 255 // (FILE_LEVELS - 1)
    levels = [(value + step // 2) // step * step for value in range(256)]
    Image.open(png).convert("RGB").point(3 * levels).save(path, optimize=True)
