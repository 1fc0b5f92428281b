"""Tests that several processes train like one."""

import os
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import torch

from tests.training.process_of_two import BATCH, SAMPLES, regression
from tests.training.synthetic import SyntheticStream
from training.config import TrainingConfig
from training.data import SamplerStream
from training.distributed import Processes, Share
from training.errors import CheckpointError
from training.train import Trainer


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def run_two(*arguments: str) -> None:
    """Starts two processes with the variables that torchrun would set.

    Debian's torchrun needs other options with each version of PyTorch; that of 2.6 does not run.
    """
    command = [sys.executable, "-m", "tests.training.process_of_two", *arguments]
    # Addresses and the loopback interface, because a minimal machine resolves no host name.
    common = {"WORLD_SIZE": "2", "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": str(free_port())}
    common |= {"GLOO_SOCKET_IFNAME": "lo", "USE_LIBUV": "0"}
    started = [
        subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, **common, "RANK": rank, "LOCAL_RANK": rank},
        )
        for rank in ("0", "1")
    ]
    try:
        outputs = [process.communicate(timeout=240)[0] for process in started]
    finally:
        for process in started:
            process.kill()
    if any(process.returncode != 0 for process in started):
        raise AssertionError("\n".join(outputs))


class TwoProcesses(unittest.TestCase):
    run_folder: Path
    ranks: list[dict]

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.run_folder = Path(folder.name)
        run_two(folder.name)
        cls.ranks = [torch.load(cls.run_folder / f"rank{rank}.pt") for rank in (0, 1)]

    def test_both_have_the_same_weights_and_statistics(self):
        first, second = self.ranks
        for kind in ("net", "average"):
            for name, value in first[kind].items():
                self.assertTrue(torch.equal(value, second[kind][name]), f"{kind}: {name}")

    def test_every_sample_is_read_once(self):
        first, second = (state["positions"] for state in self.ranks)
        self.assertEqual(len(first), len(second))
        # The run has read one more batch ahead.
        self.assertEqual(sorted(first + second), list(range(SAMPLES + BATCH)))
        self.assertEqual(sorted(first[:2] + second[:2]), list(range(BATCH)))

    def test_the_gradient_is_that_of_one_process_with_the_whole_batch(self):
        model, inputs, targets = regression()
        torch.nn.functional.mse_loss(model(inputs), targets).backward()
        for state in self.ranks:
            for parameter, found in zip(model.parameters(), state["gradients"]):
                torch.testing.assert_close(found, parameter.grad)

    def test_the_first_process_decides(self):
        self.assertEqual([state["first_says"] for state in self.ranks], [10.0, 10.0])

    def test_only_the_first_writes_and_another_number_of_processes_cannot_resume(self):
        names = {path.name for path in self.run_folder.iterdir()}
        self.assertEqual(names, {"checkpoint.pt", "rank0.pt", "rank1.pt"})
        config = TrainingConfig(run=self.run_folder, samples=SAMPLES, resume=True)
        with self.assertRaisesRegex(CheckpointError, "2 processes, wanted one with 1"):
            Trainer(config, lambda _, first, share: SyntheticStream(first, share), [])


class Poison(unittest.TestCase):
    def test_a_nan_loss_in_one_process_stops_both(self):
        with tempfile.TemporaryDirectory() as folder:
            run_two(folder, "5")
            errors = [(Path(folder) / f"error{rank}").read_text() for rank in (0, 1)]
            self.assertFalse((Path(folder) / "checkpoint.pt").exists())
        self.assertEqual(errors[0], errors[1])
        self.assertIn("step 1: the loss perceived", errors[0])
        self.assertIn("samples 4 to 7", errors[0])


class Shares(unittest.TestCase):
    def images(self, first: int, share: Share, count: int) -> list[torch.Tensor]:
        """The images of simulated samples, one flat tensor per sample."""
        stream = SamplerStream(1_000_000, first, 1, 0.0, share)
        rows = list(stream.next(count).images.flatten(1))
        stream.close()
        return rows

    def count_of(self, sample: torch.Tensor, samples: list[torch.Tensor]) -> int:
        return sum(torch.equal(sample, other) for other in samples)

    def test_the_shares_of_a_batch_make_up_the_simulators_batch(self):
        whole = self.images(4, Share(), 4)
        parts = [sample for rank in (0, 1) for sample in self.images(4, Share(rank, 2), 2)]
        self.assertEqual([self.count_of(sample, parts) for sample in whole], [1] * 4)

    def test_three_processes_share_no_sample(self):
        parts = [sample for rank in (0, 1, 2) for sample in self.images(0, Share(rank, 3), 2)]
        self.assertEqual([self.count_of(sample, parts) for sample in parts], [1] * 6)


class Alone(unittest.TestCase):
    def test_one_process_does_not_communicate(self):
        values = torch.tensor([1.0, 2.0])
        alone = Processes()
        alone.average_([values])
        self.assertEqual(values.tolist(), [1.0, 2.0])
        self.assertEqual(alone.from_first(3.5), 3.5)
        self.assertTrue(alone.first)


if __name__ == "__main__":
    unittest.main()
