"""Some of a grid's cells, evenly spread.

Of row r the columns skew r mod step, and every step-th from there on. The lattices below are
square, so that they miss as little along one axis as along the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class CellLattice:
    step: int = 1
    skew: int = 0

    def mask(self, rows: int, cols: int) -> Tensor:
        """Which cells of a grid belong to it, [rows, cols]."""
        row, col = torch.arange(rows)[:, None], torch.arange(cols)
        return (col - self.skew * row) % self.step == 0


EVERY_CELL = CellLattice(1, 0)
EVERY_SECOND_CELL = CellLattice(2, 1)  # one colour of a chessboard
EVERY_TENTH_CELL = CellLattice(10, 3)  # the nearest: a row and three columns away
