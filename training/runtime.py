"""Runs the daemon's own network and solvers from Python (training/native/runtime.h)."""

from __future__ import annotations

import ctypes
import weakref
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from training.data import Batch
from training.errors import TrainingError
from training.model import BEV_COLS, BEV_ROWS
from training.native import address, library
from training.solver import DEFINITION, Posterior, Solution, hypotheses

CHANNELS = 16
_ERROR_SIZE = 1000


class NativeNetwork:
    """A model file on the daemon's executor. TrainingError if the file cannot be loaded."""

    def __init__(self, model: Path, threads: int = 1) -> None:
        error = ctypes.create_string_buffer(_ERROR_SIZE)
        path = str(model).encode()
        self.handle = library().bevloc_network_create(path, threads, error, _ERROR_SIZE)
        if not self.handle:
            raise TrainingError(error.value.decode())
        weakref.finalize(self, library().bevloc_network_destroy, self.handle)

    def __call__(self, batch: Batch) -> tuple[Tensor, Tensor, Tensor]:
        """F_B, F_M and the logits of the perceived mask."""
        count = len(batch)
        bev = np.empty((count, CHANNELS, BEV_ROWS, BEV_COLS), np.float32)
        features_map = np.empty_like(bev)
        mask = np.empty(batch.raster_prior.shape, np.float32)
        images, raster = batch.images.numpy(), batch.raster_prior.numpy()
        index, weight = batch.index.int().numpy(), batch.weight.numpy()
        for i in range(count):
            inputs = (images[i], index[i], weight[i], raster[i])
            outputs = (bev[i], features_map[i], mask[i])
            library().bevloc_network_run(self.handle, *map(address, inputs + outputs))
        return torch.from_numpy(bev), torch.from_numpy(features_map), torch.from_numpy(mask)


@dataclass(frozen=True)
class NativeSolution(Solution):
    """A solution with the score of each match (pipeline/solver/solver_result.h), [batch]."""

    score: Tensor


class NativeSolver:
    """A solver of the given kind with the parameters of a model file. TrainingError for an unknown
    kind."""

    def __init__(self, network: NativeNetwork, kind: str) -> None:
        error = ctypes.create_string_buffer(_ERROR_SIZE)
        create = library().bevloc_solver_create
        self.handle = create(network.handle, kind.encode(), error, _ERROR_SIZE)
        if not self.handle:
            raise TrainingError(error.value.decode())
        weakref.finalize(self, library().bevloc_solver_destroy, self.handle)

    def __call__(self, bev: Tensor, features_map: Tensor) -> NativeSolution:
        counts = [len(hypotheses(*axis)) for axis in DEFINITION.axes()]
        correction = np.empty((len(bev), 3), np.float32)
        deviation = np.empty_like(correction)
        probabilities = np.empty((len(bev), sum(counts)), np.float32)
        score = np.empty((len(bev), 1), np.float32)
        sides = bev.contiguous().numpy(), features_map.contiguous().numpy()
        for arrays in zip(*sides, correction, deviation, probabilities, score):
            library().bevloc_solver_solve(self.handle, *map(address, arrays))
        return NativeSolution(
            torch.from_numpy(correction),
            torch.from_numpy(deviation),
            Posterior(*torch.from_numpy(probabilities).split(counts, dim=1)),
            torch.from_numpy(score[:, 0]),
        )
