"""The outline of a union of polygons, as unconnected segments.

A piece of a polygon's edge belongs to the outline if the union lies on exactly one side of it.
Edges are cut where edges of other polygons cross or touch them, so that this holds or fails for a
whole piece.
"""

from __future__ import annotations

import numpy as np

# Distance beside a piece at which the union is tested. Narrower gaps between polygons are closed.
PROBE_M = 0.02
_SHORTEST_PIECE_M = 1e-3


def ring_edges(ring: np.ndarray) -> np.ndarray:
    """Corners [n, 2] -> closed outline [n, 2 ends, 2]."""
    return np.stack((ring, np.roll(ring, -1, axis=0)), axis=1)


class RoadContour:
    """The outline of polygons. A polygon is given by the edges [n, 2, 2] of its exterior and its
    holes (even-odd rule). Outlines are computed on demand and cached."""

    def __init__(self, polygons: list[np.ndarray]) -> None:
        self._polygons = polygons
        corners = [edges.reshape(-1, 2) for edges in polygons]
        self._low = np.array([c.min(0) for c in corners]).reshape(-1, 2) - PROBE_M
        self._high = np.array([c.max(0) for c in corners]).reshape(-1, 2) + PROBE_M
        self._outlines: dict[int, np.ndarray] = {}

    def segments(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """The outline [n, 2, 2] of all polygons whose bounding box overlaps the given box."""
        found = [np.empty((0, 2, 2))]
        for polygon in self._meeting(low, high):
            if polygon not in self._outlines:
                self._outlines[polygon] = self._outline(polygon)
            found.append(self._outlines[polygon])
        return np.concatenate(found)

    def _meeting(self, low: np.ndarray, high: np.ndarray) -> list[int]:
        """The polygons whose bounding box overlaps the given box."""
        meets = (self._low <= high).all(1) & (self._high >= low).all(1)
        return np.flatnonzero(meets).tolist()

    def _outline(self, polygon: int) -> np.ndarray:
        """The part of one polygon's edges that lies on the outline of the union."""
        neighbours = [
            self._polygons[i] for i in self._meeting(self._low[polygon], self._high[polygon])
        ]
        pieces = _cut(self._polygons[polygon], np.concatenate(neighbours))
        along = pieces[:, 1] - pieces[:, 0]
        length = np.hypot(along[:, 0], along[:, 1])
        normal = np.stack((-along[:, 1], along[:, 0]), axis=1) / length[:, None]
        middle = pieces.mean(1)
        left = _inside_any(middle + PROBE_M * normal, neighbours)
        right = _inside_any(middle - PROBE_M * normal, neighbours)
        return pieces[left != right]


def _cut(edges: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Cuts edges [m, 2, 2] wherever an edge of `others` crosses or one of its ends touches them."""
    start, along = edges[:, None, 0], (edges[:, 1] - edges[:, 0])[:, None]  # [m, 1, 2]
    length_squared = (along**2).sum(-1)
    to_other, other_along = others[None, :, 0] - start, (others[:, 1] - others[:, 0])[None]
    with np.errstate(divide="ignore", invalid="ignore"):
        cross = _cross(along, other_along)
        crossing = _cross(to_other, other_along) / cross
        on_other = _cross(to_other, along) / cross
        touching = (to_other * along).sum(-1) / length_squared
        distance = np.abs(_cross(along, to_other)) / np.sqrt(length_squared)
    crosses = (on_other >= 0) & (on_other <= 1) & (crossing > 0) & (crossing < 1)
    touches = (distance <= 2 * PROBE_M) & (touching > 0) & (touching < 1)
    edge = np.arange(len(edges))
    of_edge = np.concatenate((edge, edge, np.nonzero(crosses)[0], np.nonzero(touches)[0]))
    ends = np.zeros(len(edges)), np.ones(len(edges))
    where = np.concatenate((*ends, crossing[crosses], touching[touches]))
    order = np.lexsort((where, of_edge))
    of_edge, where = of_edge[order], where[order]
    points = edges[of_edge, 0] + where[:, None] * (edges[of_edge, 1] - edges[of_edge, 0])
    pieces = np.stack((points[:-1], points[1:]), axis=1)
    length = np.hypot(*(pieces[:, 1] - pieces[:, 0]).T)
    return pieces[(of_edge[:-1] == of_edge[1:]) & (length > _SHORTEST_PIECE_M)]


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _inside_any(points: np.ndarray, polygons: list[np.ndarray]) -> np.ndarray:
    """Whether each of the points [n, 2] lies in at least one of the polygons."""
    inside = np.zeros(len(points), bool)
    x, y = points[:, :1], points[:, 1:]
    for edges in polygons:
        (x0, y0), (x1, y1) = edges[:, 0].T, edges[:, 1].T
        straddles = (y0 > y) != (y1 > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing_x = x0 + (y - y0) * (x1 - x0) / (y1 - y0)
        inside |= (straddles & (x < crossing_x)).sum(1) % 2 == 1
    return inside
