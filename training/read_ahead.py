"""Reads the next batch of a stream while the network trains on the last one."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor

import torch

from training.data import Batch, Stream


class ReadAhead:
    """A Stream whose batches all have the same size and lie on `device`.

    A thread reads the next batch and copies it to the device, so that a GPU does not wait for
    either. The samples and their order are those of `stream`."""

    def __init__(self, stream: Stream, device: torch.device) -> None:
        self._stream = stream
        self._device = device
        self._thread = ThreadPoolExecutor(max_workers=1)
        self._ahead: Future[Batch] | None = None
        self._count = 0

    def next(self, count: int) -> Batch:
        """Blocks until the batch is read. Raises what the stream raised while it was read."""
        assert self._ahead is None or count == self._count
        self._count = count
        batch = (self._ahead or self._read()).result()
        self._ahead = self._read()
        return batch

    def _read(self) -> Future[Batch]:
        return self._thread.submit(lambda: self._stream.next(self._count).to(self._device))

    def close(self) -> None:
        """Waits for the batch that is being read, and closes the stream."""
        if self._ahead is not None:
            self._ahead.exception()  # waits; the batch or its error is not needed any more
        self._thread.shutdown()
        self._stream.close()
