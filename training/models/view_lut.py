"""The view transform of `nano`: a weighted gather by the view table, nothing learned."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.models.config import CAMERAS, VIEW_COLS, VIEW_ROWS, VIEW_SLOTS, ModelConfig


class LutView(nn.Module):
    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        rows, cols = config.feature_grid
        self.image_cells = CAMERAS * rows * cols

    def forward(self, features: Tensor, index: Tensor, weight: Tensor) -> Tensor:
        """features [batch * 6, width, *grid], index and weight [batch, 8, 5000] -> the sum over
        slots of weight * feature, [batch, width, 100, 50]."""
        batch, channels = index.shape[0], features.shape[1]
        table = features.permute(0, 2, 3, 1).reshape(batch * self.image_cells, channels).float()
        offset = torch.arange(batch, device=index.device)[:, None, None] * self.image_cells
        keys = (index + offset).permute(0, 2, 1).reshape(-1, VIEW_SLOTS)
        weights = weight.permute(0, 2, 1).reshape(-1, VIEW_SLOTS)
        bev = F.embedding_bag(keys, table, per_sample_weights=weights, mode="sum")
        return bev.reshape(batch, VIEW_ROWS, VIEW_COLS, channels).permute(0, 3, 1, 2)
