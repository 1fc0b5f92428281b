"""Batches from the simulator (training/native/sampler.h)."""

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
from training.errors import TrainingError
from training.model import (
    BEV_COLS,
    BEV_ROWS,
    CAMERAS,
    IMAGE_COLS,
    IMAGE_ROWS,
    RASTER_CHANNELS,
    VIEW_SLOTS,
)
from training.native import address, library

RASTER_ROWS, RASTER_COLS = 400, 200
NUISANCES = ("usual", "strong", "street")  # numbered as in training/native/sampler.h


@dataclass
class Batch:
    """Samples as described in training/native/sampler.h, each with its view table."""

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

    def __len__(self) -> int:
        return self.images.shape[0]


class Stream(Protocol):
    """A source of batches. The order of its samples depends only on how it was started."""

    def next(self, count: int) -> Batch: ...

    def close(self) -> None: ...


def _view_table(
    camera_mask: int, motions: np.ndarray | None, rig: np.ndarray | None
) -> tuple[Tensor, Tensor]:
    index = np.empty((VIEW_SLOTS, BEV_ROWS * BEV_COLS), np.int32)
    weight = np.empty((VIEW_SLOTS, BEV_ROWS * BEV_COLS), np.float32)
    given = (None if array is None else address(array) for array in (motions, rig))
    library().bevloc_view_table(camera_mask, address(index), address(weight), *given)
    return torch.from_numpy(index.astype(np.int64)), torch.from_numpy(weight)


@lru_cache(maxsize=64)
def view_table(camera_mask: int) -> tuple[Tensor, Tensor]:
    """The view table, index int64 [8, 5000] and weight float [8, 5000], of the cameras in the mask
    on the simulator's own rig when all expose at the same time."""
    return _view_table(camera_mask, None, None)


def sample_view_table(
    camera_mask: int, motions: np.ndarray, rig: np.ndarray | None = None
) -> tuple[Tensor, Tensor]:
    """The same for cameras whose exposures differ, motions float32 [6, 3], and for another rig,
    float32 [6, 15] (sampler.h)."""
    if rig is None and not motions.any():
        return view_table(camera_mask)
    return _view_table(camera_mask, motions, rig)


class SamplerStream:
    """An endless stream of simulated samples. Workers render ahead while the network trains.

    Consecutive samples of one native sampler share a world. To mix worlds within a batch, STREAMS
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
        self._position = first_sample
        self._samplers = [
            library().bevloc_sampler_create(
                first_seed + sampler * self.SEED_STRIDE,
                (first_sample + len(own) - 1 - k) // len(own),
                threads,
                drop_camera_probability,
                NUISANCES.index(nuisances),
                photos.encode() if photos else None,
            )
            for k, sampler in enumerate(own)
        ]
        if not all(self._samplers):
            raise TrainingError(f"--photos {photos}: cannot be read, for the reason above")
        atexit.register(self.close)  # workers must not outlive the interpreter

    def next(self, count: int) -> Batch:
        """The next `count` samples, grouped by sampler."""
        images = np.empty((count, CAMERAS, 3, IMAGE_ROWS, IMAGE_COLS), np.uint8)
        camera_mask = np.empty(count, np.uint8)
        raster_prior = np.empty((count, RASTER_CHANNELS, RASTER_ROWS, RASTER_COLS), np.uint8)
        raster_truth = np.empty_like(raster_prior)
        correction = np.empty((count, 3), np.float32)
        motions = np.empty((count, CAMERAS, 3), np.float32)
        rigs = np.empty((count, CAMERAS, 15), np.float32)
        arrays: list[np.ndarray]
        arrays = [images, camera_mask, raster_prior, raster_truth, correction, motions, rigs]
        filled = 0
        for k, sampler in enumerate(self._samplers):
            turns = len(self._samplers)
            own = len(range((k - self._position) % turns, count, turns))
            part = [array[filled : filled + own] for array in arrays]
            library().bevloc_sampler_next(sampler, own, *map(address, part))
            filled += own
        self._position += count
        tables = list(map(sample_view_table, camera_mask.tolist(), motions, rigs))
        return Batch(
            images=torch.from_numpy(images),
            camera_mask=torch.from_numpy(camera_mask),
            raster_prior=torch.from_numpy(raster_prior),
            raster_truth=torch.from_numpy(raster_truth),
            correction=torch.from_numpy(correction),
            index=torch.stack([index for index, _ in tables]),
            weight=torch.stack([weight for _, weight in tables]),
        )

    def close(self) -> None:
        for sampler in self._samplers:
            library().bevloc_sampler_destroy(sampler)
        self._samplers = []


def augment(images: Tensor, generator: torch.Generator) -> Tensor:
    """Applies a random gain and offset per camera to real-valued images. Everything else is varied
    by the renderer."""
    shape = (images.shape[0], CAMERAS, 1, 1, 1)
    gain = torch.empty(shape).uniform_(0.85, 1.15, generator=generator)
    offset = torch.empty(shape).uniform_(-0.12, 0.12, generator=generator)
    return images * gain.to(images) + offset.to(images)
