"""Draws line segments into the network's raster, like pipeline/map/rasterizer.h: anti-aliased with
round ends, from 0 (empty) to 255 (covered)."""

from __future__ import annotations

import math

import numpy as np

ROWS, COLS, CELL_M = 400, 200, 0.15
X_RANGE_M, Y_RANGE_M = 0.5 * ROWS * CELL_M, 0.5 * COLS * CELL_M
DEFAULT_LINE_WIDTH_CELLS = 5  # kRasterLineWidthCells, the appliance's line width (HDMapNet)
WIDEST_LINE_CELLS = 16
# Segments are clipped at this distance outside the raster, where their clipped ends are not drawn.
MARGIN_M = (0.5 * WIDEST_LINE_CELLS + 1.5) * CELL_M
_LONGEST_PIECE_CELLS = 8.0


def draw(layers: list[np.ndarray], line_width_cells: float) -> np.ndarray:
    """Segments [n, 2 ends, 2] (x, y) of each class, metres in the vehicle frame
    -> uint8 [classes, 400, 200]; row 0 is the far front, column 0 the far left."""
    assert 0 < line_width_cells <= WIDEST_LINE_CELLS
    return np.stack([_draw_class(segments, line_width_cells) for segments in layers])


def _draw_class(segments: np.ndarray, line_width_cells: float) -> np.ndarray:
    outer_radius = 0.5 * line_width_cells + 0.5
    pieces = _pieces(_cells_of(segments))
    # Each piece is drawn into a window of cells; all windows have the same size.
    size = math.ceil(_LONGEST_PIECE_CELLS + 2 * outer_radius) + 1
    corner = np.floor(pieces.min(1) - outer_radius).astype(np.int32)
    window = np.stack(np.meshgrid(np.arange(size), np.arange(size), indexing="ij"), axis=-1)
    cells = corner[:, None] + window.reshape(1, -1, 2).astype(np.int32)
    distance = _distance(cells, pieces)
    inside = ((cells >= 0) & (cells < (ROWS, COLS))).all(-1)
    touched = inside & (distance < outer_radius)
    cover = np.clip(outer_radius - distance[touched], 0.0, 1.0)
    row, col = cells[touched].T
    raster = np.zeros(ROWS * COLS, np.uint8)
    np.maximum.at(raster, row * COLS + col, (cover * 255 + 0.5).astype(np.uint8))
    return raster.reshape(ROWS, COLS)


def _cells_of(points: np.ndarray) -> np.ndarray:
    """(x, y) in metres -> fractional (row, column). Integers are cell centres."""
    return (np.array([X_RANGE_M, Y_RANGE_M]) - points) / CELL_M - 0.5


def _pieces(segments: np.ndarray) -> np.ndarray:
    """The segments, divided into pieces of at most _LONGEST_PIECE_CELLS."""
    length = np.hypot(*(segments[:, 1] - segments[:, 0]).T)
    count = np.ceil(length / _LONGEST_PIECE_CELLS).clip(min=1).astype(int)
    first = np.repeat(np.cumsum(count) - count, count)
    step = np.arange(count.sum()) - first
    start, end = (np.repeat(segments[:, i], count, axis=0) for i in range(2))
    total = np.repeat(count, count)[:, None]
    at = step[:, None] + np.array([0.0, 1.0])  # [n, 2 ends]
    return start[:, None] + (at / total)[..., None] * (end - start)[:, None]


def _distance(cells: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """The distance of each of the cells [n, k, 2] to its piece [n, 2, 2]."""
    pieces = pieces.astype(np.float32)
    start, along = pieces[:, 0], pieces[:, 1] - pieces[:, 0]
    off_row, off_col = np.moveaxis(cells - start[:, None], -1, 0)
    d_row, d_col = along[:, :1], along[:, 1:]
    length_squared = np.maximum(d_row**2 + d_col**2, 1e-12)
    part = np.clip((off_row * d_row + off_col * d_col) / length_squared, 0.0, 1.0)
    return np.hypot(off_row - part * d_row, off_col - part * d_col)
