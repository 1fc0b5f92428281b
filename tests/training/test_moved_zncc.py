"""Tests the native ZNCC of moved features against PyTorch in float64."""

from __future__ import annotations

import math
import unittest
from unittest import mock

import torch
from torch import Tensor

from training.solvers import zncc
from training.solvers.definition import DEFINITION
from training.solvers.lattice import EVERY_CELL, EVERY_TENTH_CELL, CellLattice
from training.solvers.zncc import moved_zncc

FARTHEST = torch.tensor(DEFINITION.farthest()).double()
# Special corrections: corners of the search range, whole cells, and many taps outside the grid.
SPECIAL = torch.stack(
    [FARTHEST, -FARTHEST, FARTHEST * torch.tensor([1, -1, 1]), torch.zeros(3).double()]
    + [torch.tensor([0.6, -0.6, 0.0]).double(), torch.tensor([1.8, 0.0, -math.radians(2)]).double()]
)


def features(channels: int, batch: int = 2) -> tuple[Tensor, Tensor]:
    generator = torch.Generator().manual_seed(channels)
    shape = (batch, channels, DEFINITION.rows, DEFINITION.cols)
    features_map = torch.randn(shape, generator=generator) + 0.3
    bev = features_map + torch.randn(shape, generator=generator) - 0.1
    return bev, features_map


def corrections(batch: int = 2) -> Tensor:
    generator = torch.Generator().manual_seed(5)
    anywhere = (2 * torch.rand(batch, 7, 3, generator=generator).double() - 1) * FARTHEST
    return torch.cat((SPECIAL.expand(batch, -1, -1), anywhere), dim=1)


def zncc_and_gradients(
    sides: tuple[Tensor, Tensor], poses: Tensor, lattice: CellLattice
) -> tuple[Tensor, list[Tensor]]:
    """The scores, and the gradients of a weighted sum of all scores."""
    bev, features_map = (side.clone().requires_grad_() for side in sides)
    scores = moved_zncc(bev, features_map, poses, DEFINITION.cell_m, lattice)
    weights = torch.linspace(-1.0, 2.0, scores.numel()).to(scores).reshape(scores.shape)
    gradients = torch.autograd.grad((weights * scores).sum(), (bev, features_map))
    return scores.detach(), list(gradients)


class NativeZncc(unittest.TestCase):
    def check(
        self, sides: tuple[Tensor, Tensor], poses: Tensor, lattice: CellLattice = EVERY_CELL
    ) -> None:
        found, gradients = zncc_and_gradients(sides, poses, lattice)
        exact = sides[0].double(), sides[1].double()
        expected = zncc_and_gradients(exact, poses.double(), lattice)
        self.assertEqual(found.dtype, torch.float32)
        torch.testing.assert_close(found.double(), expected[0], atol=1e-5, rtol=0)
        for gradient, wanted in zip(gradients, expected[1]):
            self.assertEqual(gradient.dtype, torch.float32)
            scale = wanted.abs().max().item()
            self.assertGreater(scale, 0)
            torch.testing.assert_close(gradient.double(), wanted, atol=1e-5 * scale, rtol=0)

    def test_equals_pytorch(self):
        # Fewer channels than a vector has lanes, as many, and more.
        for channels in (3, 16, 19):
            with self.subTest(channels=channels):
                self.check(features(channels), corrections())

    def test_uses_only_the_cells_of_a_lattice(self):
        self.check(features(16), corrections(), EVERY_TENTH_CELL)
        self.check(features(19), corrections(), CellLattice(3, 1))

    def test_corrections_may_be_the_same_for_all(self):
        self.check(features(16, batch=3), SPECIAL[None])

    def test_features_need_not_be_contiguous(self):
        bev, features_map = (
            side.contiguous(memory_format=torch.channels_last) for side in features(16)
        )
        self.check((bev, features_map), corrections())

    def test_a_constant_side_gives_zero_scores_and_gradients(self):
        bev, features_map = features(4)
        for sides in ((torch.zeros_like(bev), features_map), (bev, torch.ones_like(bev))):
            scores, gradients = zncc_and_gradients(sides, torch.zeros(2, 1, 3), EVERY_TENTH_CELL)
            self.assertEqual(scores.abs().max().item(), 0.0)
            for gradient in gradients:
                self.assertEqual(gradient.abs().max().item(), 0.0)

    def test_is_used_only_for_float32_on_the_papers_grid_and_hypotheses(self):
        bev, features_map = features(2)
        near, far = torch.zeros(2, 1, 3), torch.tensor([[[2.3, 0.0, 0.0]]])
        uses = {
            True: [(bev, features_map, near, 0.6)],
            False: [
                (bev.double(), features_map.double(), near, 0.6),
                (bev[:, :, 1:], features_map[:, :, 1:], near, 0.6),
                (bev, features_map, near, 0.3),
                (bev, features_map, far, 0.6),
            ],
        }
        for native, calls in uses.items():
            for call in calls:
                with mock.patch.object(zncc, "moved_sums", wraps=zncc.moved_sums) as sums:
                    moved_zncc(*call)
                self.assertEqual(sums.called, native)


if __name__ == "__main__":
    unittest.main()
