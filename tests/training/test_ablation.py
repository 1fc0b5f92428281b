"""Tests training.ablation, which measures variants of the decoupled solver."""

from __future__ import annotations

import math
import unittest

import torch

from training.ablation import (
    SCALES,
    VARIANTS,
    Baseline,
    NoCrop,
    Scenes,
    first_scenes,
    solve,
    table_row,
)
from training.solver import DEFINITION, PoseSolvers, Posterior, estimate, standardise


class Ablation(unittest.TestCase):
    scenes: Scenes
    found: torch.Tensor
    posterior: Posterior

    @classmethod
    def setUpClass(cls):
        torch.set_num_threads(1)
        cls.scenes = first_scenes(2)
        cls.found, cls.posterior = solve(Baseline(), cls.scenes)

    def test_scenes_are_repeatable_and_within_the_range_of_corrections(self):
        again = first_scenes(1)
        self.assertTrue(again.bev.equal(self.scenes.bev[:1]))
        self.assertTrue(again.features_map.equal(self.scenes.features_map[:1]))
        self.assertTrue(again.correction.equal(self.scenes.correction[:1]))
        limits = torch.tensor(DEFINITION.farthest(), dtype=torch.float64)
        self.assertTrue((self.scenes.correction.abs() <= limits).all())
        self.assertTrue((self.scenes.correction != 0).all())
        for features in (self.scenes.bev, self.scenes.features_map):
            self.assertTrue((features >= 0).all())
            self.assertTrue((features.amax((1, 2, 3)) > 0.5).all())
        self.assertFalse(self.scenes.bev[0].equal(self.scenes.bev[1]))

    @torch.no_grad()
    def test_the_baseline_is_the_decoupled_solver(self):
        solvers = PoseSolvers()
        for name, scale in zip(("x", "y", "yaw"), SCALES):
            solvers.log_scale[name].fill_(math.log(scale))
        sides = standardise(self.scenes.bev), standardise(self.scenes.features_map)
        expected = solvers.decoupled(*sides, None)
        torch.testing.assert_close(self.found, estimate(expected), check_dtype=False)
        for a, b in zip(self.posterior.axes(), expected.axes()):
            torch.testing.assert_close(a, b, rtol=1e-4, atol=1e-6)

    def test_every_variant_gives_distributions_and_another_estimate(self):
        for variant in VARIANTS:
            with self.subTest(variant.title):
                found, posterior = solve(variant(), self.scenes)
                self.assertTrue(found.isfinite().all())
                for p in posterior.axes():
                    torch.testing.assert_close(p.sum(1), torch.ones(2))
                self.assertGreater((found - self.found).abs().max().item(), 1e-4)

    def test_a_change_of_the_axis_step_does_not_change_yaw(self):
        found, _ = solve(NoCrop(), self.scenes)
        self.assertTrue(found[:, 2].equal(self.found[:, 2]))

    def test_a_row_has_the_errors_in_metres_and_degrees(self):
        error = (self.found - self.scenes.correction).abs().mean(0)
        cells = table_row(Baseline(), self.scenes).split("|")
        self.assertEqual(cells[1].strip(), "baseline")
        expected = [error[0].item(), error[1].item(), math.degrees(error[2].item())]
        for cell, value in zip(cells[2:], expected):
            self.assertAlmostEqual(float(cell), value, delta=6e-4)


if __name__ == "__main__":
    unittest.main()
