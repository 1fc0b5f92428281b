"""Writes a small data set in nuScenes' layout: two scenes of three samples on two maps.

The geometry is computed independently of the tested code, with quaternions only.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

VERSION = "v1.0-mini"
LOCATIONS = ("singapore-onenorth", "boston-seaport")
SAMPLES_PER_SCENE = 3
IMAGE_SIZE_PX = (320, 180)
BACKGROUND = 20
MAP_CENTRE = (400.0, 1100.0)

Vector = tuple[float, ...]


@dataclass(frozen=True)
class Camera:
    """A camera of nuScenes' cars (1600 x 900). time_us: exposure time relative to LIDAR_TOP."""

    focal_px: float
    cx_px: float
    cy_px: float
    translation_m: Vector
    azimuth_deg: float
    time_us: int

    @property
    def rotation_wxyz(self) -> Vector:
        forward = (0.5, -0.5, 0.5, -0.5)  # camera z is the vehicle's x, camera x its -y
        turned = multiply(about("z", math.radians(self.azimuth_deg)), about("y", 0.008))
        return multiply(turned, forward)

    @property
    def intrinsic(self) -> list[list[float]]:
        scale = IMAGE_SIZE_PX[0] / 1600
        f, cx, cy = (v * scale for v in (self.focal_px, self.cx_px, self.cy_px))
        return [[f, 0.0, cx], [0.0, f, cy], [0.0, 0.0, 1.0]]


CAMERAS = {
    "CAM_FRONT_LEFT": Camera(1272.6, 826.6, 479.8, (1.524, 0.495, 1.509), 55.2, -43_100),
    "CAM_FRONT": Camera(1266.4, 816.3, 491.5, (1.701, 0.016, 1.511), 0.3, -35_500),
    "CAM_FRONT_RIGHT": Camera(1260.8, 808.0, 495.3, (1.551, -0.493, 1.496), -56.4, -27_600),
    "CAM_BACK_LEFT": Camera(1256.7, 792.1, 492.8, (1.036, 0.485, 1.591), 108.6, -500),
    "CAM_BACK": Camera(809.2, 829.2, 481.8, (0.028, 0.003, 1.579), 179.9, -10_400),
    "CAM_BACK_RIGHT": Camera(1259.5, 807.3, 501.2, (1.015, -0.481, 1.562), -110.8, -20_100),
}


def multiply(a: Vector, b: Vector) -> Vector:
    """The Hamilton product; quaternions are (w, x, y, z)."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def about(axis: str, angle_rad: float) -> Vector:
    """The quaternion of a rotation about an axis."""
    return (math.cos(angle_rad / 2), *(math.sin(angle_rad / 2) * (axis == a) for a in "xyz"))


def conjugate(q: Vector) -> Vector:
    return (q[0], -q[1], -q[2], -q[3])


def turn(q: Vector, point: Vector) -> Vector:
    """The point rotated by a quaternion."""
    return multiply(multiply(q, (0.0, *point)), conjugate(q))[1:]


def ego_pose(scene: int, sample: int, offset_us: int) -> tuple[Vector, Vector]:
    """Translation and rotation on a circle of 100 m radius at 10 m/s. The vehicle is slightly
    tilted, like in real ego poses."""
    angle = 0.1 * (0.5 * sample + 1e-6 * offset_us)
    x, y = MAP_CENTRE
    place = (x - 20 + 100 * math.sin(angle), y + 100 * (1 - math.cos(angle)) + 2 * scene, 0.0)
    tilt = multiply(about("y", 0.010), about("x", -0.006))
    return place, multiply(about("z", angle), tilt)


def pixel_of(camera: Camera, pose: tuple[Vector, Vector], point_map: Vector) -> Vector | None:
    """(column, row) in the camera's image; None if the point is behind the camera."""
    for translation, rotation in (pose, (camera.translation_m, camera.rotation_wxyz)):
        offset = tuple(p - t for p, t in zip(point_map, translation))
        point_map = turn(conjugate(rotation), offset)
    x, y, z = point_map
    if z <= 0:
        return None
    (f, _, cx), (_, _, cy), _ = camera.intrinsic
    return f * x / z + cx, f * y / z + cy


def ground_point(scene: int, sample: int, x_m: float, y_m: float) -> Vector:
    """A ground point in the vehicle frame at the reference time, converted to the map frame."""
    place, rotation = ego_pose(scene, sample, 0)
    return tuple(p + t for p, t in zip(turn(rotation, (x_m, y_m, 0.0)), place))


def spot_image(pixels: list[Vector], size_px: tuple[int, int] = IMAGE_SIZE_PX) -> Image.Image:
    """A dark image with a blurred white spot at each pixel."""
    cols, rows = np.meshgrid(np.arange(size_px[0]), np.arange(size_px[1]))
    spot_px = 1.5 * size_px[0] / 320
    value = np.full(cols.shape, float(BACKGROUND))
    for col, row in pixels:
        distance_squared = (cols - col) ** 2 + (rows - row) ** 2
        value += (255 - BACKGROUND) * np.exp(-0.5 * distance_squared / spot_px**2)
    return Image.fromarray(value.clip(0, 255).astype(np.uint8)).convert("RGB")


class _Nodes:
    """Builds the geometric layers of a map: nodes, lines and polygons."""

    def __init__(self) -> None:
        self.layers: dict[str, list[dict]] = {"node": [], "line": [], "polygon": []}

    def _tokens(self, points: list[Vector]) -> list[str]:
        """Adds a node per point; returns their tokens."""
        first = len(self.layers["node"])
        tokens = [f"node-{first + i}" for i in range(len(points))]
        x0, y0 = MAP_CENTRE
        self.layers["node"] += [
            {"token": token, "x": x0 + x, "y": y0 + y} for token, (x, y) in zip(tokens, points)
        ]
        return tokens

    def line(self, points: list[Vector]) -> str:
        token = f"line-{len(self.layers['line'])}"
        self.layers["line"].append({"token": token, "node_tokens": self._tokens(points)})
        return token

    def polygon(self, points: list[Vector], holes: tuple[list[Vector], ...] = ()) -> str:
        token = f"polygon-{len(self.layers['polygon'])}"
        self.layers["polygon"].append(
            {
                "token": token,
                "exterior_node_tokens": self._tokens(points),
                "holes": [{"node_tokens": self._tokens(hole)} for hole in holes],
            }
        )
        return token


def box(x0: float, y0: float, x1: float, y1: float) -> list[Vector]:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def arc(radius_m: float, last_rad: float) -> list[Vector]:
    """An arc that starts at the origin towards the east and turns left."""
    angles = np.linspace(0, last_rad, 41)
    return [(radius_m * math.sin(a), radius_m * (1 - math.cos(a))) for a in angles]


def map_expansion() -> dict:
    """A map around MAP_CENTRE: a road of 120 x 16 m (two segments that meet at x = 0, with an
    island), a lane that extends beyond it, a curved and a straight divider, and a crossing."""
    nodes = _Nodes()
    layers = {**_areas(nodes), **_crossings(nodes), **_dividers(nodes)}
    others = ("road_block", "walkway", "stop_line", "carpark_area", "traffic_light")
    return {
        "version": "1.3",
        "canvas_edge": [1585.6, 2025.0],
        **nodes.layers,
        "drivable_area": [{"token": "area-0", "polygon_tokens": ["polygon-0", "polygon-1"]}],
        **layers,
        **{layer: [] for layer in (*others, "lane_connector")},
        "arcline_path_3": {},
        "connectivity": {},
    }


def _areas(nodes: _Nodes) -> dict[str, list[dict]]:
    segment: dict[str, Any] = {"is_intersection": False, "drivable_area_token": "area-0"}
    island = box(-22, -6.5, -18, -5.5)
    return {
        "road_segment": [
            {
                "token": "segment-0",
                "polygon_token": nodes.polygon(box(-60, -8, 0, 8), (island,)),
                **segment,
            },
            {"token": "segment-1", "polygon_token": nodes.polygon(box(0, -8, 60, 8)), **segment},
        ],
        "lane": [
            {
                "token": "lane-0",
                "polygon_token": nodes.polygon(box(5, 4, 25, 12)),
                "lane_type": "CAR",
                "from_edge_line_token": nodes.line([]),
                "to_edge_line_token": nodes.line([]),
                "left_lane_divider_segments": [],
                "right_lane_divider_segments": [],
            }
        ],
    }


def _crossings(nodes: _Nodes) -> dict[str, list[dict]]:
    return {
        "ped_crossing": [
            {
                "token": "crossing-0",
                "polygon_token": nodes.polygon(box(10, -8, 14, 8)),
                "road_segment_token": "segment-1",
            }
        ],
    }


def _dividers(nodes: _Nodes) -> dict[str, list[dict]]:
    return {
        "road_divider": [
            {
                "token": "divider-0",
                "line_token": nodes.line(arc(50, 0.6)),
                "road_segment_token": None,
            }
        ],
        "lane_divider": [
            {"token": f"lane-divider-{i}", "line_token": token, "lane_divider_segments": []}
            for i, token in enumerate((nodes.line([(-60, -4), (60, -4)]), nodes.line([])))
        ],
    }


def write_tree(root: Path, marks: tuple[tuple[float, float], ...] = ()) -> None:
    """Writes the data set. marks: ground points (x, y) in each sample's vehicle frame at its
    reference time. The images show them as white spots, as seen at the camera's exposure time."""
    tables: dict[str, list[dict]] = {
        name: []
        for name in ("scene", "sample", "sample_data", "calibrated_sensor", "ego_pose", "sensor")
    }
    tables["log"] = [
        {
            "token": f"log-{i}",
            "logfile": f"n015-{i}",
            "vehicle": "n015",
            "date_captured": "2018-07-24",
            "location": location,
        }
        for i, location in enumerate(LOCATIONS)
    ]
    tables["map"] = [
        {
            "category": "semantic_prior",
            "token": "map-0",
            "filename": "maps/mask.png",
            "log_tokens": ["log-0", "log-1"],
        }
    ]
    _add_sensors(tables)
    for scene in range(len(LOCATIONS)):
        _add_scene(tables, scene)
        for sample in range(SAMPLES_PER_SCENE):
            _add_sample(tables, root, scene, sample, marks)
    for name, rows in tables.items():
        _write_json(root / VERSION / f"{name}.json", rows)
    for location in LOCATIONS:
        _write_json(root / "maps" / "expansion" / f"{location}.json", map_expansion())


def edit_json(path: Path, change: Callable) -> None:
    """Applies `change` to the content of a JSON file."""
    content = json.loads(path.read_text())
    change(content)
    _write_json(path, content)


def edit_table(root: Path, table: str, change: Callable[[dict], None], token: str) -> None:
    """Applies `change` to the row with the given token."""

    def change_row(rows: list[dict]) -> None:
        change(next(row for row in rows if row["token"] == token))

    edit_json(root / VERSION / f"{table}.json", change_row)


def _write_json(path: Path, content: list | dict) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=0))


def _add_sensors(tables: dict[str, list[dict]]) -> None:
    channels = {name: "camera" for name in CAMERAS}
    channels |= {"LIDAR_TOP": "lidar", "RADAR_FRONT": "radar"}
    for channel, modality in channels.items():
        tables["sensor"].append(
            {"token": f"sensor-{channel}", "channel": channel, "modality": modality}
        )
        camera = CAMERAS.get(channel)
        tables["calibrated_sensor"].append(
            {
                "token": f"calibrated-{channel}",
                "sensor_token": f"sensor-{channel}",
                "translation": camera.translation_m if camera else [0.94, 0.0, 1.84],
                "rotation": camera.rotation_wxyz if camera else [1.0, 0.0, 0.0, 0.0],
                "camera_intrinsic": camera.intrinsic if camera else [],
            }
        )


def _add_scene(tables: dict[str, list[dict]], scene: int) -> None:
    tables["scene"].append(
        {
            "token": f"scene-token-{scene}",
            "log_token": f"log-{scene}",
            "nbr_samples": SAMPLES_PER_SCENE,
            "first_sample_token": f"sample-{scene}-0",
            "last_sample_token": f"sample-{scene}-{SAMPLES_PER_SCENE - 1}",
            "name": f"scene-000{scene + 1}",
            "description": "Turning left",
        }
    )


def _add_sample(tables: dict, root: Path, scene: int, sample: int, marks: tuple) -> None:
    name = f"{scene}-{sample}"
    time_us = 1_532_402_927_647_951 + 500_000 * sample + 60_000_000 * scene
    tables["sample"].append(
        {
            "token": f"sample-{name}",
            "timestamp": time_us,
            "prev": f"sample-{scene}-{sample - 1}" if sample > 0 else "",
            "next": f"sample-{scene}-{sample + 1}" if sample + 1 < SAMPLES_PER_SCENE else "",
            "scene_token": f"scene-token-{scene}",
        }
    )
    points = [ground_point(scene, sample, x, y) for x, y in marks]
    for channel, camera in CAMERAS.items():
        filename = f"samples/{channel}/n015__{channel}__{name}.jpg"
        _add_data(tables, name, channel, filename, time_us, camera.time_us, scene, sample)
        pose = ego_pose(scene, sample, camera.time_us)
        pixels = [pixel for p in points if (pixel := pixel_of(camera, pose, p)) is not None]
        path = root / filename
        path.parent.mkdir(parents=True, exist_ok=True)
        spot_image(pixels).save(path, quality=95)
    for channel, extension in (("LIDAR_TOP", "pcd.bin"), ("RADAR_FRONT", "pcd")):
        filename = f"samples/{channel}/n015__{channel}__{name}.{extension}"
        _add_data(tables, name, channel, filename, time_us, 0, scene, sample)
    # A sweep between key frames is in the tables but belongs to no sample.
    sweep = f"sweeps/CAM_FRONT/n015__CAM_FRONT__{name}.jpg"
    _add_data(tables, name, "CAM_FRONT", sweep, time_us, -120_000, scene, sample, key_frame=False)


def _add_data(
    tables: dict,
    name: str,
    channel: str,
    filename: str,
    time_us: int,
    offset_us: int,
    scene: int,
    sample: int,
    key_frame: bool = True,
) -> None:
    token = f"data-{channel}-{name}" + ("" if key_frame else "-sweep")
    is_image = channel in CAMERAS
    place, rotation = ego_pose(scene, sample, offset_us)
    tables["sample_data"].append(
        {
            "token": token,
            "sample_token": f"sample-{name}",
            "ego_pose_token": f"pose-{token}",
            "calibrated_sensor_token": f"calibrated-{channel}",
            "timestamp": time_us + offset_us,
            "fileformat": "jpg" if is_image else "pcd",
            "is_key_frame": key_frame,
            "height": IMAGE_SIZE_PX[1] if is_image else 0,
            "width": IMAGE_SIZE_PX[0] if is_image else 0,
            "filename": filename,
            "prev": "",
            "next": "",
        }
    )
    tables["ego_pose"].append(
        {
            "token": f"pose-{token}",
            "timestamp": time_us + offset_us,
            "rotation": rotation,
            "translation": place,
        }
    )
