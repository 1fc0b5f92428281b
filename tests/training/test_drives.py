"""Tests training on recorded drives: streams, what is held back, bad samples and the report."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import tempfile
import unittest
from pathlib import Path
from unittest.mock import patch

import torch
import yaml
from PIL import Image

from training.config import TrainingConfig
from training.data import DriveStream, MixedStream
from training.distributed import Share
from training.drive_report import figures_table, remarks, report
from training.errors import TrainingError
from training.evaluate import AXES, CLASSES
from training.options import parse_config
from training.sampler_process import DriveFacts, Drives, SamplerError
from training.sources import drive_batches, training_stream, validation_set

ROOT = Path(__file__).parent.parent.parent
RIG = ROOT / "config/rig_demo.yaml"
CAMERAS = ("front_left", "front", "front_right", "back_left", "back", "back_right")
LENGTH_M, SPACING_M = 1000, 10
# The middle of a row of squares (training/drives/drive_parts.h). The fourth square from the map's
# origin is held back, the seventh is for calibration.
NORTH_M = 50
STEP_NS = 200_000_000


def write_drive(folder: Path, length_m: int = LENGTH_M, spacing_m: int = SPACING_M) -> None:
    """A drive to the east with one picture per camera that every frame shows, and a map."""
    size = (640, 360)
    frames = length_m // spacing_m
    for number, camera in enumerate(CAMERAS):
        (folder / camera).mkdir(parents=True)
        Image.new("RGB", size, (40 + number, 90, 90)).save(folder / camera / "0.png")
        lines = [f"{i} {(i + 1) * STEP_NS} 0.png" for i in range(frames)]
        (folder / camera / "frames.txt").write_text("\n".join(lines) + "\n")
    poses = [f"{i * STEP_NS},{i * spacing_m},{NORTH_M},0" for i in range(frames + 3)]
    (folder / "reference.csv").write_text("time_ns,x_m,y_m,yaw_deg\n" + "\n".join(poses) + "\n")


def write_map(path: Path) -> None:
    """Lane dividers 2 m beside the drive, and boundaries 5 m beside it."""
    ways: list[str] = []
    nodes: list[str] = []
    for number, (y_m, kind) in enumerate(
        ((-5, "curbstone"), (-2, "line_thin"), (2, "line_thin"), (5, "curbstone"))
    ):
        ids = []
        for x_m in range(-50, LENGTH_M + 60, 10):
            ids.append(1 + len(nodes))
            nodes.append(
                f'<node id="{ids[-1]}" lat="0" lon="0"><tag k="local_x" v="{x_m}"/>'
                f'<tag k="local_y" v="{NORTH_M + y_m}"/></node>'
            )
        refs = "".join(f'<nd ref="{i}"/>' for i in ids)
        subtype = '<tag k="subtype" v="dashed"/>' if kind == "line_thin" else ""
        ways.append(f'<way id="{1000 + number}">{refs}<tag k="type" v="{kind}"/>{subtype}</way>')
    lanelets = [
        f'<relation id="{2000 + k}"><member type="way" ref="{1001 + k}" role="left"/>'
        f'<member type="way" ref="{1000 + k}" role="right"/><tag k="type" v="lanelet"/>'
        '<tag k="subtype" v="road"/></relation>'
        for k in range(3)
    ]
    path.write_text(
        '<?xml version="1.0"?><osm version="0.6">' + "\n".join(nodes + ways + lanelets) + "</osm>"
    )


class DrivesTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        write_drive(self.root / "drive")
        write_map(self.root / "map.osm")
        self.drives = Drives(str(self.root / "drive"), str(self.root / "map.osm"), str(RIG))

    def stream(self, first: int = 0, threads: int = 1, share: Share = Share(0, 1)) -> DriveStream:
        stream = DriveStream(self.drives, "training", 5, first, threads, 0.0, share)
        self.addCleanup(stream.close)
        return stream

    def stream_that_skips(self, first: int = 0) -> DriveStream:
        drives = dataclasses.replace(self.drives, skip_bad=True)
        stream = DriveStream(drives, "training", 5, first, 1, 0.0)
        self.addCleanup(stream.close)
        return stream

    def spoil(self, camera: str, frames: int) -> None:
        """Damages the first pictures of a camera."""
        index = self.root / "drive" / camera / "frames.txt"
        lines = index.read_text().splitlines()
        lines[:frames] = [line.replace("0.png", "bad.png") for line in lines[:frames]]
        index.write_text("\n".join(lines) + "\n")
        (self.root / "drive" / camera / "bad.png").write_bytes(b"no picture")

    def test_two_of_its_squares_are_set_aside(self) -> None:
        samples = self.drives.facts().samples
        self.assertEqual(list(samples), ["training", "calibration", "held-back"])
        # Of 1,000 m, 100 are held back and 100 for calibration; 36 on both sides are left out.
        self.assertAlmostEqual(
            samples["training"], (LENGTH_M - 200 - 4 * 36) // SPACING_M, delta=2
        )
        for part in ("calibration", "held-back"):
            self.assertEqual(samples[part], 100 // SPACING_M)
            self.assertEqual(
                sum(map(len, drive_batches(self.drives, part, 999, 1))), samples[part]
            )

    def test_drives_without_a_part_are_refused_before_training(self) -> None:
        write_drive(self.root / "short", 500)
        config = dataclasses.replace(self.config(0.0), recordings=str(self.root / "short"))
        with self.assertRaisesRegex(TrainingError, "found no sample of the part calibration"):
            validation_set(config)

    def test_drives_without_a_held_back_sample_are_refused_before_training(self) -> None:
        samples = {"training": 66, "calibration": 24, "held-back": 0}
        facts = DriveFacts(samples, (200.0, 600.0), (1.2, 3.1))
        with patch("training.sampler_process.Drives.facts", return_value=facts):
            with self.assertRaisesRegex(TrainingError, "found no sample of the part held-back"):
                validation_set(self.config(0.0))

    def test_drives_with_little_for_calibration_are_refused_before_training(self) -> None:
        for count, found in ((1, "1 sample"), (10, "10 samples"), (23, "23 samples")):
            facts = DriveFacts(
                {"training": 66, "calibration": count, "held-back": 9}, (200, 600), (1, 3)
            )
            with patch("training.sampler_process.Drives.facts", return_value=facts):
                message = f"found {found} of the part calibration, wanted at least 24; give drives"
                with self.assertRaisesRegex(TrainingError, message):
                    validation_set(self.config(0.0))

    def test_the_facts_have_the_ranges_of_the_cameras(self) -> None:
        cameras = yaml.safe_load(RIG.read_text())["cameras"].values()
        focal_px = [c["fx_px"] * 320 / c["image_size_px"][0] for c in cameras]
        height_m = [c["vehicle_from_camera"]["translation_m"][2] for c in cameras]
        facts = self.drives.facts()
        for found, values in ((facts.focal_range_px, focal_px), (facts.height_range_m, height_m)):
            self.assertAlmostEqual(found[0], min(values), places=3)
            self.assertAlmostEqual(found[1], max(values), places=3)

    def test_an_epoch_has_each_sample_once(self) -> None:
        training = self.drives.facts().samples["training"]
        rasters = self.stream().next(2 * training).raster_truth.flatten(1)
        first = {bytes(row.numpy()) for row in rasters[:training]}
        self.assertEqual(first, {bytes(row.numpy()) for row in rasters[training:]})

    def test_samples_depend_on_their_number_alone(self) -> None:
        corrections = self.stream().next(12).correction
        self.assertTrue(torch.equal(self.stream(first=4).next(8).correction, corrections[4:]))
        # Two programs: a batch is grouped by program.
        taken = self.stream(threads=2).next(12).correction
        self.assertTrue(torch.equal(taken[:6], corrections[0::2]))
        resumed = self.stream(first=3, threads=2).next(6).correction
        self.assertTrue(torch.equal(resumed, torch.cat((corrections[4:9:2], corrections[3:9:2]))))
        # Two processes.
        parts = [self.stream(share=Share(rank, 2)).next(6).correction for rank in (0, 1)]
        self.assertTrue(torch.equal(torch.stack(parts, 1).flatten(0, 1), corrections))

    def test_a_bad_sample_ends_the_run_or_is_replaced(self) -> None:
        self.spoil("back", 90)
        with self.assertRaisesRegex(SamplerError, "bevloc_drive_sampler: ended with status 1"):
            self.stream().next(60)
        good = {bytes(row.numpy()) for row in self.stream_that_skips().next(60).raster_truth}
        self.assertLess(len(good), 20)  # of 66 samples, 56 are bad

    def test_a_run_that_skips_bad_samples_can_be_resumed(self) -> None:
        clean = self.stream().next(12)
        self.spoil("front_left", 70)
        whole, resumed = self.stream_that_skips().next(12), self.stream_that_skips(4).next(8)
        self.assertTrue(torch.equal(whole.correction, clean.correction))
        for name, tensor in vars(resumed).items():
            self.assertTrue(torch.equal(tensor, getattr(whole, name)[4:]), name)

    def test_fixed_sets_leave_bad_samples_out(self) -> None:
        whole = drive_batches(self.drives, "held-back", 999, 1)
        # The frames 29 to 38 show the square that is held back.
        self.spoil("back", 34)
        with self.assertRaisesRegex(SamplerError, "ended with status 1"):
            drive_batches(self.drives, "held-back", 999, 1)
        skipping = dataclasses.replace(self.drives, skip_bad=True)
        for threads in (1, 2):
            good = drive_batches(skipping, "held-back", 999, threads)
            self.assertEqual(sum(map(len, good)), 5)
            places = {tuple(row.tolist()) for batch in good for row in batch.correction}
            self.assertEqual(len(places), 5)
            self.assertLess(
                places, {tuple(row.tolist()) for batch in whole for row in batch.correction}
            )
            self.assertTrue(all((batch.camera_mask == 63).all() for batch in good))
        self.assertEqual(sum(map(len, drive_batches(skipping, "held-back", 3, 1))), 3)

    def test_a_report_counts_the_good_samples(self) -> None:
        self.spoil("back", 34)
        skipping = dataclasses.replace(self.drives, skip_bad=True)
        with patch("training.drive_report.evaluate_native"), \
                patch("training.drive_report.NativeNetwork"), \
                patch("training.drive_report.figures_table", return_value=""):
            text = report(Path("before"), Path("after"), skipping, 512, 1)
        self.assertIn("10 held back, 5 of them used here", text)

    def test_fixed_sets_need_a_good_sample(self) -> None:
        self.spoil("front_left", LENGTH_M // SPACING_M)
        skipping = dataclasses.replace(self.drives, skip_bad=True)
        with self.assertRaisesRegex(TrainingError, "found no good sample of the part held-back"):
            drive_batches(skipping, "held-back", 8, 1)

    def test_drives_without_a_good_sample_end_the_run(self) -> None:
        self.spoil("front_left", LENGTH_M // SPACING_M)
        with self.assertRaisesRegex(SamplerError, "ended with status 1"):
            self.stream_that_skips().next(1)

    def test_refuses_a_missing_map(self) -> None:
        drives = Drives(self.drives.recordings, str(self.root / "no.osm"), str(RIG))
        with self.assertRaisesRegex(SamplerError, "status 2"):
            DriveStream(drives, "training", 0, 0, 1, 0.0)

    def config(self, share: float) -> TrainingConfig:
        return TrainingConfig(
            recordings=self.drives.recordings,
            map=self.drives.map,
            rig=self.drives.rig,
            simulated_share=share,
            validation_samples=3,
            drop_camera_probability=0.0,
        )

    def test_half_of_the_samples_are_simulated(self) -> None:
        stream = training_stream(self.config(0.5), 0)
        self.addCleanup(stream.close)
        batch = stream.next(4)
        # The drive's pictures have one colour.
        plain = batch.images[:, 0, 0].flatten(1).float().std(1) == 0.0
        self.assertEqual(plain.tolist(), [True, True, False, False])
        resumed = training_stream(self.config(0.5), 2)
        self.addCleanup(resumed.close)
        expected = torch.cat((batch.correction[1:2], batch.correction[3:4]))
        self.assertTrue(torch.equal(resumed.next(2).correction, expected))

    def test_the_parts_of_a_mixed_stream_add_up(self) -> None:
        for share in (0.0, 0.3, 0.5, 0.9):
            taken = [MixedStream.taken(position, share) for position in range(101)]
            self.assertEqual(taken[100], round(100 * share))
            self.assertLessEqual(max(b - a for a, b in zip(taken, taken[1:])), 1)

    def test_validates_where_nothing_is_trained(self) -> None:
        write_drive(self.root / "slow", spacing_m=4)
        config = dataclasses.replace(self.config(0.0), recordings=str(self.root / "slow"))
        batches = validation_set(config)
        self.assertEqual(sum(map(len, batches)), 3)
        with patch("training.sources.drive_batches", return_value=[range(3)]) as read:
            validation_set(config)
        # The report has the places that are held back.
        self.assertEqual(read.call_args.args[1], "calibration")

    def test_options_need_each_other(self) -> None:
        for wrong in (
            ["--recordings", "x"],
            ["--map", "x"],
            ["--recordings", "x", "--map", "y", "--nuscenes", "z"],
            ["--recordings", "x", "--map", "y", "--reference", "gps"],
            ["--simulated-share", "1"],
            ["--usual-share", "1"],
        ):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()):
                parse_config(["--minutes", "1", *wrong], "")

    def test_reports_both_models(self) -> None:
        model = ROOT / "models/nano.onnx"
        text = report(model, model, self.drives, 4, 1)
        self.assertIn("10 for calibration, 10 held back, 4 of them used here", text)
        self.assertIn("do not trust these figures", text)
        rows = [line.split("|")[2:4] for line in text.splitlines() if line.startswith("| IoU")]
        self.assertEqual(len(rows), len(CLASSES))
        self.assertTrue(all(before == after for before, after in rows))

    def test_the_report_says_what_limits_its_figures(self) -> None:
        self.assertEqual(remarks(self.drives, 24), [])
        self.assertIn("Fewer than 24 samples", remarks(self.drives, 23)[0])
        own = dataclasses.replace(self.drives, reference="own")
        self.assertIn("the sigmas of the new model are too small", remarks(own, 24)[0])

    def test_the_table_keeps_before_and_after_apart(self) -> None:
        def metrics(value: float) -> dict[str, float]:
            solver = "banded+refine"
            keys = [
                f"{solver}_{axis}_{kind}"
                for axis in AXES
                for kind in ("mae", "p90", "within_3_sigma")
            ]
            return {key: value for key in keys} | {f"iou_{name}": value for name in CLASSES}

        rows = figures_table(metrics(0.25), metrics(0.125))
        self.assertIn("| lateral, mean error, m | 0.250 | 0.125 |", rows)
        self.assertIn("| yaw, within 3 sigma | 25.0 % | 12.5 % |", rows)


if __name__ == "__main__":
    unittest.main()
