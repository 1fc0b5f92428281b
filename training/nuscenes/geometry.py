"""Rigid motions in the plane and in space, named target_from_source."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Se2:
    """Motion in the plane: p_target = R(yaw) * p_source + (x, y)."""

    x_m: float
    y_m: float
    yaw_rad: float

    def __matmul__(self, other: Se2) -> Se2:
        x, y = self.apply(np.array([other.x_m, other.y_m]))
        return Se2(float(x), float(y), self.yaw_rad + other.yaw_rad)

    def inverse(self) -> Se2:
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Se2(-c * self.x_m - s * self.y_m, s * self.x_m - c * self.y_m, -self.yaw_rad)

    def apply(self, points: np.ndarray) -> np.ndarray:
        """points [..., 2] in the source frame -> [..., 2] in the target frame."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return points @ np.array([[c, s], [-s, c]]) + (self.x_m, self.y_m)


def se3(rotation_wxyz: tuple[float, ...], translation_m: tuple[float, ...]) -> np.ndarray:
    """The 4 x 4 matrix of a unit quaternion and a translation."""
    w, x, y, z = rotation_wxyz
    motion = np.eye(4)
    motion[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    motion[:3, 3] = translation_m
    return motion


def inverse_se3(motion: np.ndarray) -> np.ndarray:
    inverse = np.eye(4)
    inverse[:3, :3] = motion[:3, :3].T
    inverse[:3, 3] = -motion[:3, :3].T @ motion[:3, 3]
    return inverse


def planar(motion: np.ndarray) -> Se2:
    """The position and heading of a motion in space."""
    yaw_rad = math.atan2(motion[1, 0], motion[0, 0])
    return Se2(float(motion[0, 3]), float(motion[1, 3]), yaw_rad)
