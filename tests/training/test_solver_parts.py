"""Tests parts of the solvers against simpler implementations."""

import dataclasses
import math
import unittest
from unittest import mock

import torch
import torch.nn.functional as F
from torch import Tensor

from tests.training.small_solver import SMALL, random_features, small_solvers
from training.joint_volume import joint_volume
from training.solver import DEFINITION, SolverDefinition, hypotheses, standardise
from training.solvers.banded import banded_posterior, banded_scores
from training.solvers.block import block_scores
from training.solvers.cubic import cubic_weights
from training.solvers.features import move
from training.solvers.full import full_scores
from training.solvers.full_fft import full_fft_scores
from training.solvers.lattice import EVERY_CELL, EVERY_SECOND_CELL, EVERY_TENTH_CELL
from training.solvers.literal import gem
from training.solvers.refine import convolve_along, redistribute
from training.solvers.valley import ScoreValley
from training.solvers.zncc import moved_zncc


def standardised(seed: int, definition: SolverDefinition = SMALL) -> tuple[Tensor, Tensor]:
    """Random standardised features of both sides."""
    generator = torch.Generator().manual_seed(seed)
    shape = (2, 3, definition.rows, definition.cols)
    sides = (torch.randn(shape, generator=generator, dtype=torch.float64) for _ in range(2))
    bev, features_map = (standardise(side, definition) for side in sides)
    return bev, features_map


class Hypotheses(unittest.TestCase):
    def test_the_paper_has_21_by_11_by_21(self):
        self.assertEqual([len(h) for h in DEFINITION.hypotheses()], [21, 11, 21])
        torch.testing.assert_close(hypotheses(2.0, 0.4)[[0, 5, 10]].tolist(), [-2.0, 0.0, 2.0])

    def test_sizes_follow_from_cells_and_ranges(self):
        self.assertEqual((DEFINITION.crop_cells, DEFINITION.block_cells), (4, 5))
        finer = dataclasses.replace(DEFINITION, rows=200, cols=100, cell_m=0.3)
        self.assertEqual((finer.crop_cells, finer.block_cells), (7, 10))
        self.assertEqual(finer.spectrum_pooling, 2)

    def test_a_step_that_does_not_divide_its_range_may_lead_beyond_it(self):
        uneven = dataclasses.replace(DEFINITION, x_range_m=1.5, x_step_m=1.0)
        self.assertEqual(uneven.hypotheses()[0].tolist(), [-2.0, -1.0, 0.0, 1.0, 2.0])
        self.assertEqual(uneven.shift_range, (4, 2))


class Move(unittest.TestCase):
    def test_whole_cells_shift_exactly_and_are_filled_with_zeros(self):
        bev, _ = standardised(0)
        correction = torch.tensor([[[0.6, -1.2, 0.0]]]).expand(2, 1, 3)
        moved = move(bev, correction, 0.6)[:, :, 0]
        expected = F.pad(bev, (2, 0, 0, 1))[:, :, 1:, :-2]
        torch.testing.assert_close(moved, expected, atol=1e-6, rtol=0)

    def test_the_margin_is_zero_without_motion(self):
        bev, _ = standardised(1)
        framed = move(bev, torch.zeros(2, 1, 3), 0.6, (3, 2))[:, :, 0]
        torch.testing.assert_close(framed, F.pad(bev, (2, 2, 3, 3)), atol=1e-9, rtol=0)


class Lattice(unittest.TestCase):
    def test_every_column_occurs_once_in_step_many_rows(self):
        for lattice in (EVERY_CELL, EVERY_SECOND_CELL, EVERY_TENTH_CELL):
            mask = lattice.mask(3 * lattice.step, 50)
            held = mask.unflatten(0, (3, -1)).sum(1)
            self.assertEqual(held.unique().tolist(), [1])
            self.assertTrue(mask[0, 0])

    def test_each_row_starts_further_right_by_the_skew(self):
        mask = EVERY_TENTH_CELL.mask(5, 20)
        self.assertEqual([row.nonzero()[0].item() for row in mask], [0, 3, 6, 9, 2])


class Zncc(unittest.TestCase):
    def test_equals_the_correlation_coefficient(self):
        sides = random_features(3)
        unmoved = torch.zeros(1, 1, 3)
        found = moved_zncc(*sides, unmoved, 0.6)[:, 0]
        for i, pair in enumerate(zip(*sides)):
            expected = torch.corrcoef(torch.stack([side.flatten() for side in pair]))[0, 1]
            self.assertAlmostEqual(found[i].item(), expected.item(), places=9)

    def test_a_constant_side_gives_zero(self):
        _, features_map = random_features(3)
        scores = moved_zncc(torch.zeros_like(features_map), features_map, torch.zeros(1, 1, 3), 0.6)
        self.assertEqual(scores.abs().max().item(), 0.0)


class FullFft(unittest.TestCase):
    def test_equals_warping_without_rotation(self):
        for x_step_m, y_step_m in ((0.3, 0.4), (0.25, 0.1), (0.6, 0.2)):
            definition = dataclasses.replace(
                SMALL, x_step_m=x_step_m, y_step_m=y_step_m, yaw_range_rad=1e-9, yaw_step_rad=1e-9
            )
            sides = standardised(5)
            torch.testing.assert_close(
                full_fft_scores(*sides, definition),
                full_scores(*sides, definition),
                atol=1e-6,
                rtol=0,
            )


class Block(unittest.TestCase):
    def test_equals_the_native_code(self):
        sides = standardised(6, DEFINITION)
        found = block_scores(*sides)
        expected = joint_volume(sides[0].float(), sides[1].float())
        torch.testing.assert_close(found.float(), expected, atol=2e-6, rtol=0)

    def test_blocks_of_any_grid_correlate_every_cell_once(self):
        uneven = dataclasses.replace(SMALL, rows=18, cols=11, x_range_m=0.6, x_step_m=0.6)
        sides = standardised(7, uneven)
        scores = block_scores(*sides, uneven)[:, 2, :, 1]  # yaw 0, y 0
        for i, shift in enumerate((-1, 0, 1)):
            moved = F.pad(sides[0], (0, 0, 1, 1))[:, :, 1 + shift : 19 + shift]
            expected = (moved * sides[1]).mean((1, 2, 3))
            torch.testing.assert_close(scores[:, i], expected, atol=1e-9, rtol=0)


class Cubic(unittest.TestCase):
    def test_reproduces_parabolas(self):
        position = torch.tensor([2.0, 3.25, 5.5]).double()
        samples = torch.arange(9).double()
        for values, expected in ((samples**2, position**2), (samples, position)):
            torch.testing.assert_close(cubic_weights(position, 9) @ values, expected)


class Banded(unittest.TestCase):
    def test_marginals_are_those_of_the_joint_distribution(self):
        longitudinal, lateral = banded_scores(*standardised(8), SMALL)
        solvers = small_solvers(scale=15.0)
        found = banded_posterior(
            longitudinal, lateral, solvers.scale("banded_x"), solvers.scale("banded_y")
        )
        logits = 15.0 * (longitudinal[:, :, :, None] + lateral[:, :, None, :])
        joint = torch.softmax(logits.flatten(1), dim=1).reshape(logits.shape)
        torch.testing.assert_close(found.x, joint.sum((1, 3)))
        torch.testing.assert_close(found.y, joint.sum((1, 2)))
        torch.testing.assert_close(found.yaw, joint.sum((2, 3)))


class Gem(unittest.TestCase):
    def test_exponents_lead_from_the_mean_to_the_maximum(self):
        values = torch.rand(4, 30, generator=torch.Generator().manual_seed(2)).double() + 0.01
        for omega in (1.0, 3.0, 40.0):
            found = gem(values, torch.tensor(omega).double(), 1, 1e-6)
            torch.testing.assert_close(found, values.pow(omega).mean(1).pow(1 / omega))

    def test_negative_values_are_clamped(self):
        found = gem(torch.full((1, 5), -2.0), torch.tensor(12.0), 1, 1e-6)
        self.assertAlmostEqual(found.item(), 1e-6, delta=1e-9)


class Valley(unittest.TestCase):
    """Compares the valley with the change of actually moved features."""

    # A shift by whole cells, so that interpolation does not blur.
    POSE = torch.tensor([[1.2, -0.6, 0.0]]).double()

    def setUp(self):
        road = torch.arange(20.0).double()[:, None], torch.arange(10.0).double()[None]
        bend = torch.exp(-((road[1] - 4.5 - 0.03 * (road[0] - 9.5) ** 2) ** 2) / 4)
        end = torch.exp(-((road[0] - 4.0) ** 2 + (road[1] - 3.0) ** 2) / 9)
        inside = torch.exp(-(((road[0] - 9.5) / 7) ** 4) - ((road[1] - 4.5) / 3) ** 4)
        self.features = torch.stack((bend, 0.3 * end))[None] * inside
        self.map = self.moved(torch.zeros(3))

    def moved(self, displacement: Tensor) -> Tensor:
        """The vehicle's features under POSE and a displacement."""
        return move(self.features, (self.POSE + displacement)[None], SMALL.cell_m)[:, :, 0]

    def loss(self, displacement: Tensor) -> float:
        return (self.moved(displacement) - self.map).square().sum().item()

    def check(self, direction: Tensor, others: tuple[int, ...]) -> None:
        size = 0.05
        along = self.loss(size * direction)
        for other in others:
            for sign in (1, -1):
                aside = direction.clone()
                aside[other] += sign * (0.06 if other == 2 else 0.3)
                self.assertLess(along, self.loss(size * aside))

    def test_no_neighbouring_line_changes_the_features_less(self):
        valley = ScoreValley(self.map, SMALL)
        self.check(valley.along_x(self.POSE)[0], (1, 2))
        self.check(0.1 * valley.along_yaw(self.POSE)[0], (1,))

    def test_on_a_curve_moving_along_the_road_turns_the_vehicle(self):
        direction = ScoreValley(self.features[:, :1], SMALL).along_x(torch.zeros(1, 3))[0]
        # The curve's radius is 1 / (2 * 0.03) cells.
        self.assertAlmostEqual(direction[2].abs().item(), 0.06 / SMALL.cell_m, delta=0.03)

    def test_unconstrained_axes_stay_fixed(self):
        nothing = ScoreValley(torch.ones_like(self.features), SMALL)
        self.assertEqual(nothing.along_x(self.POSE).tolist(), [[1.0, 0.0, 0.0]])
        self.assertEqual(nothing.along_yaw(self.POSE).tolist(), [[0.0, 0.0, 1.0]])


class Refinement(unittest.TestCase):
    @torch.no_grad()
    def test_searches_follow_each_other_in_the_order_y_yaw_x(self):
        sides = standardised(9)
        solvers = small_solvers()
        start = torch.tensor([[0.1, 0.2, 0.01], [-0.2, 0.1, 0.0]]).double()
        valley = ScoreValley(sides[1], SMALL)
        pose, found = start.clone(), {}
        lines = {
            1: lambda pose: torch.tensor([[0.0, 1.0, 0.0]] * 2).double(),
            2: valley.along_yaw,
            0: valley.along_x,
        }
        rounds = 2 * [(*line, 0.5, EVERY_TENTH_CELL) for line in lines.items()]
        rounds += [(*line, 1.0, EVERY_SECOND_CELL) for line in lines.items()]
        for axis, line, share, lattice in rounds:
            direction, scores = line(pose), []
            for value in SMALL.hypotheses()[axis]:
                at = pose + (value - pose[:, axis, None]) * direction
                at = torch.stack([a.clamp(-f, f) for a, f in zip(at.T, SMALL.farthest())], dim=1)
                scores.append(moved_zncc(*sides, at[:, None], SMALL.cell_m, lattice)[:, 0])
            found[axis] = torch.softmax(share * 20.0 * torch.stack(scores, dim=1), dim=1)
            mean = found[axis] @ SMALL.hypotheses()[axis]
            pose = pose + (mean - pose[:, axis])[:, None] * direction
        refined = solvers.refine(*sides, start)
        torch.testing.assert_close(refined.x, found[0])
        for axis in (1, 2):  # convolved, but with the mean at the found pose
            self.assertGreater((refined.axes()[axis] - found[axis]).abs().max().item(), 1e-4)
            means = refined.axes()[axis] @ SMALL.hypotheses()[axis]
            torch.testing.assert_close(means, pose[:, axis], atol=0.03, rtol=0)

    @torch.no_grad()
    def test_hypotheses_excluded_by_the_coarse_rounds_keep_their_probability(self):
        sides = standardised(9)
        solvers = small_solvers(scale=500.0)
        start = torch.tensor([[0.1, 0.2, 0.01], [-0.2, 0.1, 0.0]]).double()
        # No hypothesis reaches this threshold, so all keep their probability.
        with mock.patch("training.solvers.refine._LEAST_LIKELY", 2.0):
            kept = solvers.refine(*sides, start)
        refined = solvers.refine(*sides, start)
        unlikely = kept.x < 1e-3 * kept.x.amax(1, keepdim=True)
        self.assertGreater(unlikely.sum().item(), 0)
        torch.testing.assert_close(refined.x[unlikely], kept.x[unlikely])
        torch.testing.assert_close(refined.x.sum(1), torch.ones(2).double())

    def test_probability_is_redistributed_among_likely_hypotheses(self):
        probability = torch.tensor([[0.1, 0.4, 0.2, 0.3]]).double()
        likely = torch.tensor([[False, True, False, True]])
        scores = torch.tensor([[9.0, 2.0, -9.0, 2.0 + math.log(6.0)]]).double()
        found = redistribute(scores, likely, probability)
        torch.testing.assert_close(found, torch.tensor([[0.1, 0.1, 0.2, 0.6]]).double())

    def test_a_following_axis_is_convolved_with_the_followed_one(self):
        values = torch.arange(-3, 4).double() * 0.5
        peak = torch.tensor([[0.0, 0, 0, 1, 0, 0, 0]]).double()
        followed = torch.tensor([[0.25, 0.5, 0.25]]).double()
        # The displacements are between two hypotheses, zero, and beyond the end.
        offset = torch.tensor([[-0.75, 0.0, 4.0]]).double()
        found = convolve_along(peak, values, followed, offset)
        expected = torch.tensor([[0.0, 0.125, 0.125, 0.5, 0, 0, 0.25]]).double()
        torch.testing.assert_close(found, expected)

    def test_nan_stays_nan(self):
        values = torch.arange(3).double()
        flat = torch.full((2, 3), 1 / 3).double()
        offset = torch.tensor([[torch.nan] * 3, [0.0] * 3]).double()
        found = convolve_along(flat, values, flat, offset)
        self.assertTrue(found[0].isnan().any())
        torch.testing.assert_close(found[1], flat[1])


if __name__ == "__main__":
    unittest.main()
