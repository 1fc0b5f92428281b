"""The sums that make up the ZNCC of moved features, as a differentiable function. The native code
is match_moved() of pipeline/solver/pose_scorer.h."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from training.native import address, host_array, library
from training.solvers.lattice import EVERY_CELL, CellLattice


class _MovedSums(torch.autograd.Function):
    @staticmethod
    def forward(  # type: ignore[override]  # named arguments in place of *args
        ctx: Any, bev: Tensor, features_map: Tensor, corrections: Tensor, lattice: CellLattice
    ) -> Tensor:
        ctx.save_for_backward(bev, features_map, corrections)
        ctx.lattice = lattice
        sides = host_array(bev), host_array(features_map)
        poses = host_array(corrections, torch.float64)
        sums = np.empty_like(poses)
        sizes = (*sides[0].shape[:2], poses.shape[1], lattice.step, lattice.skew)
        library().bevloc_moved_sums(*sizes, *map(address, (*sides, poses, sums)))
        return torch.from_numpy(sums).to(bev.device)

    @staticmethod
    def backward(  # type: ignore[override]  # named argument in place of *args
        ctx: Any, grad_sums: Tensor
    ) -> tuple[Tensor, Tensor, None, None]:
        bev, features_map, corrections = ctx.saved_tensors
        sides = host_array(bev), host_array(features_map)
        poses = host_array(corrections, torch.float64)
        slopes = host_array(grad_sums, torch.float64)
        gradients = np.empty_like(sides[0]), np.empty_like(sides[1])
        sizes = (*sides[0].shape[:2], poses.shape[1], ctx.lattice.step, ctx.lattice.skew)
        library().bevloc_moved_sums_gradients(
            *sizes, *map(address, (*sides, poses, slopes, *gradients))
        )
        grad_bev, grad_map = (torch.from_numpy(gradient).to(bev) for gradient in gradients)
        return grad_bev, grad_map, None, None


def moved_sums(
    bev: Tensor, features_map: Tensor, corrections: Tensor, lattice: CellLattice = EVERY_CELL
) -> Tensor:
    """Sums over the lattice's cells and all channels of features [batch, C, 100, 50], with F_B
    moved by each of the corrections [batch, count, 3]: of moved features times F_M, of moved
    features and of their squares, [batch, count, 3] in float64. The corrections must lie within the
    range of the paper's hypotheses; they get no gradient. native.runs_natively() must hold for the
    features."""
    return _MovedSums.apply(bev, features_map, corrections, lattice)
