"""Tests which samples a run reads."""

from __future__ import annotations

import contextlib
import io
import shutil
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import torch

from tests.training.nuscenes_tree import SAMPLES_PER_SCENE, VERSION, write_tree
from tests.training.untrained import untrained_network
from tooling.errors import run_program
from training import evaluate
from training.checkpoint import state_of_weights
from training.config import FIRST_VALIDATION_SEED, TrainingConfig
from training.data import NUISANCES, Batch
from training.distributed import WHOLE, Share
from training.errors import TrainingError
from training.nuscenes.errors import NuscenesError
from training.sources import (
    nuscenes_batches,
    simulator_batches,
    training_stream,
    validation_set,
)

SCENES = 2


class Sources(unittest.TestCase):
    root: Path

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = Path(folder.name)
        write_tree(cls.root)

    def test_nuscenes_replaces_the_simulator(self):
        config = TrainingConfig(nuscenes=str(self.root), drop_camera_probability=0.0)
        stream = training_stream(config, 0)
        first, second = stream.next(2), stream.next(2)
        stream.close()
        resumed = training_stream(config, 2)
        self.assertTrue(torch.equal(resumed.next(2).raster_prior, second.raster_prior))
        resumed.close()
        simulated = training_stream(TrainingConfig(), 0)
        for name, tensor in vars(simulated.next(2)).items():
            found = getattr(first, name)
            self.assertEqual((found.shape, found.dtype), (tensor.shape, tensor.dtype), name)
        simulated.close()

    def test_processes_share_the_samples_of_nuscenes(self):
        config = TrainingConfig(nuscenes=str(self.root), drop_camera_probability=0.0)

        def corrections(share: Share, count: int) -> torch.Tensor:
            stream = training_stream(config, 2, share)
            found = stream.next(count).correction
            stream.close()
            return found

        parts = [corrections(Share(rank, 2), 2) for rank in (0, 1)]
        self.assertTrue(torch.equal(torch.stack(parts, 1).flatten(0, 1), corrections(WHOLE, 4)))

    def test_evaluation_reads_every_sample_once(self):
        batches = list(nuscenes_batches(str(self.root), "", 5.0, 1))
        self.assertEqual(sum(map(len, batches)), SCENES * SAMPLES_PER_SCENE)
        rasters = torch.cat([batch.raster_truth for batch in batches]).flatten(1)
        self.assertEqual(len(rasters.unique(dim=0)), SCENES * SAMPLES_PER_SCENE)

    def test_evaluation_draws_lines_as_wide_as_in_training(self):
        checkpoint = self.root / "checkpoint.pt"
        weights = untrained_network().state_dict()
        wide = {"line_width_cells": 8.0}
        cases: list[tuple[dict[str, float], list[str], float]] = [
            (wide, [], 8.0),
            (wide, ["--line-width-cells", "5"], 5.0),
            ({}, [], 5.0),  # an old checkpoint
        ]
        for config, options, width in cases:
            torch.save(state_of_weights(weights, config), checkpoint)
            arguments = ["evaluate", str(checkpoint), "--nuscenes", "tree", *options]
            with patch("sys.argv", arguments), patch("training.evaluate.evaluate"), \
                    patch("training.evaluate.summary", return_value=""), \
                    patch("training.evaluate.nuscenes_batches") as read, \
                    contextlib.redirect_stdout(io.StringIO()):
                evaluate.main()
            read.assert_called_once_with("tree", "", width, 1, "")

    def test_evaluation_reads_the_named_version(self):
        with tempfile.TemporaryDirectory() as folder:
            write_tree(Path(folder))
            shutil.copytree(Path(folder) / VERSION, Path(folder) / "v1.0-other")
            with self.assertRaisesRegex(NuscenesError, "v1.0-other, wanted one folder"):
                nuscenes_batches(folder, "", 5.0, 1)
            batches = list(nuscenes_batches(folder, "", 5.0, 1, "v1.0-other"))
        self.assertEqual(sum(map(len, batches)), SCENES * SAMPLES_PER_SCENE)

    def test_a_bad_data_set_ends_a_program_with_one_line(self):
        def main() -> None:
            nuscenes_batches(str(self.root / "nowhere"), "", 5.0, 1)

        with self.assertRaisesRegex(SystemExit, "nowhere: found nothing, wanted one folder"):
            run_program(main)

    def test_validation_does_not_read_training_scenes_by_default(self):
        self.assertEqual(validation_set(TrainingConfig(nuscenes=str(self.root))), [])
        simulated = validation_set(TrainingConfig(validation_samples=3))[0].images
        expected = simulator_batches(3, 1, FIRST_VALIDATION_SEED)[0].images
        self.assertTrue(torch.equal(simulated, expected))

    def test_validation_does_not_read_the_scenes_of_the_model_card(self):
        simulated = validation_set(TrainingConfig(validation_samples=3))[0].images
        card = simulator_batches(3, 1)[0].images
        for mine in simulated:
            self.assertFalse(any(torch.equal(mine, other) for other in card))

    def test_a_scene_is_trained_on_or_measured(self):
        (self.root / "train.txt").write_text("scene-0001\nscene-0002\n")
        (self.root / "val.txt").write_text("scene-0002  # again\n")
        config = TrainingConfig(
            nuscenes=str(self.root),
            scenes=str(self.root / "train.txt"),
            validation_scenes=str(self.root / "val.txt"),
        )
        with self.assertRaisesRegex(TrainingError, "val.txt: found scene-0002, wanted no scene of"):
            validation_set(config)

    def test_training_has_stronger_nuisances_than_validation(self):
        streams = {
            name: training_stream(TrainingConfig(nuisances=name), 0) for name in NUISANCES
        }
        usual, strong, street = (stream.next(16) for stream in streams.values())
        for stream in streams.values():
            stream.close()
        self.assertEqual(TrainingConfig().nuisances, "street")
        self.assertTrue(torch.equal(usual.correction, strong.correction))
        self.assertFalse(torch.equal(usual.images, strong.images))
        self.assertFalse(torch.equal(strong.images, street.images))
        whole = [i for i, mask in enumerate(usual.camera_mask.tolist()) if mask == 63]
        self.assertEqual(len(usual.weight[whole].unique(dim=0)), 1)
        self.assertGreater(len(strong.weight[whole].unique(dim=0)), 1)

    def test_a_share_of_the_samples_has_the_usual_nuisances(self):
        mixed = TrainingConfig(nuisances="strong", usual_share=0.5, drop_camera_probability=0.0)

        def samples(config: TrainingConfig, first: int, count: int) -> Batch:
            stream = training_stream(config, first)
            self.addCleanup(stream.close)
            return stream.next(count)

        batch = samples(mixed, 0, 8)
        alone = samples(replace(mixed, usual_share=0.0), 0, 4)
        self.assertTrue(torch.equal(batch.correction[:4], alone.correction))
        # The usual samples have one view table; strong ones have cameras that are out of step.
        self.assertEqual(len(batch.weight[4:].unique(dim=0)), 1)
        resumed = samples(mixed, 4, 4)
        expected = torch.cat((batch.correction[2:4], batch.correction[6:8]))
        self.assertTrue(torch.equal(resumed.correction, expected))

    def test_unknown_nuisances_are_refused(self):
        with self.assertRaisesRegex(ValueError, "'mild', wanted one of usual, strong, street"):
            training_stream(TrainingConfig(nuisances="mild"), 0)

    def test_a_missing_folder_is_refused_by_name(self):
        with self.assertRaisesRegex(NuscenesError, "nowhere"):
            training_stream(TrainingConfig(nuscenes=str(self.root / "nowhere")), 0)


if __name__ == "__main__":
    unittest.main()
