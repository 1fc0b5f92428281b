"""Converts a nuScenes map (maps/expansion/*.json, versions 1.1 to 1.3) to the classes of bevloc.

The conversion follows HDMapNet and BeMapNet. Dividers are road_divider and lane_divider. A crossing
is the two longest edges of its polygon. The boundary is the outline of the union of all
road_segment and lane polygons.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from training.nuscenes.errors import MissingTokenError
from training.nuscenes.geometry import Se2
from training.nuscenes.json_records import Record, read_object
from training.nuscenes.raster import MARGIN_M, X_RANGE_M, Y_RANGE_M
from training.nuscenes.road_contour import RoadContour, ring_edges

_DIVIDER_LAYERS = ("road_divider", "lane_divider")
_ROAD_LAYERS = ("road_segment", "lane")


def map_path(root: Path, location: str) -> Path:
    return root / "maps" / "expansion" / f"{location}.json"


class MapExpansion:
    """The lines of one map in the frame of the ego poses (metres, x east). NuscenesError if the map
    is missing or invalid."""

    def __init__(self, path: Path) -> None:
        reader = _MapReader(read_object(path))
        self._dividers = _joined(reader.lines(_DIVIDER_LAYERS))
        self._crossings = _joined(_long_edges(edges) for edges in reader.crossings())
        self._contour = RoadContour(reader.polygons(_ROAD_LAYERS))

    def segments(self, map_from_vehicle: Se2) -> list[np.ndarray]:
        """Divider, crossing and boundary segments [n, 2 ends, 2] (x, y) in the vehicle frame,
        clipped to x in [-30, 30] m and y in [-15, 15] m plus a margin of MARGIN_M."""
        half = np.array([X_RANGE_M, Y_RANGE_M]) + MARGIN_M
        corners = map_from_vehicle.apply(half * [[1, 1], [1, -1], [-1, 1], [-1, -1]])
        low, high = corners.min(0), corners.max(0)
        vehicle_from_map = map_from_vehicle.inverse()
        layers = (self._dividers, self._crossings, self._contour.segments(low, high))
        near = [layer[_meets(layer, low, high)] for layer in layers]
        return [clip(vehicle_from_map.apply(layer), half) for layer in near]


def clip(segments: np.ndarray, half: np.ndarray) -> np.ndarray:
    """The parts of segments [n, 2, 2] within the box +-half (Liang and Barsky)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    flat = along == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        at_low, at_high = (-half - start) / along, (half - start) / along
    outside = (flat & (np.abs(start) > half)).any(1)
    enter = np.where(flat, 0.0, np.minimum(at_low, at_high)).max(1).clip(min=0.0)
    leave = np.where(flat, 1.0, np.maximum(at_low, at_high)).min(1).clip(max=1.0)
    ends = start[:, None] + np.stack((enter, leave), axis=1)[..., None] * along[:, None]
    return ends[~outside & (enter <= leave)]


def _meets(segments: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Which segments have a bounding box that overlaps a box."""
    return ((segments.min(1) <= high) & (segments.max(1) >= low)).all(1)


def _joined(parts: Iterable[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.empty((0, 2, 2)), *parts])


def _long_edges(edges: np.ndarray) -> np.ndarray:
    """The two longest edges; of equally long ones the first."""
    length_squared = ((edges[:, 1] - edges[:, 0]) ** 2).sum(1)
    return edges[np.argsort(-length_squared, kind="stable")[:2]]


class _MapReader:
    """Resolves the tokens of a map. A token that does not exist raises MissingTokenError: without
    the element's position the whole map is unusable."""

    def __init__(self, document: Record) -> None:
        self._document = document
        self._nodes = {
            row.text("token"): (row.number("x"), row.number("y"))
            for row in document.records("node")
        }
        self._lines = {row.text("token"): row for row in document.records("line")}
        self._polygons = {row.text("token"): row for row in document.records("polygon")}

    def lines(self, layers: tuple[str, ...]) -> list[np.ndarray]:
        """The segments of each record's line. Some lines of real maps have no nodes."""
        lines = []
        for layer in layers:
            for row in self._document.records(layer):
                line = self._find(self._lines, "line", row, "line_token")
                points = self._points(line, "node_tokens")
                lines.append(np.stack((points[:-1], points[1:]), axis=1))
        return lines

    def crossings(self) -> list[np.ndarray]:
        """The edges of each crossing's exterior."""
        return [
            ring_edges(ring)
            for row in self._document.records("ped_crossing")
            if len(ring := self._points(self._polygon(row), "exterior_node_tokens")) > 2
        ]

    def polygons(self, layers: tuple[str, ...]) -> list[np.ndarray]:
        """The edges of each record's polygon, including its holes. A polygon with fewer than three
        corners has no area and is skipped."""
        polygons = []
        for layer in layers:
            for row in self._document.records(layer):
                polygon = self._polygon(row)
                rings = [self._points(polygon, "exterior_node_tokens")]
                if len(rings[0]) < 3:
                    continue
                holes = (self._points(h, "node_tokens") for h in polygon.records("holes"))
                rings.extend(hole for hole in holes if len(hole) > 2)
                polygons.append(np.concatenate([ring_edges(ring) for ring in rings]))
        return polygons

    def _polygon(self, row: Record) -> Record:
        return self._find(self._polygons, "polygon", row, "polygon_token")

    def _points(self, row: Record, key: str) -> np.ndarray:
        try:
            points = [self._nodes[token] for token in row.texts(key)]
        except KeyError as error:
            raise MissingTokenError(f"{row.place}: found no node {error} of {key}") from None
        return np.array(points, float).reshape(-1, 2)

    @staticmethod
    def _find(records: dict[str, Record], layer: str, row: Record, key: str) -> Record:
        token = row.text(key)
        if token not in records:
            raise MissingTokenError(f"{row.place}: found no {layer} '{token}' of {key}")
        return records[token]
