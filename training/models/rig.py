"""The cameras of the dense view transform, which needs the ground position of each image cell."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class Camera:
    """A pinhole camera of the network's images. (0, 0) is the centre of the top left pixel."""

    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    vehicle_from_camera: Tensor  # [4, 4]

    def ground_positions(
        self, image_size: tuple[int, int], grid: tuple[int, int]
    ) -> tuple[Tensor, Tensor]:
        """Where the centres of image cells see the ground z = 0: x and y in the vehicle frame (m)
        [*grid, 2], zero above the horizon, and whether they see the ground, bool [*grid]."""
        (rows, cols), (grid_rows, grid_cols) = image_size, grid
        v = (torch.arange(grid_rows, dtype=torch.float64) + 0.5) * (rows / grid_rows) - 0.5
        u = (torch.arange(grid_cols, dtype=torch.float64) + 0.5) * (cols / grid_cols) - 0.5
        y, x = torch.meshgrid(
            (v - self.cy_px) / self.fy_px, (u - self.cx_px) / self.fx_px, indexing="ij"
        )
        pose = self.vehicle_from_camera.double()
        ray = torch.stack((x, y, torch.ones_like(x)), dim=-1) @ pose[:3, :3].T
        sees = ray[..., 2] < 0
        depth = torch.where(sees, -pose[2, 3] / ray[..., 2], 0.0)
        ground = torch.where(sees[..., None], pose[:2, 3] + depth[..., None] * ray[..., :2], 0.0)
        return ground.float(), sees


@dataclass(frozen=True)
class _NuScenesCamera:
    focal_px: float
    cx_px: float
    cy_px: float
    translation_m: tuple[float, float, float]
    azimuth_deg: float


# The rig of nuScenes' scene-0061, taken as level. Order: front_left, front, front_right, back_left,
# back, back_right.
_NUSCENES = (
    _NuScenesCamera(1272.6, 826.6, 479.8, (1.524, 0.495, 1.509), 55.2),
    _NuScenesCamera(1266.4, 816.3, 491.5, (1.701, 0.016, 1.511), 0.3),
    _NuScenesCamera(1260.8, 808.0, 495.3, (1.551, -0.493, 1.496), -56.4),
    _NuScenesCamera(1256.7, 792.1, 492.8, (1.036, 0.485, 1.591), 108.6),
    _NuScenesCamera(809.2, 829.2, 481.8, (0.028, 0.003, 1.579), 179.9),
    _NuScenesCamera(1259.5, 807.3, 501.2, (1.015, -0.481, 1.562), -110.8),
)
_NUSCENES_ROWS, _NUSCENES_COLS = 900, 1600
_KEPT_ROWS = 0.75  # BeMapNet crops the upper quarter


def nominal_cameras(image_size: tuple[int, int]) -> list[Camera]:
    """The nuScenes rig with BeMapNet's preprocessing: scaled, upper quarter cropped."""
    rows, cols = image_size
    scaled_rows = rows / _KEPT_ROWS
    return [_scaled(camera, scaled_rows, scaled_rows - rows, cols) for camera in _NUSCENES]


def _scaled(camera: _NuScenesCamera, scaled_rows: float, cut_rows: float, cols: int) -> Camera:
    scale_x, scale_y = cols / _NUSCENES_COLS, scaled_rows / _NUSCENES_ROWS
    sin, cos = (f(math.radians(camera.azimuth_deg)) for f in (math.sin, math.cos))
    x, y, z = camera.translation_m
    # Columns: the camera's right, down and forward axes and its position, in the vehicle frame.
    pose = torch.tensor([[sin, 0, cos, x], [-cos, 0, sin, y], [0, -1, 0, z], [0, 0, 0, 1]])
    return Camera(
        fx_px=camera.focal_px * scale_x,
        fy_px=camera.focal_px * scale_y,
        cx_px=(camera.cx_px + 0.5) * scale_x - 0.5,
        cy_px=(camera.cy_px + 0.5) * scale_y - 0.5 - cut_rows,
        vehicle_from_camera=pose,
    )
