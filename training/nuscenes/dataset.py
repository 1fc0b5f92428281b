"""Turns nuScenes key frames into training samples (Batch of training/data.py), in NumPy.

The vehicle frame of a sample is nuScenes' ego frame at the time of its LIDAR_TOP key frame. The
cameras fire up to 45 ms earlier; each camera's own ego pose gives the vehicle's pose at that time.
"""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from training.nuscenes import raster
from training.nuscenes.camera import HEIGHT_PX, WIDTH_PX, Pinhole, look_through, network_camera
from training.nuscenes.errors import CalibrationError, NuscenesError
from training.nuscenes.geometry import Se2, inverse_se3, planar, se3
from training.nuscenes.map_expansion import MapExpansion, map_path
from training.nuscenes.tables import (
    CAMERA_CHANNELS,
    REFERENCE_CHANNEL,
    CalibratedSensor,
    Frame,
    Pose,
    find_version,
    load_tables,
    read_scene_names,
)
from training.nuscenes.view_table import view_table

ALL_CAMERAS = (1 << len(CAMERA_CHANNELS)) - 1
# Largest correction in either direction: x m, y m, yaw rad (paper, section IV-A).
MAX_DEVIATION = np.array([2.0, 1.0, math.radians(2.0)])


@dataclass(frozen=True)
class NuscenesSample:
    """One sample. Fields, shapes and units are those of Batch, without the batch dimension."""

    images: np.ndarray
    camera_mask: np.ndarray
    raster_prior: np.ndarray
    raster_truth: np.ndarray
    correction: np.ndarray
    index: np.ndarray
    weight: np.ndarray


@dataclass(frozen=True)
class View:
    """One camera of one sample, at the pose where it was when it took its image."""

    path: Path  # image file
    real: Pinhole
    network: Pinhole
    vehicle_from_camera: np.ndarray  # [4, 4]; the vehicle frame at the sample's reference time


class NuscenesDataset:
    """The key frames of a nuScenes tree. Several threads may read it at the same time."""

    def __init__(
        self,
        root: Path,
        scenes: Path | None = None,
        version: str = "",
        line_width_cells: float = raster.DEFAULT_LINE_WIDTH_CELLS,
    ) -> None:
        """scenes: file with scene names, None: all. version: v1.0-*, needed if there are several.
        Unreadable tables and an impossible line width raise NuscenesError here; a defect of a
        sample raises it when that sample is read."""
        if not 0 < line_width_cells <= raster.WIDEST_LINE_CELLS:
            wanted = f"more than 0 and at most {raster.WIDEST_LINE_CELLS} cells"
            raise NuscenesError(f"line width: found {line_width_cells}, wanted {wanted}")
        names = read_scene_names(scenes) if scenes else None
        self._root = root
        self._line_width_cells = line_width_cells
        self._tables = load_tables(find_version(root, version), names)
        self._maps: dict[str, MapExpansion | NuscenesError] = {}
        self._maps_mutex = threading.Lock()
        self.sample_tokens = list(self._tables.sample)

    def __len__(self) -> int:
        return len(self.sample_tokens)

    def sample(
        self, position: int, deviation: np.ndarray, camera_mask: int = ALL_CAMERAS
    ) -> NuscenesSample:
        """One sample. deviation: the correction dT (x m, y m, yaw rad) from the prior to the truth.
        Cameras outside the mask have black images and are not in the view table. NuscenesError if
        the sample cannot be used."""
        token = self.sample_tokens[position]
        map_from_vehicle = self.map_from_vehicle(token)
        views = self.views(token)
        map_from_prior = map_from_vehicle @ Se2(*map(float, deviation)).inverse()
        raster_prior, raster_truth = (
            raster.draw(self.map_segments(token, pose), self._line_width_cells)
            for pose in (map_from_prior, map_from_vehicle)
        )
        images = np.zeros((len(views), 3, HEIGHT_PX, WIDTH_PX), np.uint8)
        for camera, view in enumerate(views):
            if camera_mask >> camera & 1:
                images[camera] = look_through(view.path, view.real, view.network)
        index, weight = view_table(
            [view.network for view in views],
            [inverse_se3(view.vehicle_from_camera) for view in views],
            camera_mask,
        )
        return NuscenesSample(
            images=images,
            camera_mask=np.array(camera_mask, np.uint8),
            raster_prior=raster_prior,
            raster_truth=raster_truth,
            correction=np.asarray(deviation, np.float32),
            index=index,
            weight=weight,
        )

    def map_from_vehicle(self, sample_token: str) -> Se2:
        """The true pose of the vehicle at the reference time."""
        return planar(self._map_from_vehicle(self._tables.frame(sample_token, REFERENCE_CHANNEL)))

    def map_segments(self, sample_token: str, map_from_vehicle: Se2) -> list[np.ndarray]:
        """The map's segments around a pose, in the frame of that pose (MapExpansion.segments)."""
        return self._map(self._tables.location(sample_token)).segments(map_from_vehicle)

    def views(self, sample_token: str) -> list[View]:
        """The six cameras in the order of CAMERA_CHANNELS."""
        reference = self._tables.frame(sample_token, REFERENCE_CHANNEL)
        vehicle_from_map = inverse_se3(self._map_from_vehicle(reference))
        frames = [self._tables.frame(sample_token, channel) for channel in CAMERA_CHANNELS]
        return [self._view(frame, vehicle_from_map) for frame in frames]

    def _view(self, frame: Frame, vehicle_from_map: np.ndarray) -> View:
        """One camera. The network camera follows from the calibration alone, as on the appliance;
        the pose includes the vehicle's motion since the exposure."""
        token = frame.calibrated_sensor_token
        sensor = self._tables.find("calibrated_sensor", token, f"sample_data '{frame.token}'")
        vehicle_from_sensor = _se3(sensor.vehicle_from_sensor)
        try:
            real = _pinhole(frame, sensor)
            network = network_camera(real, vehicle_from_sensor)
        except CalibrationError as error:
            raise CalibrationError(f"calibrated_sensor '{token}': {error}") from None
        motion = vehicle_from_map @ self._map_from_vehicle(frame)
        return View(self._root / frame.filename, real, network, motion @ vehicle_from_sensor)

    def _map_from_vehicle(self, frame: Frame) -> np.ndarray:
        named_by = f"sample_data '{frame.token}'"
        return _se3(self._tables.find("ego_pose", frame.ego_pose_token, named_by))

    def _map(self, location: str) -> MapExpansion:
        """The map of a location. It is read on first use; an unreadable map is not tried again."""
        with self._maps_mutex:
            if location not in self._maps:
                try:
                    self._maps[location] = MapExpansion(map_path(self._root, location))
                except NuscenesError as error:
                    self._maps[location] = error
            found = self._maps[location]
        if isinstance(found, NuscenesError):
            raise found
        return found


def _se3(pose: Pose) -> np.ndarray:
    return se3(pose.rotation_wxyz, pose.translation_m)


def _pinhole(frame: Frame, sensor: CalibratedSensor) -> Pinhole:
    if sensor.camera_intrinsic is None:
        raise CalibrationError("found no camera_intrinsic, wanted the intrinsics of a camera")
    if frame.width_px <= 0 or frame.height_px <= 0:
        found = f"{frame.width_px}x{frame.height_px}"
        raise CalibrationError(f"found an image of {found} pixels, wanted a positive size")
    (fx_px, _, cx_px), (_, fy_px, cy_px), _ = sensor.camera_intrinsic
    return Pinhole(frame.width_px, frame.height_px, fx_px, fy_px, cx_px, cy_px)
