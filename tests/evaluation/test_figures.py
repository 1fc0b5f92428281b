"""The figures of script/figures, drawn from small made-up data."""

from __future__ import annotations

import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from evaluation.figures import axis_features, distributions, frame_stages, source
from evaluation.figures import spectra, stanford, style

RANDOM = np.random.default_rng(1)


def planes(rows: int, cols: int) -> list:
    """Three planes of probabilities, each with one line."""
    values = np.zeros((3, rows, cols))
    for k in range(3):
        values[k, :, (k + 1) * cols // 4] = 1.0
    return values.tolist()


def scaled_to_bytes(values: list) -> list:
    return (255 * np.array(values)).astype(int).tolist()


def spectra_data() -> spectra.Spectra:
    view: spectra.View = {
        "raster": scaled_to_bytes(planes(40, 20)),
        "log_amplitude": RANDOM.uniform(0, 3, (16, 16)).tolist(),
        "signature": [0.0, 4.0, 0.0],
        "score": [-1.0, 0.0, -1.0],
    }
    return {
        "turn_deg": 10.0,
        "shift_m": 5.0,
        "band": 2,
        "band_edges_per_m": np.linspace(0.05, 0.8, 9).tolist(),
        "frequency_limit_per_m": 0.83,
        "angles_deg": [0.0, 90.0, 179.0],
        "hypotheses_deg": [-15.0, 0.0, 15.0],
        "views": [view, view, view],
    }


def axis_data() -> axis_features.AxisFeatures:
    side: axis_features.PerceivedSide = {
        "features": planes(20, 10),
        "x_profile": [[-1.0, 2.0, -1.0]] * 3,
        "y_profile": [[0.5, -0.5]] * 3,
        "x_score": [0.1, 0.9, 0.2],
        "y_score": [0.3, 0.8, 0.1],
    }
    return {
        "channels": ["divider", "crossing", "boundary"],
        "shift_m": 2.0,
        "x_m": [20.0, 0.0, -20.0],
        "y_m": [10.0, -10.0],
        "hypotheses_m": [-3.0, 0.0, 3.0],
        "map": side,
        "perceived": [side, side],
    }


def distribution_data(scenes: int) -> distributions.Distributions:
    axis: distributions.AxisData = {
        "truth": 0.3,
        "hypotheses": [-2.0, 0.0, 2.0],
        "solutions": [{"probability": [0.1, 0.7, 0.2], "mean": 0.1, "sigma": 0.5}] * 3,
    }
    scene: distributions.Scene = {
        "road": "straight_solid",
        "perceived": scaled_to_bytes(planes(40, 20)),
        "raster_prior": scaled_to_bytes(planes(40, 20)),
        "axes": {"x_m": axis, "y_m": axis, "yaw_deg": axis},
    }
    return {"solvers": ["one", "two", "three"], "scenes": [scene] * scenes}


def bench_data() -> frame_stages.Bench:
    return {
        "model": "nano",
        "instruction_set": "avx2",
        "threads": 1,
        "stages": [
            {"name": "solver", "in_frame": True, "p50_ms": 2.0, "p99_ms": 3.0, "ideal_ms": 1.0},
            {"name": "can", "in_frame": True, "p50_ms": 0.1, "p99_ms": 0.2, "ideal_ms": 0.0},
            {"name": "mjpeg", "in_frame": False, "p50_ms": 9.0, "p99_ms": 9.0, "ideal_ms": 0.0},
        ],
        "frame": {"p50_ms": 2.2, "p99_ms": 3.5, "sum_of_ideals_ms": 1.0},
    }


def stanford_data() -> list[stanford.Diagram]:
    counts = np.zeros((60, 60), dtype=int)
    counts[10:20, :8] = 100
    counts[15, 30] = 1
    axes: list[stanford.Axis] = [
        {
            "axis": name, "unit": "m", "alert_limit": 1.0, "bin": 0.05, "bins": 60,
            "counts": counts.ravel().tolist(), "misleading": 1, "hazardous": 1,
        }
        for name in ("longitudinal", "lateral", "yaw")
    ]
    return [
        {"name": "no fault", "drives": 3, "drives_with_pose": 2, "valid_poses": 8001, "axes": axes},
        {
            "name": "with faults", "drives": 1, "drives_with_pose": 0, "valid_poses": 0,
            "axes": axes,
        },
    ]


class FiguresTest(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.file = Path(temporary.name) / "new" / "figure.png"

    def check(self, size: tuple[int, int], colours: list[str]) -> None:
        """The file has this size, and shows each colour."""
        image = Image.open(self.file).convert("RGB")
        self.assertEqual(image.size, size)
        pixels = np.asarray(image).reshape(-1, 3).astype(int)
        self.assertGreater(np.count_nonzero((pixels < 250).any(axis=1)), 0.02 * len(pixels))
        for colour in colours:
            rgb = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
            near = np.abs(pixels - rgb).max(axis=1) < 16
            self.assertGreater(np.count_nonzero(near), 20, colour)

    def test_spectra(self) -> None:
        spectra.draw(spectra_data(), self.file)
        self.check(spectra.SIZE_PX, [style.INK, style.ORANGE, spectra.BAND])

    def test_axis_features(self) -> None:
        axis_features.draw(axis_data(), self.file)
        self.check(axis_features.SIZE_PX, [style.BLUE, style.GREEN, style.ORANGE])

    def test_distributions(self) -> None:
        for scenes in (1, 3):
            distributions.draw(distribution_data(scenes), self.file)
            size = (distributions.WIDTH_PX, distributions.height_px(scenes))
            self.check(size, [style.TRUTH, *distributions.SOLVER_COLOURS])

    def test_frame_stages_are_those_of_the_frame(self) -> None:
        data = bench_data()
        names = [bar["name"] for bar in frame_stages.rows(data)]
        self.assertEqual(names, ["solver", "can", "whole frame"])
        frame_stages.draw(data, self.file)
        self.check((frame_stages.WIDTH_PX, frame_stages.height_px(3)), [style.BLUE, style.GREEN])

    def test_stanford_leaves_out_a_diagram_without_poses(self) -> None:
        data = stanford.data_of(stanford_data(), self.file)
        stanford.draw(data, self.file)
        width = stanford.LEFT + 3 * stanford.PANEL + 2 * stanford.GAP + stanford.RIGHT
        height = stanford.TOP + stanford.PANEL + stanford.BOTTOM
        self.check((width, height), [style.INK, style.ORANGE])

    def test_stanford_says_how_many_drives_had_a_pose(self) -> None:
        said = stanford.heading(stanford_data()[0])
        self.assertEqual(said, "no fault: 8001 valid poses, 2 of 3 drives had a pose")


class SourceTest(unittest.TestCase):
    def refusal(self, read: Callable[[Any, Path], object], document: object) -> str:
        with self.assertRaises(source.SourceError) as refused:
            read(document, Path("x.json"))
        return str(refused.exception)

    def test_a_bench_without_the_frame_or_its_ideals_is_named(self) -> None:
        whole: dict[str, Any] = {**bench_data()}
        self.assertEqual(frame_stages.data_of(whole, Path("x.json")), whole)
        stage = {key: value for key, value in whole.items() if key != "frame"}
        no_peak = {**whole, "frame": {**whole["frame"], "sum_of_ideals_ms": None}}
        for document, found, wanted in (
            ({"sweeps": {}}, "no stages", "bench --json`"),
            ([], "no stages", "bench --json`"),
            (stage, "no whole frame", "without --stage"),
            (no_peak, "no ideal times", "without --no-peak"),
        ):
            said = self.refusal(frame_stages.data_of, document)
            self.assertRegex(said, f"^x.json: found {found}, .*{wanted}$")

    def test_diagrams_without_poses_are_named(self) -> None:
        for document, found in (
            (bench_data(), "no diagrams"),
            ([{}], "no diagrams"),
            ([1], "no diagrams"),
            ([{"name": "no fault", "valid_poses": 1, "axes": []}], "no diagrams"),
            (stanford_data()[1:], "no valid pose"),
        ):
            self.assertRegex(self.refusal(stanford.data_of, document), f"^x.json: found {found}")

    def test_a_file_without_json_is_named(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "x.json"
            for content in (None, b"", b"\xff"):
                if content is not None:
                    file.write_bytes(content)
                with self.assertRaisesRegex(source.SourceError, f"^{file}: found no JSON"):
                    source.read(file)


class BevImageTest(unittest.TestCase):
    def test_shows_each_class_in_its_colour_on_white(self) -> None:
        image = style.bev_image(planes(4, 8))
        self.assertEqual(image.shape, (4, 8, 3))
        np.testing.assert_allclose(image[0, 0], 1.0)
        for k, colour in enumerate(style.CLASS_COLOURS):
            np.testing.assert_allclose(image[1, 2 * (k + 1)], np.array(colour) / 255)

    def test_a_map_below_it_is_grey(self) -> None:
        image = style.over_grey(np.ones((4, 8, 3)), planes(4, 8))
        np.testing.assert_allclose(image[0, 2], 200 / 255)
        np.testing.assert_allclose(image[0, 0], 1.0)


if __name__ == "__main__":
    unittest.main()
