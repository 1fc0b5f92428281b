"""BeMapNet's view transform (Qiao et al. 2023, bev_decoder/transformer.py): a DETR-like Transformer
in which BEV queries attend to all cells of all cameras. Image cells are encoded by the ground
position that they see (IPM), BEV cells by their own position, both with the same MLP.

The geometry is that of the cameras given at construction, not of the view table. The table only
tells which cameras are present (a camera that no BEV cell uses is hidden) and which BEV cells no
camera sees. Two details of BeMapNet are not copied: its encoding assumes 512 image rows although
there are 384, and it samples rows and columns from border to border instead of at cell centres."""

from __future__ import annotations

from collections.abc import Sequence

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.models.config import CAMERAS, VIEW_CELL_M, VIEW_COLS, VIEW_ROWS, ModelConfig
from training.models.layers import Attention, cell_centres, sine_encoding
from training.models.rig import Camera


class FeedForward(nn.Sequential):
    def __init__(self, width: int, hidden: int, dropout: float) -> None:
        super().__init__(
            nn.Linear(width, hidden), nn.ReLU(), nn.Dropout(dropout), nn.Linear(hidden, width)
        )


class AddNorm(nn.Module):
    """Layer normalisation after the sum, as in the original Transformer. It stays in float32 under
    autocast, because PyTorch does not support mixed types there on every device."""

    def __init__(self, width: int, dropout: float) -> None:
        super().__init__()
        self.dropout = nn.Dropout(dropout)
        self.norm = nn.LayerNorm(width)

    def forward(self, x: Tensor, change: Tensor) -> Tensor:
        return self.norm((x + self.dropout(change)).float())


class EncoderLayer(nn.Module):
    """Image cells attend to one another."""

    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        width, dropout = config.width, config.dropout
        self.attention = Attention(width, config.heads, dropout)
        self.attended = AddNorm(width, dropout)
        self.feedforward = FeedForward(width, config.feedforward_width, dropout)
        self.fed = AddNorm(width, dropout)

    def forward(self, tokens: Tensor, position: Tensor, hidden: Tensor) -> Tensor:
        placed = tokens + position
        tokens = self.attended(tokens, self.attention(placed, placed, tokens, hidden))
        return self.fed(tokens, self.feedforward(tokens))


class DecoderLayer(nn.Module):
    """BEV queries attend to one another, then to the image cells."""

    def __init__(self, config: ModelConfig) -> None:
        super().__init__()
        width, dropout = config.width, config.dropout
        self.own = Attention(width, config.heads, dropout)
        self.own_attended = AddNorm(width, dropout)
        self.cross = Attention(width, config.heads, dropout)
        self.cross_attended = AddNorm(width, dropout)
        self.feedforward = FeedForward(width, config.feedforward_width, dropout)
        self.fed = AddNorm(width, dropout)

    def forward(
        self, bev: Tensor, bev_position: Tensor, tokens: Tensor, position: Tensor, hidden: Tensor
    ) -> Tensor:
        placed = bev + bev_position
        bev = self.own_attended(bev, self.own(placed, placed, bev))
        seen = self.cross(bev + bev_position, tokens + position, tokens, hidden)
        bev = self.cross_attended(bev, seen)
        return self.fed(bev, self.feedforward(bev))


class DenseView(nn.Module):
    """The view transform "dense"."""

    bev_encoding: Tensor
    image_encoding: Tensor
    above_horizon: Tensor

    def __init__(self, config: ModelConfig, cameras: Sequence[Camera]) -> None:
        super().__init__()
        if len(cameras) != CAMERAS:
            raise ValueError(f"dense view: found {len(cameras)} cameras, wanted {CAMERAS}")
        width = config.width
        self.query_grid = config.query_grid
        self.camera_cells = config.feature_grid[0] * config.feature_grid[1]
        self.queries = nn.Parameter(torch.randn(config.query_grid[0] * config.query_grid[1], width))
        self.position = nn.Sequential(
            nn.Linear(width, config.position_width),
            nn.ReLU(),
            nn.Linear(config.position_width, width),
        )
        self.encoder = nn.ModuleList(EncoderLayer(config) for _ in range(config.encoder_layers))
        self.decoder = nn.ModuleList(DecoderLayer(config) for _ in range(config.decoder_layers))
        self.norm = nn.LayerNorm(width)
        self._place(config, cameras)

    def _place(self, config: ModelConfig, cameras: Sequence[Camera]) -> None:
        """Computes the position encodings of all BEV and image cells."""
        views = [c.ground_positions(config.image_size, config.feature_grid) for c in cameras]
        ground = torch.cat([ground.flatten(0, 1) for ground, _ in views])
        sees = torch.cat([sees.flatten() for _, sees in views])
        rows, cols = config.query_grid
        cell_m = (VIEW_ROWS * VIEW_CELL_M / rows, VIEW_COLS * VIEW_CELL_M / cols)
        bev = sine_encoding(*cell_centres(rows, cols, cell_m), config.width).flatten(0, 1)
        image = sine_encoding(ground[:, 0], ground[:, 1], config.width) * sees[:, None]
        self.register_buffer("bev_encoding", bev, persistent=False)
        self.register_buffer("image_encoding", image, persistent=False)
        self.register_buffer("above_horizon", ~sees, persistent=False)

    def forward(self, features: Tensor, index: Tensor, weight: Tensor) -> Tensor:
        """features [batch * 6, width, *grid], index and weight [batch, 8, 5000] ->
        [batch, width, 100, 50]; zero in cells that no camera sees."""
        batch = index.shape[0]
        tokens = features.flatten(2).transpose(1, 2)  # [batch * 6, cells, width]
        tokens = tokens.unflatten(0, (batch, CAMERAS)).flatten(1, 2)
        hidden = self._hidden(index, weight)
        position = self.position(self.image_encoding)
        bev_position = self.position(self.bev_encoding)
        for layer in self.encoder:
            tokens = layer(tokens, position, hidden)
        bev = self.queries.expand(batch, -1, -1)
        for layer in self.decoder:
            bev = layer(bev, bev_position, tokens, position, hidden)
        bev = self.norm(bev).transpose(1, 2).unflatten(2, self.query_grid)
        bev = F.interpolate(bev, (VIEW_ROWS, VIEW_COLS), mode="bilinear", align_corners=False)
        seen = (weight > 0).any(1).unflatten(1, (1, VIEW_ROWS, VIEW_COLS))
        return bev * seen

    def _hidden(self, index: Tensor, weight: Tensor) -> Tensor:
        """Image cells above the horizon or of missing cameras, bool [batch, tokens]."""
        camera = torch.div(index, self.camera_cells, rounding_mode="floor").flatten(1)
        looks = (weight > 0).flatten(1).float()
        missing = looks.new_zeros(len(index), CAMERAS).scatter_add(1, camera, looks) == 0
        missing = missing[..., None].expand(-1, -1, self.camera_cells).flatten(1)
        return self.above_horizon | missing
