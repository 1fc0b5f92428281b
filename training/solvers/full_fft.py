"""Full neural matching by cross-correlation: the scores of full.py with one warp and one FFT per
yaw.

For each yaw, B is F_B rotated onto the cells of F_M and a border around them that is as wide as the
largest shift. At whole shifts (m, n), K[m, n] = sum over channels and cells of
M[u, v] B[u + m, v + n]. Between whole shifts B is interpolated bilinearly. K and the sum of B over
the map's cells are linear in B, so they can be interpolated instead; the sum of B^2 follows from
sums of products of neighbouring cells. These sums give the ZNCC of every hypothesis.

With a rotation the scores differ slightly from full.py, which rotates and shifts in one
interpolation; here there are two. At yaw 0 both are equal.
"""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor

from training.solvers.definition import SolverDefinition, split_shift
from training.solvers.features import move
from training.solvers.zncc import sums_of, zncc


class _NeighbourSums:
    """Sums over channels and over the map's cells at each whole shift, [batch, row shift, column
    shift]: of B, of B^2 and of the products of neighbouring cells of B."""

    def __init__(self, frame: Tensor, rows: int, cols: int) -> None:
        def window(values: Tensor) -> Tensor:
            total = values.sum(1, keepdim=True)
            return F.avg_pool2d(total, (rows, cols), stride=1)[:, 0] * (rows * cols)

        padded = F.pad(frame, (0, 1, 0, 1))
        right, below, both = padded[..., :-1, 1:], padded[..., 1:, :-1], padded[..., 1:, 1:]
        self.value = window(frame)
        self.square = window(frame.square())
        self.next_col = window(frame * right)
        self.next_row = window(frame * below)
        self.next_both = window(frame * both)
        self.across = window(right * below)


class _Between:
    """Interpolates tables [batch, row shift, column shift] at the shifts of the hypotheses."""

    def __init__(self, definition: SolverDefinition, like: Tensor) -> None:
        x, y, _ = definition.hypotheses()
        corners, fractions = [], []
        for shifts, reach in zip((x, y), definition.shift_range):
            whole, fraction = split_shift(shifts / definition.cell_m)
            # Values beyond the last shift only occur with weight zero.
            corners.append((whole + reach, (whole + reach + 1).clamp(max=2 * reach)))
            fractions.append(fraction.to(like))
        row, col = fractions[0][:, None], fractions[1][None, :]
        self.weights = ((1 - row) * (1 - col), (1 - row) * col, row * (1 - col), row * col)
        self.corners = [(i[:, None], j[None, :]) for i in corners[0] for j in corners[1]]

    def read(self, table: Tensor) -> Tensor:
        """[batch, x, y] from a table that is linear in B."""
        return sum(w * self._at(table, at) for w, at in zip(self.weights, self.corners))

    def read_square(self, sums: _NeighbourSums) -> Tensor:
        """[batch, x, y]: the sum of (w0 B + w1 right + w2 below + w3 both)^2, the squares of the
        interpolated B."""
        w0, w1, w2, w3 = self.weights
        here, right, below, _ = self.corners
        crossed = (
            w0 * w1 * self._at(sums.next_col, here)
            + w2 * w3 * self._at(sums.next_col, below)
            + w0 * w2 * self._at(sums.next_row, here)
            + w1 * w3 * self._at(sums.next_row, right)
            + w0 * w3 * self._at(sums.next_both, here)
            + w1 * w2 * self._at(sums.across, here)
        )
        corners = zip(self.weights, self.corners)
        return sum(w.square() * self._at(sums.square, at) for w, at in corners) + 2 * crossed

    @staticmethod
    def _at(table: Tensor, corner: tuple[Tensor, Tensor]) -> Tensor:
        return table[:, corner[0], corner[1]]


def full_fft_scores(bev: Tensor, features_map: Tensor, definition: SolverDefinition) -> Tensor:
    """ZNCC of every hypothesis, [batch, yaw, x, y]."""
    rows, cols = features_map.shape[2:]
    margin = definition.shift_range
    size = (rows + 2 * margin[0], cols + 2 * margin[1])
    spectrum_map = torch.fft.rfft2(features_map, s=size).conj()
    value, square = sums_of(features_map, (1, 2, 3))
    map_sums = value[:, None, None], square[:, None, None]
    between = _Between(definition, bev)
    scores = []
    for yaw in definition.hypotheses()[2].to(bev.device):
        correction = F.pad(yaw.reshape(1, 1, 1), (2, 0)).expand(len(bev), 1, 3)
        frame = move(bev, correction, definition.cell_m, margin)[:, :, 0]
        spectrum = (torch.fft.rfft2(frame) * spectrum_map).sum(1)
        correlation = torch.fft.irfft2(spectrum, s=size)
        correlation = correlation[:, : 2 * margin[0] + 1, : 2 * margin[1] + 1]
        sums = _NeighbourSums(frame, rows, cols)
        moved_sums = between.read(sums.value), between.read_square(sums)
        product = between.read(correlation)
        scores.append(zncc(product, moved_sums, map_sums, features_map[0].numel()))
    return torch.stack(scores, dim=1)
