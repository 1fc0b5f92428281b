"""The joint volume of pipeline/solver/reference/joint_volume.h as a differentiable function."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from training.native import address, host_array, library

YAW_COUNT, X_COUNT, Y_COUNT = 21, 21, 11


class _JointVolume(torch.autograd.Function):
    @staticmethod
    def forward(  # type: ignore[override]  # named arguments in place of *args
        ctx: Any, bev: Tensor, features_map: Tensor, block_cells: int
    ) -> Tensor:
        ctx.save_for_backward(bev, features_map)
        ctx.block_cells = block_cells
        host_bev, host_map = host_array(bev), host_array(features_map)
        count, channels = host_bev.shape[:2]
        volume = np.empty((count, YAW_COUNT, X_COUNT, Y_COUNT), np.float32)
        library().bevloc_joint_volume(
            count, channels, block_cells, address(host_bev), address(host_map), address(volume)
        )
        return torch.from_numpy(volume).to(bev)

    @staticmethod
    def backward(  # type: ignore[override]  # named argument in place of *args
        ctx: Any, grad_volume: Tensor
    ) -> tuple[Tensor, Tensor, None]:
        bev, features_map = ctx.saved_tensors
        host_bev, host_map, host_grad = map(host_array, (bev, features_map, grad_volume))
        count, channels = host_bev.shape[:2]
        grad_bev, grad_map = np.empty_like(host_bev), np.empty_like(host_map)
        library().bevloc_joint_volume_gradients(
            count,
            channels,
            ctx.block_cells,
            *map(address, (host_bev, host_map, host_grad, grad_bev, grad_map)),
        )
        return torch.from_numpy(grad_bev).to(bev), torch.from_numpy(grad_map).to(bev), None


def joint_volume(bev: Tensor, features_map: Tensor, block_cells: int = 5) -> Tensor:
    """Scores [batch, 21 yaw, 21 x, 11 y] of standardised features [batch, C, 100, 50].
    native.runs_natively() must hold for the features."""
    return _JointVolume.apply(bev, features_map, block_cells)
