"""Tests samples from nuScenes' key frames: cameras, view table, motion, prior, bad samples."""

import contextlib
import io
import math
import tempfile
import unittest
from dataclasses import fields
from pathlib import Path

import numpy as np
import torch
import yaml

from tests.training.nuscenes_tree import (
    BACKGROUND,
    CAMERAS,
    SAMPLES_PER_SCENE,
    VERSION,
    edit_json,
    edit_table,
    ego_pose,
    ground_point,
    pixel_of,
    spot_image,
    write_tree,
)
from training.data import Batch
from training.data import view_table as native_view_table
from training.models.view_lut import gather_views
from training.nuscenes.camera import Pinhole, look_through, network_camera
from training.nuscenes.dataset import ALL_CAMERAS, MAX_DEVIATION, NuscenesDataset
from training.nuscenes.errors import (
    CalibrationError,
    MissingFileError,
    MissingTokenError,
    NuscenesError,
    UnreadableImageError,
    WrongSizeError,
)
from training.nuscenes.geometry import Se2, inverse_se3, se3
from training.nuscenes.stream import NuscenesStream
from training.nuscenes.tables import CAMERA_CHANNELS
from training.nuscenes.view_table import cell_centres, view_table

REPOSITORY = Path(__file__).resolve().parents[2]
NO_DEVIATION = np.zeros(3)


def nominal_cameras() -> tuple[list[Pinhole], list[np.ndarray]]:
    """The network cameras of the simulated rig, and camera_from_vehicle."""
    rig = yaml.safe_load((REPOSITORY / "config/rig_demo.yaml").read_text())["cameras"]
    names = ("front_left", "front", "front_right", "back_left", "back", "back_right")
    cameras, motions = [], []
    for camera in (rig[name] for name in names):
        keys = ("fx_px", "fy_px", "cx_px", "cy_px")
        real = Pinhole(*camera["image_size_px"], *(camera[key] for key in keys))
        pose = camera["vehicle_from_camera"]
        motion = se3(pose["rotation_wxyz"], pose["translation_m"])
        cameras.append(network_camera(real, motion))
        motions.append(inverse_se3(motion))
    return cameras, motions


def centroid(plane: np.ndarray) -> np.ndarray:
    """(column, row) of the centroid of the pixels brighter than the background."""
    light = np.clip(plane.astype(float) - BACKGROUND - 15, 0, None)
    rows, cols = np.indices(plane.shape)
    return np.array([(cols * light).sum(), (rows * light).sum()]) / light.sum()


class ViewTable(unittest.TestCase):
    def test_equals_the_native_table_on_the_simulated_rig(self):
        features = torch.randn(6, 4, 12, 40, generator=torch.Generator().manual_seed(3))
        cameras, motions = nominal_cameras()
        for mask in (ALL_CAMERAS, 0b101101, 0b000010, 0):
            index, weight = view_table(cameras, motions, mask)
            self.assertEqual((index.dtype, index.shape), (np.int64, (8, 5000)))
            self.assertEqual((weight.dtype, weight.shape), (np.float32, (8, 5000)))
            tables = (native_view_table(mask), map(torch.from_numpy, (index, weight)))
            expected, found = (gather_views(features, i[None], w[None]) for i, w in tables)
            torch.testing.assert_close(found, expected, rtol=0, atol=1e-4)


class NetworkCamera(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "image.jpg"

    def check(self, size_px: tuple[int, int], col: float, row: float) -> None:
        camera = CAMERAS["CAM_FRONT"]
        scale = size_px[0] / 1600
        f, cx, cy = (scale * v for v in (camera.focal_px, camera.cx_px, camera.cy_px))
        real = Pinhole(*size_px, f, f, cx, cy)
        network = network_camera(real, se3(camera.rotation_wxyz, camera.translation_m))
        spot_image([(col, row)], size_px).save(self.path, quality=95)
        planes = look_through(self.path, real, network)
        self.assertEqual((planes.dtype, planes.shape), (np.uint8, (3, 96, 320)))
        ray = np.array([col - cx, row - cy]) / f
        expected = ray * network.fx_px + (network.cx_px, network.cy_px)
        np.testing.assert_allclose(centroid(planes[0]), expected, atol=0.05)

    def test_a_spot_lands_where_the_network_camera_projects_it(self):
        for size_px in ((320, 180), (640, 360), (800, 450), (1600, 900)):
            scale = size_px[0] / 320
            self.check(size_px, 101.3 * scale, 121.7 * scale)
            self.check(size_px, 250.6 * scale, 140.2 * scale)

    def test_the_horizon_is_in_row_14(self):
        for camera in CAMERAS.values():
            real = Pinhole(320, 180, *(camera.focal_px / 5,) * 2, 160.0, 90.0)
            vehicle_from_camera = se3(camera.rotation_wxyz, camera.translation_m)
            network = network_camera(real, vehicle_from_camera)
            # A horizontal direction in the camera's vertical centre plane, in camera axes.
            right = vehicle_from_camera[:3, 0]
            level = np.cross(np.array([0, 0, 1.0]), right)
            _, y, z = vehicle_from_camera[:3, :3].T @ level
            self.assertAlmostEqual(network.fy_px * y / z + network.cy_px, 14.0, places=6)

    def test_rows_outside_the_real_image_are_black(self):
        real = Pinhole(320, 100, 250.0, 250.0, 160.0, 50.0)
        spot_image([], (320, 100)).save(self.path)
        looks_ahead = se3((0.5, -0.5, 0.5, -0.5), (0, 0, 1.5))
        planes = look_through(self.path, real, network_camera(real, looks_ahead))
        self.assertEqual(planes[:, 70:].max(), 0)
        np.testing.assert_allclose(planes[:, :60], BACKGROUND, atol=1)

    def test_a_camera_that_faces_the_ground_is_refused(self):
        real = Pinhole(320, 180, 250.0, 250.0, 160.0, 90.0)
        with self.assertRaisesRegex(CalibrationError, "facing the ground"):
            network_camera(real, se3((0.0, 1.0, 0.0, 0.0), (0, 0, 1.5)))


class Tree(unittest.TestCase):
    MARKS: tuple = ()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        write_tree(self.root, self.MARKS)

    def dataset(self) -> NuscenesDataset:
        return NuscenesDataset(self.root)

    def edit(self, table: str, token: str, key: str, value: object) -> None:
        edit_table(self.root, table, lambda row: row.update({key: value}), token)


class Motion(Tree):
    """The cameras expose at different times. A spot on the ground must still appear at the pixel
    that the view table gives for its BEV cell."""

    CELLS = [
        int(np.argmin(np.hypot(*(cell_centres() - point).T)))
        for camera in CAMERAS.values()
        for point in [
            np.array(camera.translation_m[:2])
            + 8.0
            * np.array([f(math.radians(camera.azimuth_deg)) for f in (math.cos, math.sin)])
        ]
    ]
    MARKS = tuple(map(tuple, cell_centres()[CELLS]))

    def table_pixel(self, index: np.ndarray, weight: np.ndarray, cell: int) -> np.ndarray:
        """The pixel at which a single camera sees a cell: the mean of its bilinear neighbours."""
        rows, cols = np.divmod(index[:, cell] % 480, 40)
        place = np.stack((cols, rows), axis=1) * 8 + 3.5
        self.assertAlmostEqual(float(weight[:, cell].sum()), 1.0, places=5)
        return weight[:, cell] @ place

    def test_a_point_is_seen_where_the_table_of_its_cell_says(self):
        dataset = self.dataset()
        for position in (0, 4):
            for camera, cell in enumerate(self.CELLS):
                sample = dataset.sample(position, NO_DEVIATION, camera_mask=1 << camera)
                expected = self.table_pixel(sample.index, sample.weight, cell)
                found = centroid(sample.images[camera, 0])
                np.testing.assert_allclose(found, expected, atol=0.15)

    def test_ignoring_the_motion_would_be_noticed(self):
        camera, scene, sample = CAMERAS["CAM_FRONT_LEFT"], 0, 1
        point = ground_point(scene, sample, *self.MARKS[0])
        then = pixel_of(camera, ego_pose(scene, sample, camera.time_us), point)
        now = pixel_of(camera, ego_pose(scene, sample, 0), point)
        assert then is not None and now is not None
        self.assertGreater(math.dist(then, now), 5.0)

    def test_the_pose_is_the_one_at_the_lidars_time(self):
        pose = self.dataset().map_from_vehicle("sample-1-2")
        place, _ = ego_pose(1, 2, 0)
        np.testing.assert_allclose((pose.x_m, pose.y_m), place[:2])
        self.assertAlmostEqual(pose.yaw_rad, 0.1, places=3)


class Prior(Tree):
    def rasters(self, *deviation: float) -> tuple[np.ndarray, np.ndarray]:
        sample = self.dataset().sample(1, np.array(deviation))
        np.testing.assert_allclose(sample.correction, deviation)
        return sample.raster_prior.astype(int), sample.raster_truth.astype(int)

    def test_without_deviation_prior_and_truth_are_the_same(self):
        prior, truth = self.rasters(0, 0, 0)
        np.testing.assert_array_equal(prior, truth)
        self.assertEqual((truth > 0).any((1, 2)).tolist(), [True] * 3)

    def test_a_prior_too_far_behind_sees_the_map_further_ahead(self):
        prior, truth = self.rasters(1.5, 0, 0)
        np.testing.assert_allclose(prior[:, :-10], truth[:, 10:], rtol=0, atol=1)

    def test_a_prior_too_far_right_sees_the_map_further_left(self):
        prior, truth = self.rasters(0, 0.75, 0)
        np.testing.assert_allclose(prior[:, :, :-5], truth[:, :, 5:], rtol=0, atol=1)

    def test_a_rotated_prior_follows_the_papers_equation(self):
        deviation = (1.2, -0.6, math.radians(1.7))
        prior, truth = self.rasters(*deviation)
        rows, cols = np.nonzero(truth[0] == 255)
        points = np.stack((30 - (rows + 0.5) * 0.15, 15 - (cols + 0.5) * 0.15), axis=1)
        moved = Se2(*deviation).apply(points)  # p_prior = dT p_truth, from T = T0 dT
        row = np.round((30 - moved[:, 0]) / 0.15 - 0.5).astype(int)
        col = np.round((15 - moved[:, 1]) / 0.15 - 0.5).astype(int)
        inside = (row >= 0) & (row < 400) & (col >= 0) & (col < 200)
        self.assertGreater(inside.sum(), 1000)
        self.assertGreater((prior[0, row[inside], col[inside]] > 60).mean(), 0.99)

    def test_a_dropped_camera_is_black_and_not_in_the_view_table(self):
        sample = self.dataset().sample(0, NO_DEVIATION, camera_mask=0b111101)
        self.assertEqual(sample.images[1].max(), 0)
        self.assertGreater(sample.images[0].max(), 0)
        self.assertNotIn(1, set((sample.index // 480)[sample.weight > 0].tolist()))


class BadSamples(Tree):
    IMAGE = "samples/CAM_BACK/n015__CAM_BACK__0-1.jpg"

    def refuse(self, error: type, message: str) -> None:
        """Checks that sample 1 is refused and another one is not."""
        dataset = self.dataset()
        with self.assertRaisesRegex(error, message):
            dataset.sample(1, NO_DEVIATION)
        dataset.sample(3, NO_DEVIATION)

    def test_a_missing_image_is_refused(self):
        (self.root / self.IMAGE).unlink()
        self.refuse(MissingFileError, "CAM_BACK__0-1.jpg: found no such file")

    def test_an_image_of_another_size_is_refused(self):
        spot_image([], (160, 90)).save(self.root / self.IMAGE)
        self.refuse(WrongSizeError, "CAM_BACK__0-1.jpg: found 160x90 pixels, wanted 320x180")

    def test_a_truncated_image_is_refused(self):
        path = self.root / self.IMAGE
        path.write_bytes(path.read_bytes()[:600])
        self.refuse(UnreadableImageError, "CAM_BACK__0-1.jpg: unreadable as an image")
        path.write_text("no image at all")
        self.refuse(UnreadableImageError, "CAM_BACK__0-1.jpg: unreadable as an image")

    def test_an_unknown_pose_is_refused(self):
        self.edit("sample_data", "data-CAM_BACK-0-1", "ego_pose_token", "lost")
        self.refuse(MissingTokenError, "ego_pose.json: found no token 'lost', wanted by sample_")

    def test_a_map_that_is_missing_or_unreadable_or_has_a_wrong_token(self):
        path = self.root / "maps/expansion/singapore-onenorth.json"
        edit_json(path, lambda m: m["line"][2]["node_tokens"].append("lost"))
        self.refuse(MissingTokenError, "onenorth.json: line 2: found no node 'lost'")
        path.write_text("[")
        self.refuse(NuscenesError, "onenorth.json: line 1, column 2: invalid JSON")
        path.unlink()
        self.refuse(MissingFileError, "onenorth.json: cannot be opened")

    def test_a_camera_without_intrinsics_is_refused(self):
        self.edit("calibrated_sensor", "calibrated-CAM_BACK", "camera_intrinsic", [])
        with self.assertRaisesRegex(CalibrationError, "'calibrated-CAM_BACK': found no camera_int"):
            self.dataset().sample(1, NO_DEVIATION)

    def test_an_invalid_line_width_is_refused(self):
        with self.assertRaisesRegex(ValueError, "line width: found 0"):
            NuscenesDataset(self.root, line_width_cells=0)


class Stream(Tree):
    SAMPLES = 2 * SAMPLES_PER_SCENE

    def setUp(self):
        super().setUp()
        self.stderr = self.enterContext(contextlib.redirect_stderr(io.StringIO()))

    def stream(
        self,
        first: int = 0,
        threads: int = 2,
        drop_camera_probability: float = 0.0,
        on_error: str = "refuse",
    ) -> NuscenesStream:
        stream = NuscenesStream(
            self.dataset(), 7, first, threads, drop_camera_probability, on_error
        )
        self.addCleanup(stream.close)
        return stream

    def assert_same(self, a: Batch, b: Batch) -> None:
        for field in fields(Batch):
            found, expected = getattr(a, field.name), getattr(b, field.name)
            self.assertTrue(torch.equal(found, expected), field.name)

    def test_batches_have_the_types_and_shapes_that_training_expects(self):
        batch = self.stream(drop_camera_probability=0.5).next(3)
        shapes = {
            "images": (torch.uint8, (3, 6, 3, 96, 320)),
            "camera_mask": (torch.uint8, (3,)),
            "raster_prior": (torch.uint8, (3, 3, 400, 200)),
            "raster_truth": (torch.uint8, (3, 3, 400, 200)),
            "correction": (torch.float32, (3, 3)),
            "index": (torch.int64, (3, 8, 5000)),
            "weight": (torch.float32, (3, 8, 5000)),
        }
        found = {name: (value.dtype, tuple(value.shape)) for name, value in vars(batch).items()}
        self.assertEqual(found, shapes)

    def test_an_epoch_has_every_sample_once_and_the_next_another_order(self):
        batch = self.stream().next(2 * self.SAMPLES)
        truths = [truth.numpy().tobytes() for truth in batch.raster_truth]
        first, second = truths[: self.SAMPLES], truths[self.SAMPLES :]
        self.assertEqual(sorted(first), sorted(second))
        self.assertEqual(len(set(first)), self.SAMPLES)
        self.assertNotEqual(first, second)

    def test_deviations_are_in_range_and_differ(self):
        correction = self.stream().next(2 * self.SAMPLES).correction.numpy()
        self.assertTrue((np.abs(correction) <= MAX_DEVIATION).all())
        self.assertTrue((correction.std(0) > 0.2 * MAX_DEVIATION).all())

    def test_a_stream_resumes_where_it_stopped(self):
        whole = self.stream(drop_camera_probability=0.5)
        resumed = self.stream(first=4, threads=1, drop_camera_probability=0.5)
        whole.next(3)
        whole.next(1)
        self.assert_same(whole.next(4), resumed.next(4))

    def test_cameras_are_dropped_one_or_two_at_a_time(self):
        masks = self.stream(drop_camera_probability=1.0).next(2 * self.SAMPLES).camera_mask
        there = [bin(mask).count("1") for mask in masks.tolist()]
        self.assertEqual(set(there), {4, 5})

    def test_a_bad_sample_is_refused_by_name(self):
        (self.root / BadSamples.IMAGE).unlink()
        with self.assertRaisesRegex(MissingFileError, "sample sample-0-1: .*CAM_BACK__0-1.jpg"):
            self.stream(on_error="refuse").next(self.SAMPLES)

    def test_bad_samples_are_skipped_reported_and_counted(self):
        (self.root / BadSamples.IMAGE).unlink()
        self.edit("sample_data", "data-CAM_FRONT-1-0", "ego_pose_token", "lost")
        stream = self.stream(on_error="skip")
        whole = stream.next(3 * self.SAMPLES)
        resumed = self.stream(first=2 * self.SAMPLES, on_error="skip").next(self.SAMPLES)
        stream.close()
        errors = self.stderr.getvalue()
        self.assertEqual(set(stream.problems.messages), {"sample-0-1", "sample-1-0"})
        self.assertEqual(stream.problems.counts, {"missing file": 1, "missing token": 1})
        self.assertRegex(errors, "bad sample sample-0-1: .*0-1.jpg: found no such")
        self.assertIn("skipped samples: 2 bad (1 missing file, 1 missing token)", errors)
        tail = {name: value[2 * self.SAMPLES :] for name, value in vars(whole).items()}
        self.assert_same(Batch(**tail), resumed)

    def test_a_data_set_without_good_samples_is_refused(self):
        for location in ("singapore-onenorth", "boston-seaport"):
            (self.root / f"maps/expansion/{location}.json").unlink()
        with self.assertRaisesRegex(NuscenesError, "no good sample: 6 bad .6 missing"):
            self.stream(on_error="skip").next(1)

    def test_an_unknown_choice_is_refused(self):
        with self.assertRaisesRegex(ValueError, "on_error: found 'ignore', wanted one of skip"):
            self.stream(on_error="ignore")

    def test_scenes_without_samples_are_refused(self):
        edit_json(self.root / VERSION / "sample.json", lambda rows: rows.clear())
        with self.assertRaisesRegex(ValueError, "found no sample"):
            self.stream()


class Order(unittest.TestCase):
    def test_cameras_are_in_the_projects_order(self):
        names = [channel.removeprefix("CAM_").lower() for channel in CAMERA_CHANNELS]
        rig = yaml.safe_load((REPOSITORY / "config/rig_demo.yaml").read_text())["cameras"]
        self.assertEqual(names, list(rig))


if __name__ == "__main__":
    unittest.main()
