"""The pseudo-random inputs of the test models, equal to those of ../model_inputs.h."""

from __future__ import annotations

import numpy as np

from tests.pipeline.network.fixture_models.arithmetic import Array

SLOTS = 8


def hashed(count: int, seed: int) -> Array:
    mask = np.uint64(0xFFFFFFFF)
    x = (np.arange(count, dtype=np.uint64) * 2654435761 + np.uint64(seed * 40503)) & mask
    x ^= x >> np.uint64(15)
    x = (x * np.uint64(2246822519)) & mask
    return x ^ (x >> np.uint64(13))


def input_bytes(count: int, seed: int) -> Array:
    return (hashed(count, seed) >> np.uint64(24)).astype(np.int64)


def view_table(cells: int, keys: int) -> tuple[Array, Array]:
    """Index and weight [SLOTS, cells]. 1/5 of the weights, and those of the last cell, are zero."""
    h = hashed(SLOTS * cells, 77)
    weight = np.where(h % 5 == 0, 0, (h >> np.uint64(8)) & np.uint64(127)) / 1024.0
    weight = weight.reshape(SLOTS, cells)
    weight[:, -1] = 0.0
    return (h % np.uint64(keys)).astype(np.int64).reshape(SLOTS, cells), weight
