"""Tests the training loop on a synthetic stream."""

import csv
import io
import math
import tempfile
import unittest
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any
from unittest.mock import patch

import torch
from torch import nn

from tests.training.synthetic import SyntheticStream
from training.config import TrainingConfig
from training.data import Batch
from training.errors import CheckpointError, NotFiniteError, TrainingError
from training.model import real_images, real_raster
from training.models import PRESETS, BevNetwork
from training.models.layers import bias_of
from training.models.view_lut import gather_views
from training.optimiser import learning_rate
from training.run_table import TABLES, append_row
from training.train import Trainer, noise_seed


def setUpModule():
    torch.set_num_threads(1)


def trainer(run: str, validation: list[Batch] | None = None, **options: Any) -> Trainer:
    """A short run; options override the defaults of the tests and of TrainingConfig."""
    defaults: dict[str, Any] = {"batch": 2, "samples": 8, "warm_up_steps": 2}
    defaults["precision"] = "float32"
    config = TrainingConfig(run=Path(run), **(defaults | options))
    return Trainer(config, lambda _, first, share: SyntheticStream(first, share), validation or [])


def weights(net: BevNetwork) -> torch.Tensor:
    return torch.cat([value.flatten().double() for value in net.state_dict().values()])


class Shapes(unittest.TestCase):
    @torch.no_grad()
    def test_outputs(self):
        batch = SyntheticStream(0).next(2)
        outputs = BevNetwork(PRESETS["nano"]).eval()(
            real_images(batch.images), batch.index, batch.weight, real_raster(batch.raster_prior)
        )
        self.assertEqual(
            [tuple(output.shape) for output in outputs],
            [(2, 16, 100, 50), (2, 16, 100, 50), (2, 3, 400, 200), (2, 3, 400, 200)],
        )

    @torch.no_grad()
    def test_gather_reads_its_own_sample_row_major(self):
        features = torch.arange(2 * 6 * 3 * 480.0).reshape(12, 3, 12, 40)
        index = torch.randint(0, 2880, (2, 8, 5000))
        weight = torch.rand(2, 8, 5000)
        bev = gather_views(features, index, weight)
        for sample, cell in ((0, 0), (0, 4999), (1, 77)):
            flat = features[sample * 6 : sample * 6 + 6].permute(1, 0, 2, 3).reshape(3, 2880)
            expected = (flat[:, index[sample, :, cell]] * weight[sample, :, cell]).sum(1)
            found = bev[sample, :, cell // 50, cell % 50]
            torch.testing.assert_close(found, expected, rtol=1e-4, atol=1e-2)


class TemporaryRuns(unittest.TestCase):
    def folder(self) -> str:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return folder.name


class Resuming(TemporaryRuns):
    def test_a_stopped_run_ends_with_the_weights_of_an_uninterrupted_one(self):
        parts = self.folder()
        uninterrupted = trainer(self.folder())
        self.assertTrue(uninterrupted.run())
        stopped = trainer(parts, stop_after_minutes=1e-9)
        self.assertFalse(stopped.run())
        self.assertEqual(stopped.step, 1)
        resumed = trainer(parts, resume=True)
        self.assertEqual(resumed.samples, 2)
        self.assertTrue(resumed.run())
        self.assertTrue(torch.equal(weights(resumed.net), weights(uninterrupted.net)))
        self.assertTrue(torch.equal(weights(resumed.average), weights(uninterrupted.average)))

    def samples_of(self, table: Path) -> list[int]:
        with table.open(newline="") as file:
            return [int(row["samples"]) for row in csv.DictReader(file)]

    def test_a_run_that_was_killed_repeats_no_row(self):
        folder = self.folder()
        curves, validation = (Path(folder) / name for name in TABLES)
        with redirect_stdout(io.StringIO()):
            trainer(folder, log_steps=1, stop_after_minutes=1e-9).run()
            # What the run wrote after its last checkpoint.
            losses = curves.read_text().splitlines()[-1].split(",")[2:]
            curves.write_text(curves.read_text() + ",".join(["2", "4", *losses]) + "\n")
            for samples in (2, 4):
                append_row(validation, {"samples": samples, "joint_x_mae": 0.5})
            trainer(folder, log_steps=1, resume=True).run()
        self.assertEqual(self.samples_of(curves), [2, 4, 6, 8])
        self.assertEqual(self.samples_of(validation), [2])

    def dropout(self, folder: str, **options: Any) -> list[float]:
        """What each step of a run draws where the network drops values."""
        run = trainer(folder, samples=4, **options)
        drawn: list[float] = []
        run.net.register_forward_pre_hook(lambda *_: drawn.append(torch.rand(1).item()))
        run.run()
        return drawn

    def test_a_resumed_run_drops_the_values_of_an_uninterrupted_one(self):
        uninterrupted = self.dropout(self.folder())
        self.assertEqual(len(set(uninterrupted)), 2)
        parts = self.folder()
        drawn = self.dropout(parts, stop_after_minutes=1e-9) + self.dropout(parts, resume=True)
        self.assertEqual(drawn, uninterrupted)

    def test_steps_and_processes_have_their_own_noise(self):
        config = TrainingConfig()
        seeds = {noise_seed(config, step, rank) % 2**32 for step in range(100) for rank in range(8)}
        self.assertEqual(len(seeds), 800)

    def test_a_run_replaces_no_other_run(self):
        run = self.folder()
        trainer(run).save()
        with self.assertRaisesRegex(TrainingError, "found a run, wanted --resume"):
            trainer(run)

    def test_a_new_run_begins_with_the_averaged_weights_of_another(self):
        finished = trainer(self.folder(), samples=4)
        finished.run()
        begun = trainer(self.folder(), init=str(finished.checkpoint_path))
        self.assertTrue(torch.equal(weights(begun.net), weights(finished.average)))
        self.assertTrue(torch.equal(weights(begun.average), weights(finished.average)))
        self.assertEqual(begun.samples, 0)

    def test_unsuitable_checkpoints_are_refused(self):
        run = self.folder()
        trainer(run).save()
        checkpoint = Path(run) / "checkpoint.pt"
        with self.assertRaisesRegex(CheckpointError, "holds the network 'nano', wanted 'small'"):
            trainer(run, resume=True, network="small")
        state = torch.load(checkpoint)
        torch.save({**state, "optimiser": {}}, checkpoint)
        with self.assertRaisesRegex(CheckpointError, "the run cannot be resumed"):
            trainer(run, resume=True)
        checkpoint.write_text("not a checkpoint")
        with self.assertRaisesRegex(CheckpointError, f"^{checkpoint}: unreadable"):
            trainer(self.folder(), init=str(checkpoint))


class LearningRate(TemporaryRuns):
    def test_falls_from_a_share_of_the_budget_on(self):
        run = trainer(self.folder(), anneal_from=0.5, warm_up_steps=0)
        start, end = (run.config.learning_rate * factor for factor in (1.0, run.config.final_rate))
        for spent, wanted in ((0.0, start), (0.5, start), (0.75, (start + end) / 2), (1.0, end)):
            self.assertAlmostEqual(learning_rate(run.config, run.step, spent), wanted)

    def test_need_not_fall_nor_warm_up(self):
        run = trainer(self.folder(), anneal_from=1.0, warm_up_steps=0)
        for spent in (0.0, 0.5, 1.0):
            found = learning_rate(run.config, run.step, spent)
            self.assertEqual(found, run.config.learning_rate)


class Networks(TemporaryRuns):
    def test_another_network_trains_and_its_checkpoint_remembers_it(self):
        run = self.folder()
        small = trainer(run, network="small", samples=2, semantic_stage=0.0, precision="bfloat16")
        before = weights(small.net)
        self.assertTrue(small.run())
        self.assertFalse(torch.equal(weights(small.net), before))
        self.assertTrue(weights(small.net).isfinite().all())
        self.assertEqual(trainer(run, network="small", resume=True).step, 1)


class NotFinite(TemporaryRuns):
    def test_a_nan_loss_ends_the_run_and_keeps_the_checkpoint(self):
        run = trainer(self.folder(), semantic_stage=0.0)
        run.train_step(0.5)
        run.save()
        kept = run.checkpoint_path.read_bytes()

        def poisoned(count: int) -> Batch:
            batch = SyntheticStream(2).next(count)
            batch.weight[0] = math.nan
            return batch

        message = "step 1: the loss perceived.* is not finite on samples 2 to 3 .* holds the last"
        with patch.object(run.stream, "next", poisoned):
            with self.assertRaisesRegex(NotFiniteError, message):
                run.run()
        self.assertEqual(run.checkpoint_path.read_bytes(), kept)

    def test_an_infinite_gradient_ends_the_run_before_a_weight_changes(self):
        run = trainer(self.folder())
        before = [p.detach().clone() for p in run.net.parameters()]
        bias = bias_of(run.net.head.second)
        bias.register_hook(lambda gradient: gradient * math.inf)
        with self.assertRaisesRegex(NotFiniteError, "the gradient, .* there is no checkpoint yet"):
            run.run()
        for old, new in zip(before, run.net.parameters()):
            self.assertTrue(torch.equal(old, new))

    def test_a_nan_weight_is_not_saved(self):
        run = trainer(self.folder())
        nn.init.constant_(bias_of(run.net.head.second), math.nan)
        with self.assertRaisesRegex(NotFiniteError, "head.second.bias is not finite"):
            run.save()
        self.assertFalse(run.checkpoint_path.exists())

    def test_a_nan_weight_is_not_measured(self):
        run = trainer(self.folder(), [SyntheticStream(0).next(1)])
        nn.init.constant_(bias_of(run.net.head.second), math.nan)
        with self.assertRaisesRegex(NotFiniteError, "head.second.bias is not finite"):
            run.validate()


class EarlyStop(TemporaryRuns):
    def run_with(self, folder: str, figures: list[float], **options: Any) -> Trainer:
        """A run that validates after every step, with these figures as results."""
        options = {"patience": 2, "samples": 20, "validation_minutes": 1e-9} | options
        run = trainer(folder, [SyntheticStream(0).next(1)], **options)
        metrics = [{"joint_x_mae": figure} for figure in figures]
        with patch("training.train.evaluate", side_effect=metrics), patch(
            "training.train.summary", return_value=""
        ), redirect_stdout(io.StringIO()):
            self.assertTrue(run.run())
        return run

    def test_a_run_stops_when_it_no_longer_improves(self):
        folder = self.folder()
        run = self.run_with(folder, [0.5, 0.4, 0.45, 0.4])
        self.assertEqual(run.step, 4)
        self.assertRegex(str(run.patience), r"mae was best \(0.4000\) after 4 samples, 2 val")
        resumed = self.run_with(folder, [], resume=True)
        self.assertEqual(resumed.step, 4)
        patient = self.run_with(folder, [0.5], resume=True, patience=3)
        self.assertEqual(patient.step, 5)

    def test_a_run_in_parts_counts_the_last_validation_of_each(self):
        folder, validation = self.folder(), [SyntheticStream(0).next(1)]
        # Each part trains one step and validates only at its end.
        options: dict[str, Any] = {"validation_minutes": 1e9, "stop_after_minutes": 1e-9}
        for step, (figure, finished) in enumerate(((0.5, False), (0.6, False), (0.6, True)), 1):
            run = trainer(folder, validation, patience=2, samples=20, resume=True, **options)
            with patch("training.train.evaluate", return_value={"joint_x_mae": figure}), patch(
                "training.train.summary", return_value=""
            ), redirect_stdout(io.StringIO()):
                self.assertEqual(run.run(), finished)
            self.assertEqual(run.step, step)

    def test_a_finished_run_measures_its_last_weights_once(self):
        run = trainer(self.folder(), [SyntheticStream(0).next(1)], samples=4)
        with patch.object(run, "_measure") as measure:
            self.assertTrue(run.run())
        measure.assert_called_once()

    def test_a_figure_that_is_not_measured_is_refused(self):
        validation = [SyntheticStream(0).next(1)]
        with self.assertRaisesRegex(TrainingError, "'joint_x', wanted one of .*iou_crossing"):
            trainer(self.folder(), validation, patience=1, patience_figure="joint_x")
        with self.assertRaisesRegex(TrainingError, "validation set"):
            trainer(self.folder(), patience=1)


class Log(TemporaryRuns):
    def test_a_line_has_the_rate_and_the_time_spent_waiting(self):
        run = trainer(self.folder(), samples=2, log_steps=1)
        lines = io.StringIO()
        with redirect_stdout(lines):
            run.run()
        self.assertRegex(
            lines.getvalue(), r"^step 1 samples 2 [\d.]+/s \(\d+ % waiting for samples\) left"
        )


if __name__ == "__main__":
    unittest.main()
