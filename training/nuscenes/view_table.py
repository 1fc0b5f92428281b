"""The view table of any six network cameras: pipeline/network/view/view_table.h in NumPy.

The native library computes the table only for the simulated rig. Every nuScenes sample has its own
calibration, and the vehicle moves between the exposures of its cameras.
"""

from __future__ import annotations

import numpy as np

from training.nuscenes.camera import Pinhole

BEV_ROWS, BEV_COLS, BEV_CELL_M = 100, 50, 0.6
FEATURE_STRIDE, FEATURE_ROWS, FEATURE_COLS = 8, 12, 40
_CAMERAS_PER_CELL, _NEIGHBOURS = 2, 4
VIEW_SLOTS = _CAMERAS_PER_CELL * _NEIGHBOURS


def cell_centres() -> np.ndarray:
    """(x, y) of each BEV cell, row-major [5000, 2]."""
    x = 0.5 * BEV_ROWS * BEV_CELL_M - (np.arange(BEV_ROWS) + 0.5) * BEV_CELL_M
    y = 0.5 * BEV_COLS * BEV_CELL_M - (np.arange(BEV_COLS) + 0.5) * BEV_CELL_M
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def view_table(
    cameras: list[Pinhole], camera_from_vehicle: list[np.ndarray], camera_mask: int
) -> tuple[np.ndarray, np.ndarray]:
    """index int64 [8, 5000] and weight float32 [8, 5000] for the cameras in the mask (bit i:
    camera i)."""
    sightings = [
        _sight(camera, motion, is_there=bool(camera_mask >> i & 1))
        for i, (camera, motion) in enumerate(zip(cameras, camera_from_vehicle))
    ]
    pixel = np.stack([pixel for pixel, _ in sightings])  # [6, 5000, 2]
    border_distance = np.stack([distance for _, distance in sightings])  # [6, 5000]
    best_first = np.argsort(-border_distance, axis=0, kind="stable")[:3]
    shares = _shares(np.take_along_axis(border_distance, best_first, axis=0))
    cells = np.arange(pixel.shape[1])
    slots = [
        _neighbours(camera, pixel[camera, cells], share)
        for camera, share in zip(best_first[:_CAMERAS_PER_CELL], shares)
    ]
    index, weight = (np.concatenate(parts) for parts in zip(*slots))
    return index, weight


def _sight(
    camera: Pinhole, camera_from_vehicle: np.ndarray, is_there: bool
) -> tuple[np.ndarray, np.ndarray]:
    """The pixel at which a camera sees each cell [5000, 2] (column, row), and its distance from the
    image border [5000]; 0 if the camera does not see the cell."""
    ground = cell_centres()
    rotation, translation = camera_from_vehicle[:3, :3], camera_from_vehicle[:3, 3]
    x, y, z = (ground @ rotation[:, :2].T + translation).T
    visible = (z > 0) & is_there
    z = np.where(visible, z, 1.0)
    col = np.where(visible, camera.fx_px * x / z + camera.cx_px, 0.0)
    row = np.where(visible, camera.fy_px * y / z + camera.cy_px, 0.0)
    u, v = col + 0.5, row + 0.5
    distance = np.minimum.reduce((u, camera.width_px - u, v, camera.height_px - v))
    return np.stack((col, row), axis=1), np.where(visible, distance, 0.0).clip(min=0.0)


def _shares(distance: np.ndarray) -> np.ndarray:
    """Border distances [3, n] of the three best cameras -> shares of the two best [2, n]. The third
    distance is subtracted from both, so that a camera's share is zero where it becomes or ceases to
    be the second best."""
    first, second = distance[0] - distance[2], distance[1] - distance[2]
    total = np.where(first > 0, first + second, 1.0)
    alone = (distance[0] > 0).astype(float)
    return np.stack((np.where(first > 0, first / total, alone), second / total))


def _neighbours(
    camera: np.ndarray, pixel: np.ndarray, share: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The four bilinear neighbours of each cell's pixel: index and weight [4, n]."""
    col, row = (pixel.T + 0.5) / FEATURE_STRIDE - 0.5
    index, weight = [], []
    for n in range(_NEIGHBOURS):
        r, c = np.floor(row) + n // 2, np.floor(col) + n % 2
        bilinear = (1 - np.abs(row - r)) * (1 - np.abs(col - c))
        inside_row = np.clip(r, 0, FEATURE_ROWS - 1).astype(np.int64)
        inside_col = np.clip(c, 0, FEATURE_COLS - 1).astype(np.int64)
        key = (camera * FEATURE_ROWS + inside_row) * FEATURE_COLS + inside_col
        index.append(np.where(share > 0, key, 0))
        weight.append(np.where(share > 0, share * bilinear, 0.0).astype(np.float32))
    return np.stack(index), np.stack(weight)
