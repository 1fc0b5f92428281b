"""Reads the tables of a nuScenes tree (v1.0-*/*.json; schema_nuscenes.md of the nuScenes devkit).

It keeps only the key frames of the wanted scenes from the six cameras and LIDAR_TOP.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from training.nuscenes.errors import (
    MissingFileError,
    MissingFrameError,
    MissingSceneError,
    MissingTokenError,
    NuscenesError,
)
from training.nuscenes.json_records import Record, open_text, read_array

# In the order of kCameraNames (common/cameras.h).
CAMERA_CHANNELS = (
    *("CAM_FRONT_LEFT", "CAM_FRONT", "CAM_FRONT_RIGHT"),
    *("CAM_BACK_LEFT", "CAM_BACK", "CAM_BACK_RIGHT"),
)
REFERENCE_CHANNEL = "LIDAR_TOP"  # defines a sample's pose and time
_KEPT_CHANNELS = frozenset((*CAMERA_CHANNELS, REFERENCE_CHANNEL))


@dataclass(frozen=True, slots=True)
class Scene:
    name: str
    log_token: str


@dataclass(frozen=True, slots=True)
class Sample:
    scene_token: str


@dataclass(frozen=True, slots=True)
class Pose:
    """target_from_source of an ego_pose (map from vehicle) or of a sensor (vehicle from sensor)."""

    translation_m: tuple[float, ...]
    rotation_wxyz: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class CalibratedSensor:
    sensor_token: str
    vehicle_from_sensor: Pose
    camera_intrinsic: tuple[tuple[float, ...], ...] | None  # None: the sensor is not a camera


@dataclass(frozen=True, slots=True)
class Frame:
    """The record of one sensor for one sample (a key frame of sample_data)."""

    token: str
    filename: str
    width_px: int  # 0: not an image
    height_px: int
    ego_pose_token: str
    calibrated_sensor_token: str


@dataclass
class Tables:
    """The tables, each as a dictionary by token."""

    folder: Path
    scene: dict[str, Scene] = field(default_factory=dict)
    log: dict[str, str] = field(default_factory=dict)  # token -> location
    sample: dict[str, Sample] = field(default_factory=dict)
    sensor: dict[str, str] = field(default_factory=dict)  # token -> channel
    calibrated_sensor: dict[str, CalibratedSensor] = field(default_factory=dict)
    ego_pose: dict[str, Pose] = field(default_factory=dict)
    frames: dict[str, dict[str, Frame]] = field(default_factory=dict)  # by sample and channel
    defects: dict[str, NuscenesError] = field(default_factory=dict)  # errors by sample

    def find(self, table: str, token: str, named_by: str) -> Any:
        """The record of a table; MissingTokenError if there is none. `named_by`: the record that
        refers to it."""
        records = getattr(self, table)
        if token not in records:
            raise MissingTokenError(
                f"{self.folder / table}.json: found no token '{token}', wanted by {named_by}"
            )
        return records[token]

    def frame(self, sample_token: str, channel: str) -> Frame:
        """A frame of a sample; NuscenesError if it or a record of the sample is defective."""
        if error := self.defects.get(sample_token):
            raise error
        frames = self.frames.get(sample_token, {})
        if channel not in frames:
            raise MissingFrameError(
                f"{self.folder / 'sample_data'}.json: found no key frame of {channel} "
                f"for sample '{sample_token}'"
            )
        return frames[channel]

    def location(self, sample_token: str) -> str:
        """The name of the map on which a sample was recorded."""
        scene_token = self.sample[sample_token].scene_token
        scene = self.find("scene", scene_token, f"sample '{sample_token}'")
        return self.find("log", scene.log_token, f"scene '{scene.name}'")


def find_version(root: Path, version: str = "") -> Path:
    """The folder of the tables: the named v1.0-*, or the only one. MissingFileError if there is
    none or the choice is ambiguous."""
    found = sorted(path for path in root.glob("v1.0-*") if path.is_dir())
    wanted = [path for path in found if not version or path.name == version]
    if len(wanted) == 1:
        return wanted[0]
    names = ", ".join(path.name for path in found) or "nothing"
    raise MissingFileError(f"{root}: found {names}, wanted {version or 'one folder v1.0-*'}")


def read_scene_names(path: Path) -> list[str]:
    """Reads a split: one scene name per line; empty lines and comments after # are ignored."""
    with open_text(path) as file:
        names = [line.partition("#")[0].strip() for line in file]
    names = [name for name in names if name]
    if not names:
        raise MissingSceneError(f"{path}: found no scene name, wanted one per line")
    return names


def load_tables(folder: Path, scene_names: list[str] | None = None) -> Tables:
    """Reads the tables of the named scenes, or of all scenes."""
    tables = Tables(folder)
    known = _load_scenes(tables, scene_names)
    _load_samples(tables, known, keep_strays=scene_names is None)
    for row in read_array(folder / "log.json"):
        tables.log[row.text("token")] = row.text("location")
    for row in read_array(folder / "sensor.json"):
        tables.sensor[row.text("token")] = row.text("channel")
    for row in read_array(folder / "calibrated_sensor.json"):
        tables.calibrated_sensor[row.text("token")] = _calibrated_sensor(row)
    _load_frames(tables)
    _load_ego_poses(tables)
    return tables


def _load_scenes(tables: Tables, names: list[str] | None) -> set[str]:
    """Stores the wanted scenes and returns the tokens of all scenes."""
    path = tables.folder / "scene.json"
    every = {
        row.text("token"): Scene(row.text("name"), row.text("log_token"))
        for row in read_array(path)
    }
    wanted = {scene.name for scene in every.values()} if names is None else set(names)
    tables.scene = {token: scene for token, scene in every.items() if scene.name in wanted}
    missing = sorted(wanted - {scene.name for scene in tables.scene.values()})
    if missing:
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        raise MissingSceneError(f"{path}: found no scene named {', '.join(missing[:3])}{more}")
    return set(every)


def _load_samples(tables: Tables, known_scenes: set[str], keep_strays: bool) -> None:
    """Stores the samples of the wanted scenes, ordered by scene and time. A stray refers to an
    unknown scene; it may be kept, so that using it raises an error that names it."""
    samples = []
    for row in read_array(tables.folder / "sample.json"):
        scene_token = row.text("scene_token")
        is_stray = keep_strays and scene_token not in known_scenes
        if scene_token in tables.scene or is_stray:
            samples.append((scene_token, row.whole("timestamp"), row.text("token")))
    scene_rank = {token: rank for rank, token in enumerate(tables.scene)}
    samples.sort(key=lambda sample: (scene_rank.get(sample[0], len(scene_rank)), sample[1]))
    tables.sample = {token: Sample(scene) for scene, _, token in samples}


def _pose(row: Record) -> Pose:
    return Pose(row.numbers("translation", 3), row.unit_quaternion("rotation"))


def _calibrated_sensor(row: Record) -> CalibratedSensor:
    is_camera = row.values.get("camera_intrinsic") != []
    intrinsic = row.matrix3("camera_intrinsic") if is_camera else None
    return CalibratedSensor(row.text("sensor_token"), _pose(row), intrinsic)


def _load_frames(tables: Tables) -> None:
    for row in read_array(tables.folder / "sample_data.json"):
        sample_token = row.text("sample_token")
        if not row.flag("is_key_frame") or sample_token not in tables.sample:
            continue
        try:
            channel = _channel(tables, row)
        except MissingTokenError as error:
            tables.defects[sample_token] = error
            continue
        if channel in _KEPT_CHANNELS:
            tables.frames.setdefault(sample_token, {})[channel] = _frame(row, channel)


def _channel(tables: Tables, row: Record) -> str:
    token, named_by = row.text("calibrated_sensor_token"), f"sample_data '{row.text('token')}'"
    calibrated = tables.find("calibrated_sensor", token, named_by)
    return tables.find("sensor", calibrated.sensor_token, f"calibrated_sensor '{token}'")


def _frame(row: Record, channel: str) -> Frame:
    is_image = channel != REFERENCE_CHANNEL
    return Frame(
        token=row.text("token"),
        filename=row.text("filename"),
        width_px=row.whole("width") if is_image else 0,
        height_px=row.whole("height") if is_image else 0,
        ego_pose_token=row.text("ego_pose_token"),
        calibrated_sensor_token=row.text("calibrated_sensor_token"),
    )


def _load_ego_poses(tables: Tables) -> None:
    wanted = {
        frame.ego_pose_token for frames in tables.frames.values() for frame in frames.values()
    }
    for row in read_array(tables.folder / "ego_pose.json"):
        token = row.text("token")
        if token in wanted:
            tables.ego_pose[token] = _pose(row)
