"""The view transform of `nano`: a weighted gather by the view table, without learned weights."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.models.config import VIEW_COLS, VIEW_ROWS, VIEW_SLOTS


def gather_views(features: Tensor, index: Tensor, weight: Tensor) -> Tensor:
    """features [batch * 6, width, *grid], index and weight [batch, 8, 5000] -> the sum over slots
    of weight * feature, [batch, width, 100, 50]."""
    batch, channels = index.shape[0], features.shape[1]
    table = features.permute(0, 2, 3, 1).reshape(-1, channels).float()
    image_cells = len(table) // batch
    offset = torch.arange(batch, device=index.device)[:, None, None] * image_cells
    keys = (index + offset).permute(0, 2, 1).reshape(-1, VIEW_SLOTS)
    weights = weight.permute(0, 2, 1).reshape(-1, VIEW_SLOTS)
    bev = F.embedding_bag(keys, table, per_sample_weights=weights, mode="sum")
    return bev.reshape(batch, VIEW_ROWS, VIEW_COLS, channels).permute(0, 3, 1, 2)


class LutView(nn.Module):
    """The view transform "lut"."""

    def forward(self, features: Tensor, index: Tensor, weight: Tensor) -> Tensor:
        return gather_views(features, index, weight)
