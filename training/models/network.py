"""The complete network, built from a configuration.

images [batch, 6, 3, *image_size] -> trunk -> view transform -> BEV encoder -> compression -> F_B
raster [batch, 3, 400, 200] -> map encoder -> compression -> F_M
BEV encoder or map encoder -> head H -> mask [batch, 3, 400, 200]
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from training.models.bev_encoder import make_bev_encoder
from training.models.compression import make_compression
from training.models.config import ModelConfig
from training.models.head import Head
from training.models.map_encoder import MapEncoder
from training.models.rig import Camera, nominal_cameras
from training.models.trunks import make_trunk
from training.models.view_dense import DenseView
from training.models.view_kernel import KernelView
from training.models.view_lut import LutView
from training.solver import PoseSolvers


class BevNetwork(nn.Module):
    """All learned parameters, including the solvers' scales. `cameras`: the six cameras of a dense
    view, by default the nuScenes rig. The other view transforms use only the view table."""

    def __init__(self, config: ModelConfig, cameras: Sequence[Camera] | None = None) -> None:
        super().__init__()
        self.config = config
        self.trunk = make_trunk(config)
        self.view = make_view(config, cameras)
        self.bev_encoder = make_bev_encoder(config)
        self.bev_compress = make_compression(config)
        self.map_encoder = MapEncoder(config)
        self.map_compress = make_compression(config)
        self.head = Head(config)
        self.solvers = PoseSolvers(config.solver_definition())
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")

    def perceive(self, images: Tensor, index: Tensor, weight: Tensor) -> Tensor:
        """Images (see real_images) and view table -> BEV features [batch, width, *bev_size]. index
        and weight are [batch, 8, 5000]; an index is camera * cells + row * columns + column of the
        configuration's feature_grid."""
        features = self.trunk(images.flatten(0, 1))
        return self.bev_encoder(self.view(features, index, weight))

    def forward(
        self, images: Tensor, index: Tensor, weight: Tensor, raster: Tensor
    ) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """-> F_B, F_M, logits of the perceived mask, logits of the reconstructed mask."""
        bev = self.perceive(images, index, weight)
        encoded = self.map_encoder(raster)
        perceived, reconstructed = self.head(torch.cat((bev, encoded))).chunk(2)
        return self.bev_compress(bev), self.map_compress(encoded), perceived, reconstructed


def make_view(config: ModelConfig, cameras: Sequence[Camera] | None) -> nn.Module:
    if config.view == "lut":
        return LutView()
    if config.view == "kernel":
        return KernelView(config)
    return DenseView(config, nominal_cameras(config.image_size) if cameras is None else cameras)
