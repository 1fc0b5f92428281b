"""The training loop on a synthetic stream."""

import tempfile
import unittest
from pathlib import Path

import torch

from tests.training.synthetic import SyntheticStream
from training.config import TrainingConfig
from training.model import Nano, gather_views, real_images, real_raster
from training.train import Trainer


def trainer(run: str, **options) -> Trainer:
    config = TrainingConfig(run=Path(run), batch=2, samples=8, warm_up_steps=2, **options)
    return Trainer(config, lambda _, first: SyntheticStream(first), [])


def weights(net: Nano) -> torch.Tensor:
    return torch.cat([value.flatten().double() for value in net.state_dict().values()])


class Shapes(unittest.TestCase):
    @torch.no_grad()
    def test_outputs(self):
        batch = SyntheticStream(0).next(2)
        outputs = Nano().eval()(
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


class Resuming(unittest.TestCase):
    def test_a_stopped_run_ends_with_the_weights_of_an_uninterrupted_one(self):
        torch.set_num_threads(1)
        with tempfile.TemporaryDirectory() as whole, tempfile.TemporaryDirectory() as parts:
            uninterrupted = trainer(whole)
            self.assertTrue(uninterrupted.run())
            stopped = trainer(parts, stop_after_minutes=1e-9)
            self.assertFalse(stopped.run())
            self.assertEqual(stopped.step, 1)
            resumed = trainer(parts, resume=True)
            self.assertEqual(resumed.samples, 2)
            self.assertTrue(resumed.run())
            self.assertTrue(torch.equal(weights(resumed.net), weights(uninterrupted.net)))
            self.assertTrue(torch.equal(weights(resumed.average), weights(uninterrupted.average)))

    def test_a_new_run_begins_with_the_averaged_weights_of_another(self):
        torch.set_num_threads(1)
        with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
            finished = trainer(first)
            finished.run()
            begun = trainer(second, init=str(finished.checkpoint_path))
            self.assertTrue(torch.equal(weights(begun.net), weights(finished.average)))
            self.assertTrue(torch.equal(weights(begun.average), weights(finished.average)))
            self.assertEqual(begun.samples, 0)


if __name__ == "__main__":
    unittest.main()
