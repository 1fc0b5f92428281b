"""Evenly distributed subsets of a grid's cells.

Row r contributes column (skew * r) mod step and every step-th column after it. The lattices below
are square, so they sample both axes equally densely.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class CellLattice:
    """Every `step`-th cell of each row, starting `skew` columns further in each following row."""

    step: int = 1
    skew: int = 0

    def mask(self, rows: int, cols: int) -> Tensor:
        """The cells of a grid that belong to the lattice, bool [rows, cols]."""
        row, col = torch.arange(rows)[:, None], torch.arange(cols)
        return (col - self.skew * row) % self.step == 0

    def cells(self, rows: int, cols: int) -> tuple[Tensor, Tensor]:
        """The rows and columns of the lattice's cells, [n] each."""
        row, col = self.mask(rows, cols).nonzero().unbind(1)
        return row, col


EVERY_CELL = CellLattice(1, 0)
EVERY_SECOND_CELL = CellLattice(2, 1)  # one colour of a chessboard
EVERY_TENTH_CELL = CellLattice(10, 3)  # nearest neighbours are one row and three columns apart
