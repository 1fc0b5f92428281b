"""Batches from the simulator and from recorded drives (training/sampler_process.py)."""

from __future__ import annotations

import atexit
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from training.distributed import WHOLE, Share
from training.model import BEV_COLS, BEV_ROWS, CAMERAS, VIEW_SLOTS
from training.native import address, library
from training.sampler_process import (
    RECORD,
    DriveOptions,
    Drives,
    SamplerError,
    SamplerOptions,
    SamplerProcess,
)

NUISANCES = ("usual", "strong", "street")


@dataclass
class Batch:
    """Samples as described in training/native/sample_record.h, each with its view table."""

    images: Tensor  # uint8 [n, 6, 3, 96, 320]
    camera_mask: Tensor  # uint8 [n]
    raster_prior: Tensor  # uint8 [n, 3, 400, 200]
    raster_truth: Tensor  # uint8 [n, 3, 400, 200]
    correction: Tensor  # float [n, 3]
    index: Tensor  # int64 [n, 8, 5000]
    weight: Tensor  # float [n, 8, 5000]

    def to(self, device: torch.device) -> Batch:
        return Batch(**{name: tensor.to(device) for name, tensor in vars(self).items()})

    @staticmethod
    def joined(batches: list[Batch]) -> Batch:
        names = vars(batches[0])
        return Batch(**{name: torch.cat([vars(b)[name] for b in batches]) for name in names})

    def with_cameras(self) -> Batch:
        """Those of the samples that have a camera (DriveOptions.blank_bad)."""
        seen = self.camera_mask > 0
        return Batch(**{name: tensor[seen] for name, tensor in vars(self).items()})

    def __len__(self) -> int:
        return self.images.shape[0]


class Stream(Protocol):
    """A source of batches. The order of its samples depends only on how it was started."""

    def next(self, count: int) -> Batch: ...

    def close(self) -> None: ...


@lru_cache(maxsize=64)
def view_table(camera_mask: int) -> tuple[Tensor, Tensor]:
    """The view table, index int64 [8, 5000] and weight float [8, 5000], of the cameras in the mask
    on the simulator's own rig when all expose at the same time."""
    index = np.empty((VIEW_SLOTS, BEV_ROWS * BEV_COLS), np.int32)
    weight = np.empty((VIEW_SLOTS, BEV_ROWS * BEV_COLS), np.float32)
    library().bevloc_view_table(camera_mask, address(index), address(weight))
    return torch.from_numpy(index.astype(np.int64)), torch.from_numpy(weight)


class ProcessStream:
    """A stream whose samples come from several programs in turn."""

    def __init__(self, options: list[SamplerOptions] | list[DriveOptions], position: int) -> None:
        """`position`: the number of this process's first sample; sample i comes from program
        i % len(options). SamplerError if a program refuses its options."""
        assert options
        self._position = position
        self._samplers: list[SamplerProcess] = []
        atexit.register(self.close)  # the programs must not outlive the interpreter
        try:
            for option in options:
                self._samplers.append(SamplerProcess(option))
        except SamplerError:
            self.close()
            raise

    def next(self, count: int) -> Batch:
        """The next `count` samples, grouped by program."""
        turns = len(self._samplers)
        records = np.empty(count, RECORD)
        filled = 0
        for k, sampler in enumerate(self._samplers):
            own = len(range((k - self._position) % turns, count, turns))
            sampler.read(records[filled : filled + own])
            filled += own
        self._position += count
        return _batch_of(records)

    def close(self) -> None:
        for sampler in self._samplers:
            sampler.close()
        self._samplers = []
        atexit.unregister(self.close)


class SamplerStream(ProcessStream):
    """An endless stream of simulated samples. Workers render ahead while the network trains.

    Consecutive samples of one sampler share a world. To mix worlds within a batch, STREAMS
    samplers with distant seeds take turns: sample i comes from sampler i % STREAMS. With several
    processes the number of samplers is the least common multiple of STREAMS and the number of
    processes, and each process runs an equal share of them."""

    STREAMS = 4
    SEED_STRIDE = 2**28

    def __init__(
        self,
        first_seed: int,
        first_sample: int,
        threads: int,
        drop_camera_probability: float,
        share: Share = WHOLE,
        nuisances: str = "usual",
        photos: str = "",
    ) -> None:
        """`first_sample` counts the samples of all processes and is a multiple of their number.
        `nuisances`: one of NUISANCES, else ValueError. `photos`: a folder of script/photos, whose
        photographs cover surfaces; empty: the simulator's own textures."""
        if nuisances not in NUISANCES:
            raise ValueError(
                f"nuisances: found '{nuisances}', wanted one of {', '.join(NUISANCES)}"
            )
        assert first_sample % share.count == 0
        first_sample //= share.count
        own = range(share.index, math.lcm(self.STREAMS, share.count), share.count)
        options = [
            SamplerOptions(
                first_seed=first_seed + sampler * self.SEED_STRIDE,
                first_sample=(first_sample + len(own) - 1 - k) // len(own),
                threads=threads,
                drop_camera_probability=drop_camera_probability,
                nuisances=nuisances,
                photos=photos,
            )
            for k, sampler in enumerate(own)
        ]
        super().__init__(options, first_sample)


class DriveStream(ProcessStream):
    """An endless stream of samples of recorded drives: each sample once, then all again in another
    order and with other priors. `threads` programs read them."""

    def __init__(
        self,
        drives: Drives,
        part: str,
        first_seed: int,
        first_sample: int,
        threads: int,
        drop_camera_probability: float,
        share: Share = WHOLE,
        blank_bad: bool = False,
    ) -> None:
        """`part`: training, calibration or held-back. `first_sample` counts the samples of all
        processes and is a multiple of their number. `blank_bad`: as of DriveOptions."""
        assert first_sample % share.count == 0
        first_sample //= share.count
        options = [
            DriveOptions(
                drives=drives,
                first_seed=first_seed,
                # The first sample of this program that is not before `first_sample`.
                first_sample=share.index
                + share.count * (first_sample + (program - first_sample) % threads),
                stride=share.count * threads,
                part=part,
                drop_camera_probability=drop_camera_probability,
                blank_bad=blank_bad,
            )
            for program in range(threads)
        ]
        super().__init__(options, first_sample)


class MixedStream:
    """Takes `second_share` of the samples from the second stream and the others from the first."""

    def __init__(self, first: Stream, second: Stream, second_share: float, position: int) -> None:
        """`position`: the number of this process's samples before the first one. Each stream must
        start after its own part of these samples (taken())."""
        self._streams = (first, second)
        self._share = second_share
        self._position = position

    @staticmethod
    def taken(position: int, second_share: float) -> int:
        """How many of the first `position` samples are from the second stream."""
        return math.floor(position * second_share + 1e-9)

    def next(self, count: int) -> Batch:
        before = self.taken(self._position, self._share)
        self._position += count
        second = self.taken(self._position, self._share) - before
        counts = (count - second, second)
        return Batch.joined([s.next(n) for s, n in zip(self._streams, counts) if n > 0])

    def close(self) -> None:
        for stream in self._streams:
            stream.close()


def _batch_of(records: np.ndarray) -> Batch:
    """A batch from records of a sampler."""
    assert records.dtype == RECORD

    def tensor(name: str) -> Tensor:
        return torch.from_numpy(np.ascontiguousarray(records[name]))

    return Batch(
        images=tensor("images"),
        camera_mask=torch.from_numpy(records["camera_mask"].astype(np.uint8)),
        raster_prior=tensor("raster_prior"),
        raster_truth=tensor("raster_truth"),
        correction=tensor("correction"),
        index=tensor("index").long(),
        weight=tensor("weight"),
    )


def augment(images: Tensor, generator: torch.Generator) -> Tensor:
    """Applies a random gain and offset per camera to real-valued images. Everything else is varied
    by the renderer."""
    shape = (images.shape[0], CAMERAS, 1, 1, 1)
    gain = torch.empty(shape).uniform_(0.85, 1.15, generator=generator)
    offset = torch.empty(shape).uniform_(-0.12, 0.12, generator=generator)
    return images * gain.to(images) + offset.to(images)
