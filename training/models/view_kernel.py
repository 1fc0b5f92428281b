"""Geometry-guided kernel attention (after GKT, Chen et al. 2022): each BEV cell attends to the
image cells around its projection, in at most two cameras."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from training.models.config import (
    CAMERAS,
    VIEW_CELL_M,
    VIEW_COLS,
    VIEW_ROWS,
    VIEW_SLOTS,
    ModelConfig,
)
from training.models.layers import cell_centres, sine_encoding

_NEIGHBOURS = 4
_CAMERAS_PER_CELL = VIEW_SLOTS // _NEIGHBOURS
_OFFSET_TERMS = 5


@dataclass
class Kernel:
    """The keys of each BEV cell, [batch, 5000, 2 cameras * size * size]."""

    key: Tensor  # int64 index into the features of all six cameras of one sample
    offset: Tensor  # [..., 2]: rows and columns from the projection to the key
    log_share: Tensor  # logarithm of the camera's share of the cell; -inf: no key


def kernel_of_table(index: Tensor, weight: Tensor, grid: tuple[int, int], size: int) -> Kernel:
    """The keys of a view table, index and weight [batch, 8, 5000]. The projection of a cell is the
    weighted centre of its bilinear neighbours; a camera's share is the sum of their weights."""
    rows, cols = grid
    split = (_CAMERAS_PER_CELL, _NEIGHBOURS)
    index = index.unflatten(1, split).permute(0, 3, 1, 2)  # [batch, 5000, 2, 4]
    weight = weight.unflatten(1, split).permute(0, 3, 1, 2).float()
    share = weight.sum(-1)
    camera = torch.div(index[..., 0], rows * cols, rounding_mode="floor")
    cell = index % (rows * cols)
    row_col = torch.stack((torch.div(cell, cols, rounding_mode="floor"), cell % cols), dim=-1)
    projection = (weight[..., None] * row_col).sum(-2) / share.clamp(min=1e-6)[..., None]

    reach = torch.arange(size, device=index.device) - size // 2
    steps = torch.stack(torch.meshgrid(reach, reach, indexing="ij"), dim=-1).reshape(-1, 2)
    key = torch.round(projection).long()[..., None, :] + steps  # [batch, 5000, 2, keys, 2]
    inside = ((key >= 0) & (key < key.new_tensor(grid))).all(-1)
    row, col = key[..., 0].clamp(0, rows - 1), key[..., 1].clamp(0, cols - 1)
    log_share = torch.where(inside, share.log()[..., None], -math.inf)
    return Kernel(
        key=((camera[..., None] * rows + row) * cols + col).flatten(2),
        offset=(key - projection[..., None, :]).flatten(2, 3),
        log_share=log_share.flatten(2),
    )


class KernelView(nn.Module):
    """The view transform "kernel": softmax over the keys of
    (query . (key + encoded offset) / sqrt(d) + log(share of the camera)).

    The share fades a camera in and out near its image border, as in the view table. The query
    depends only on the cell's position, so a runtime can store it as a constant. The offset is
    encoded by its first and second powers, from which a query can form any Gaussian window."""

    position: Tensor

    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        self.grid = config.feature_grid
        self.size = config.kernel_size
        self.heads = config.heads
        width = config.width
        self.query = nn.Linear(width, width)
        self.key = nn.Linear(width, width, bias=False)
        self.value = nn.Linear(width, width)
        self.offset = nn.Linear(_OFFSET_TERMS, width, bias=False)
        self.output = nn.Linear(width, width)
        position = cell_centres(VIEW_ROWS, VIEW_COLS, (VIEW_CELL_M, VIEW_CELL_M))
        encoding = sine_encoding(*position, width).flatten(0, 1)
        self.register_buffer("position", encoding, persistent=False)

    def forward(self, features: Tensor, index: Tensor, weight: Tensor) -> Tensor:
        """features [batch * 6, width, *grid], index and weight [batch, 8, 5000] ->
        [batch, width, 100, 50]; zero in cells that no camera sees."""
        kernel = kernel_of_table(index, weight, self.grid, self.size)
        tokens = features.flatten(2).transpose(1, 2)  # [batch * 6, cells, width]
        tokens = tokens.unflatten(0, (-1, CAMERAS)).flatten(1, 2)
        query = self._split(self.query(self.position))
        key = self._split(self._gather(self.key(tokens), kernel.key) + self._encode(kernel.offset))
        value = self._split(self._gather(self.value(tokens), kernel.key))

        logits = torch.einsum("chd,bckhd->bckh", query, key).float() / math.sqrt(query.shape[-1])
        seen = kernel.log_share.isfinite().any(2)  # [batch, 5000]
        # In cells without any key, zeros keep softmax from returning NaN.
        log_share = torch.where(seen[..., None], kernel.log_share, 0.0)
        attention = torch.softmax(logits + log_share[..., None], dim=2).to(value.dtype)
        mixed = torch.einsum("bckh,bckhd->bchd", attention, value).flatten(2)
        bev = self.output(mixed) * seen[..., None]
        return bev.transpose(1, 2).unflatten(2, (VIEW_ROWS, VIEW_COLS))

    def _split(self, x: Tensor) -> Tensor:
        return x.unflatten(-1, (self.heads, -1))

    def _gather(self, tokens: Tensor, key: Tensor) -> Tensor:
        """tokens [batch, n, width], key [batch, 5000, keys] -> [batch, 5000, keys, width]."""
        chosen = key.flatten(1)[..., None].expand(-1, -1, tokens.shape[2])
        return tokens.gather(1, chosen).unflatten(1, key.shape[1:])

    def _encode(self, offset: Tensor) -> Tensor:
        row, col = offset.unbind(-1)
        terms = (row, col, row * row, row * col, col * col)
        return self.offset(torch.stack(terms, dim=-1))
