"""Tests the conversion of nuScenes' maps and their rasters."""

import json
import math
import tempfile
import unittest
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from tests.training.nuscenes_tree import MAP_CENTRE, box, edit_json, map_expansion
from training.nuscenes.errors import (
    MissingFileError,
    MissingTokenError,
    UnreadableJsonError,
    WrongTypeError,
)
from training.nuscenes.geometry import Se2
from training.nuscenes.map_expansion import MapExpansion, clip
from training.nuscenes.raster import draw
from training.nuscenes.road_contour import RoadContour, ring_edges

DIVIDER, CROSSING, BOUNDARY = range(3)


Ring = Sequence[Sequence[float]] | np.ndarray


def outline(*polygons: Sequence[Ring]) -> np.ndarray:
    """The whole outline of a union of polygons. A polygon is a list of rings."""
    edges = [np.concatenate([ring_edges(np.array(ring, float)) for ring in p]) for p in polygons]
    return RoadContour(edges).segments(np.array([-1e3, -1e3]), np.array([1e3, 1e3]))


def length(segments: np.ndarray) -> float:
    return float(np.hypot(*(segments[:, 1] - segments[:, 0]).T).sum())


def touches(segments: np.ndarray, x: float, y: float) -> bool:
    """Whether some segment passes within a millimetre of a point."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    part = (((x, y) - start) * along).sum(1) / (along**2).sum(1)
    nearest = start + part.clip(0, 1)[:, None] * along
    return bool((np.hypot(*(nearest - (x, y)).T) < 1e-3).any())


class Contour(unittest.TestCase):
    def test_a_polygon_alone_keeps_its_outline_and_its_hole(self):
        self.assertAlmostEqual(length(outline([box(0, 0, 4, 3)])), 14)
        self.assertAlmostEqual(length(outline([box(0, 0, 9, 9), box(2, 2, 4, 3)])), 36 + 6)

    def test_edges_inside_another_polygon_are_removed(self):
        found = outline([box(0, 0, 4, 4)], [box(2, 1, 6, 3)])
        self.assertAlmostEqual(length(found), 16 + 4)
        self.assertTrue(touches(found, 5, 3))
        self.assertFalse(touches(found, 3, 3))
        self.assertFalse(touches(found, 4, 2))
        self.assertTrue(touches(found, 4, 3.5))
        self.assertAlmostEqual(length(outline([box(0, 0, 9, 9)], [box(2, 2, 4, 3)])), 36)

    def test_the_shared_part_of_an_edge_is_removed(self):
        found = outline([box(0, 0, 4, 4)], [box(4, 1, 6, 3)])
        self.assertAlmostEqual(length(found), 16 + 8 - 2 * 2)
        self.assertFalse(touches(found, 4, 2))
        self.assertTrue(touches(found, 4, 3.5))

    def test_a_narrow_gap_is_closed_and_a_wide_one_is_not(self):
        narrow = outline([box(0, 0, 4, 4)], [box(4.01, 0, 8, 4)])
        self.assertFalse(touches(narrow, 4, 2))
        self.assertTrue(touches(narrow, 2, 4))
        self.assertTrue(touches(outline([box(0, 0, 4, 4)], [box(4.1, 0, 8, 4)]), 4, 2))

    def test_a_hole_is_filled_by_what_covers_it(self):
        found = outline([box(0, 0, 9, 9), box(2, 2, 6, 6)], [box(1, 1, 4, 8)])
        self.assertFalse(touches(found, 2, 4))
        self.assertTrue(touches(found, 6, 4))
        self.assertTrue(touches(found, 4, 4))
        self.assertAlmostEqual(length(found), 36 + 2 * 2 + 2 * 4)

    def test_slanted_and_reversed_rings_are_the_same(self):
        turn = Se2(3, -2, 0.7)
        a = turn.apply(np.array(box(0, 0, 4, 4)))
        b = turn.apply(np.array(box(2, 1, 6, 3)))[::-1]
        self.assertAlmostEqual(length(outline([a], [b])), 20)


class Clipping(unittest.TestCase):
    def test_segments_are_clipped_to_the_box(self):
        segments = [
            [[-5, 0.5], [5, 0.5]],
            [[0, 0], [0, 0.2]],
            [[0, 3], [9, 3]],
            [[-3, 0], [0, 3]],
            [[-2, 0], [0, -2]],
        ]
        found = clip(np.array(segments, float), np.array([2.0, 1.0]))
        expected = [
            [[-2, 0.5], [2, 0.5]],
            [[0, 0], [0, 0.2]],
            [[-2, 1], [-2, 1]],  # touches a corner of the box
            [[-2, 0], [-1, -1]],
        ]
        np.testing.assert_allclose(found, np.array(expected, float))


class Drawing(unittest.TestCase):
    def test_line_width_and_profile_match_the_appliance(self):
        line = np.array([[[-20.0, 0.0], [20.0, 0.0]]])  # between columns 99 and 100
        for width, expected in ((5, [0, 128, 255, 255]), (8, [255, 255, 255, 255])):
            raster = draw([line], width)
            self.assertEqual(raster.shape, (1, 400, 200))
            self.assertEqual(raster.dtype, np.uint8)
            np.testing.assert_allclose(raster[0, 200, 96:100], expected, rtol=0, atol=1)
            np.testing.assert_allclose(raster[0, 200, 103:99:-1], expected, rtol=0, atol=1)
        centred = draw([line + (0, 0.075)], 5)[0, 200, 94:105]  # on column 99
        np.testing.assert_allclose(centred, [0, 0, 0, *[255] * 5, 0, 0, 0], rtol=0, atol=1)
        beside = draw([line + (0, 0.0375)], 5)[0, 200, 96:104]  # on column 99.25
        np.testing.assert_allclose(beside, [0, 191, 255, 255, 255, 255, 64, 0], rtol=0, atol=1)

    def test_ends_are_round_and_long_lines_are_whole(self):
        raster = draw([np.array([[[-29.0, -14.0], [29.0, 14.0]]])], 5)[0]
        for part in np.linspace(0, 1, 50):
            x, y = -29 + 58 * part, -14 + 28 * part
            row, col = round((30 - x) / 0.15 - 0.5), round((15 - y) / 0.15 - 0.5)
            self.assertEqual(raster[row, col], 255)
        rows, cols = np.nonzero(raster)
        x, y = 30 - (rows + 0.5) * 0.15, 15 - (cols + 0.5) * 0.15
        along = ((x + 29) * 58 + (y + 14) * 28) / (58**2 + 28**2)
        part = along.clip(0, 1)
        distance = np.hypot(x - (-29 + 58 * part), y - (-14 + 28 * part))
        self.assertLessEqual(distance.max(), 3 * 0.15)

    def test_no_segments_give_an_empty_raster(self):
        self.assertEqual(draw([np.empty((0, 2, 2))] * 3, 5).sum(), 0)


class Maps(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "boston-seaport.json"
        self.path.write_text(json.dumps(map_expansion()))

    def raster(self, pose: Se2) -> np.ndarray:
        return draw(MapExpansion(self.path).segments(pose), 5)

    @staticmethod
    def at(raster: np.ndarray, layer: int, x: float, y: float) -> int:
        """The cell of a point of the vehicle frame."""
        return int(raster[layer, math.floor((30 - x) / 0.15), math.floor((15 - y) / 0.15)])


class Layers(Maps):
    def setUp(self):
        super().setUp()
        self.drawn = self.raster(Se2(*MAP_CENTRE, 0.0))

    def test_dividers_lie_where_geometry_says(self):
        for x in (-25.0, -10.0, 0.0, 20.0):  # y = -4 is column 126
            self.assertEqual(self.drawn[DIVIDER, round((30 - x) / 0.15), 126], 255)
        for angle in (0.05, 0.2, 0.4, 0.55):
            x, y = 50 * math.sin(angle), 50 * (1 - math.cos(angle))
            self.assertEqual(self.at(self.drawn, DIVIDER, x, y), 255)
            self.assertEqual(self.at(self.drawn, DIVIDER, x, y + 1.0), 0)
        self.assertEqual(self.at(self.drawn, DIVIDER, -10, 0), 0)

    def test_a_crossing_is_its_two_long_edges(self):
        for x in (10, 14):
            self.assertEqual(self.at(self.drawn, CROSSING, x, 3), 255)
        self.assertEqual(self.at(self.drawn, CROSSING, 12, 8), 0)
        self.assertEqual(self.at(self.drawn, CROSSING, 12, 3), 0)

    def test_the_boundary_is_the_outline_of_roads_and_lanes(self):
        for x, y in ((-10, 8), (-10, -8), (20, -8), (15, 12), (5, 10), (28, 8), (-20, -6.5)):
            self.assertEqual(self.at(self.drawn, BOUNDARY, x, y), 255, (x, y))
        for x, y in ((0, 0), (15, 8), (15, 4), (5, 6)):
            self.assertEqual(self.at(self.drawn, BOUNDARY, x, y), 0, (x, y))

    def test_the_patch_border_is_no_boundary(self):
        inner = self.drawn[BOUNDARY, :, 70:130]  # the road continues beyond the raster
        self.assertEqual(inner[:5].max(), 0)
        self.assertEqual(inner[-5:].max(), 0)

    def test_the_raster_turns_and_moves_with_the_vehicle(self):
        x0, y0 = MAP_CENTRE
        facing_north = self.raster(Se2(x0, y0, math.pi / 2))
        self.assertEqual(self.at(facing_north, DIVIDER, -4, 10), 255)  # 10 m to the west
        self.assertEqual(self.at(facing_north, CROSSING, 3, -10), 255)
        moved = self.raster(Se2(x0 + 3, y0 - 1.5, 0.0))
        expected = self.drawn[:, :-20, 10:].astype(int)
        np.testing.assert_allclose(moved[:, 20:, :-10], expected, rtol=0, atol=1)

    def test_the_raster_is_empty_far_from_the_map(self):
        self.assertEqual(self.raster(Se2(0.0, 0.0, 0.0)).sum(), 0)


class BadMaps(Maps):
    def refuse(self, error: type[Exception], message: str, change: Callable) -> None:
        edit_json(self.path, change)
        with self.assertRaisesRegex(error, message):
            MapExpansion(self.path)

    def test_a_missing_map_is_named(self):
        with self.assertRaisesRegex(MissingFileError, "absent.json"):
            MapExpansion(self.path.with_name("absent.json"))

    def test_an_unreadable_map_is_named_with_its_place(self):
        self.path.write_text('{"node": [\n}')
        with self.assertRaisesRegex(UnreadableJsonError, "seaport.json: line 2, column 1"):
            MapExpansion(self.path)

    def test_an_unknown_line_is_refused(self):
        self.refuse(
            MissingTokenError,
            "seaport.json: lane_divider 1: found no line 'lost' of line_token",
            lambda m: m["lane_divider"][1].update(line_token="lost"),
        )

    def test_an_unknown_polygon_is_refused(self):
        self.refuse(
            MissingTokenError,
            "ped_crossing 0: found no polygon 'lost'",
            lambda m: m["ped_crossing"][0].update(polygon_token="lost"),
        )

    def test_an_unknown_node_is_refused(self):
        self.refuse(
            MissingTokenError,
            "line 2: found no node 'lost' of node_tokens",
            lambda m: m["line"][2]["node_tokens"].append("lost"),
        )

    def test_a_missing_layer_is_refused(self):
        self.refuse(
            WrongTypeError,
            "found no 'road_divider', wanted a list of objects",
            lambda m: m.pop("road_divider"),
        )

    def test_an_invalid_coordinate_is_refused(self):
        self.refuse(
            WrongTypeError,
            "node 3: 'x' is null, wanted a number",
            lambda m: m["node"][3].update(x=None),
        )


if __name__ == "__main__":
    unittest.main()
