"""Tests that batches read ahead are those of the stream."""

import threading
import unittest

import torch

from tests.training.synthetic import SyntheticStream
from training.data import Batch
from training.errors import TrainingError
from training.read_ahead import ReadAhead

CPU = torch.device("cpu")


class BreakingStream(SyntheticStream):
    """A stream that ends with an error after two batches."""

    def __init__(self) -> None:
        super().__init__(0)
        self.batches = 0
        self.closed = False

    def next(self, count: int) -> Batch:
        self.batches += 1
        if self.batches > 2:
            raise TrainingError("no more samples")
        return super().next(count)

    def close(self) -> None:
        self.closed = True


class WaitingStream(SyntheticStream):
    """A stream that says when its second batch is asked for."""

    def __init__(self) -> None:
        super().__init__(0)
        self.second = threading.Event()

    def next(self, count: int) -> Batch:
        if self.positions:
            self.second.set()
        return super().next(count)


class ReadingAhead(unittest.TestCase):
    def test_the_batches_are_those_of_the_stream(self):
        ahead, plain = ReadAhead(SyntheticStream(5), CPU), SyntheticStream(5)
        self.addCleanup(ahead.close)
        for _ in range(3):
            found, wanted = ahead.next(2), plain.next(2)
            for name, tensor in vars(wanted).items():
                self.assertTrue(torch.equal(getattr(found, name), tensor), name)

    def test_the_next_batch_is_read_before_it_is_asked_for(self):
        stream = WaitingStream()
        ahead = ReadAhead(stream, CPU)
        self.addCleanup(ahead.close)
        ahead.next(1)
        self.assertTrue(stream.second.wait(timeout=60))

    def test_an_error_is_raised_by_the_batch_that_it_concerns(self):
        ahead = ReadAhead(BreakingStream(), CPU)
        self.addCleanup(ahead.close)
        ahead.next(1)
        ahead.next(1)
        with self.assertRaisesRegex(TrainingError, "no more samples"):
            ahead.next(1)

    def test_closing_ignores_an_error_of_a_batch_that_nobody_takes(self):
        stream = BreakingStream()
        ahead = ReadAhead(stream, CPU)
        ahead.next(1)
        ahead.next(1)
        ahead.close()
        self.assertTrue(stream.closed)


if __name__ == "__main__":
    unittest.main()
