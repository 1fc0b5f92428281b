"""An endless stream of batches from nuScenes. It replaces the simulator's stream."""

from __future__ import annotations

import sys
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import fields
from functools import lru_cache

import numpy as np
import torch

from training.data import Batch
from training.distributed import WHOLE, Share
from training.nuscenes.dataset import ALL_CAMERAS, MAX_DEVIATION, NuscenesDataset, NuscenesSample
from training.nuscenes.errors import NuscenesError
from training.nuscenes.problems import Problems
from training.nuscenes.tables import CAMERA_CHANNELS

ON_ERROR = ("skip", "refuse")


class NuscenesStream:
    """Every epoch contains every sample once, in a new random order. Threads read ahead.

    The sample at a position of the stream depends only on the seed and the position. With
    `on_error` "skip", an unusable sample is replaced by the next usable one; with "refuse" it ends
    the stream."""

    def __init__(
        self,
        dataset: NuscenesDataset,
        seed: int,
        first_sample: int,
        threads: int,
        drop_camera_probability: float,
        on_error: str = "refuse",
        share: Share = WHOLE,
    ) -> None:
        if on_error not in ON_ERROR:
            raise ValueError(f"on_error: found '{on_error}', wanted one of {', '.join(ON_ERROR)}")
        if len(dataset) == 0:
            raise NuscenesError("found no sample in the scenes, wanted at least one")
        self._dataset = dataset
        self._seed = seed
        self._drop_camera_probability = drop_camera_probability
        self._skips = on_error == "skip"
        self._order = lru_cache(maxsize=4)(self._make_order)
        self._next, self._stride = first_sample + share.index, share.count
        self._workers = ThreadPoolExecutor(max(threads, 1))
        self._ahead: deque[Future[NuscenesSample]] = deque()
        self.problems = Problems()

    def next(self, count: int) -> Batch:
        """The next samples. NuscenesError if a bad sample is refused or all samples are bad."""
        while len(self._ahead) < 2 * count:  # this batch and the next one
            self._ahead.append(self._workers.submit(self._at, self._next))
            self._next += self._stride
        samples = [self._ahead.popleft().result() for _ in range(count)]
        columns = {
            field.name: np.stack([getattr(sample, field.name) for sample in samples])
            for field in fields(NuscenesSample)
        }
        return Batch(**{name: torch.from_numpy(column) for name, column in columns.items()})

    def close(self) -> None:
        self._workers.shutdown(cancel_futures=True)
        self._ahead.clear()
        if self.problems.messages:
            print(f"skipped samples: {self.problems.summary()}", file=sys.stderr, flush=True)

    def _make_order(self, epoch: int) -> np.ndarray:
        return np.random.default_rng([self._seed, 0, epoch]).permutation(len(self._dataset))

    def _at(self, position: int) -> NuscenesSample:
        random = np.random.default_rng([self._seed, 1, position])
        deviation = random.uniform(-MAX_DEVIATION, MAX_DEVIATION)
        camera_mask = self._cameras(random)
        # Two lengths of the data set contain at least one complete epoch.
        for candidate in range(position, position + 2 * len(self._dataset)):
            epoch, place = divmod(candidate, len(self._dataset))
            chosen = int(self._order(epoch)[place])
            token = self._dataset.sample_tokens[chosen]
            try:
                return self._dataset.sample(chosen, deviation, camera_mask)
            except NuscenesError as error:
                if not self._skips:
                    raise type(error)(f"sample {token}: {error}") from None
                self.problems.add(token, error)
        raise NuscenesError(f"found no good sample: {self.problems.summary()}")

    def _cameras(self, random: np.random.Generator) -> int:
        """The mask of all cameras or, with the given probability, of all but one or two. This is
        the simulator's rule."""
        if random.random() >= self._drop_camera_probability:
            return ALL_CAMERAS
        missing = random.integers(len(CAMERA_CHANNELS), size=random.integers(1, 3))
        return ALL_CAMERAS & ~sum(1 << int(camera) for camera in set(missing))
