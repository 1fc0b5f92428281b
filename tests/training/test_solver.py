"""Tests every solver on scenes with known corrections."""

import dataclasses
import math
import unittest

import torch

from tests.training.synthetic import gradient_of
from training.joint_volume import joint_volume
from training.solver import (
    DEFINITION,
    KINDS,
    PoseSolvers,
    SolverDefinition,
    YawSignature,
    hypotheses,
    posterior_mean,
    rotate,
    standardise,
    yaw_scores,
)
from training.synthetic_scene import features_under

DEGREE = math.radians(1.0)
CORRECTIONS = [
    (0.0, 0.0, 0.0),
    (1.3, 0.0, 0.0),
    (0.0, -0.7, 0.0),
    (0.0, 0.0, 1.1 * DEGREE),
    (-1.1, 0.5, -1.5 * DEGREE),
]


def sharp_solvers(definition: SolverDefinition = DEFINITION) -> PoseSolvers:
    solvers = PoseSolvers(definition)
    for scale in solvers.log_scale.values():
        scale.data.fill_(math.log(150.0))
    return solvers


class KnownCorrections(unittest.TestCase):
    @torch.no_grad()
    def check(
        self,
        kind: str,
        corrections: list[tuple[float, float, float]],
        max_frequency: float,
        tolerance_m: float,
        tolerance_rad: float,
        solvers: PoseSolvers | None = None,
    ) -> None:
        """Checks the estimate of every axis, including its sign."""
        solvers = solvers or sharp_solvers()
        for seed, correction in enumerate(corrections):
            with self.subTest(kind=kind, correction=correction):
                features = features_under(torch.tensor(correction), seed, max_frequency)
                x, y, yaw = solvers.solve(kind, *features).estimate[0].tolist()
                self.assertAlmostEqual(x, correction[0], delta=tolerance_m)
                self.assertAlmostEqual(y, correction[1], delta=tolerance_m)
                self.assertAlmostEqual(yaw, correction[2], delta=tolerance_rad)

    def test_block_solver(self):
        self.check("block", CORRECTIONS, 0.2, 0.1, 0.3 * DEGREE)

    def test_full_solvers(self):
        solvers = sharp_solvers(dataclasses.replace(DEFINITION, x_step_m=0.5, y_step_m=0.25))
        for kind in ("full", "full-fft"):
            self.check(kind, CORRECTIONS[-2:], 0.2, 0.1, 0.3 * DEGREE, solvers)

    def test_decoupled_solver(self):
        self.check("decoupled", CORRECTIONS, 0.7, 0.25, 0.4 * DEGREE)

    def test_banded_solver(self):
        self.check("banded", CORRECTIONS, 0.2, 0.25, 0.4 * DEGREE)

    def test_literal_solver(self):
        # Its yaw is biased towards zero, because rotation blurs all other hypotheses.
        self.check("decoupled-literal", CORRECTIONS, 0.3, 0.41, 1.0 * DEGREE)

    def test_refinement_of_every_first_solution(self):
        for kind in KINDS:
            if kind.endswith("+refine"):
                self.check(kind, CORRECTIONS[-2:], 0.2, 0.1, 0.25 * DEGREE)

    @torch.no_grad()
    def test_rotation_undoes_a_yaw(self):
        yaw = 1.6 * DEGREE
        bev, features_map = features_under(torch.tensor([0.0, 0.0, yaw]), 3)
        turned = rotate(bev, torch.tensor([yaw]))
        inner = (..., slice(6, -6), slice(6, -6))
        error = (turned[inner] - features_map[inner]).abs().mean()
        before = (bev[inner] - features_map[inner]).abs().mean()
        self.assertLess(error.item(), 0.15 * before.item())


class YawScores(unittest.TestCase):
    @torch.no_grad()
    def test_expansion_equals_rolling_each_hypothesis(self):
        bev, features_map = map(standardise, features_under(torch.tensor([0.4, 0.2, 0.01]), 1))
        signature = YawSignature()
        bev, features_map = signature(bev), signature(features_map)
        scores = yaw_scores(bev, features_map)[0]
        values = hypotheses(DEFINITION.yaw_range_rad, DEFINITION.yaw_step_rad)
        for k, yaw in enumerate(values.double().tolist()):
            samples = yaw / (math.pi / DEFINITION.angles)
            low = math.floor(samples + 1e-9)
            fraction = samples - low
            rolled = (1 - fraction) * bev.roll(low, 3) + fraction * bev.roll(low + 1, 3)
            expected = -(features_map - rolled).square().mean()
            self.assertAlmostEqual(scores[k].item(), expected.item(), delta=1e-4)

    @torch.no_grad()
    def test_the_signature_is_invariant_to_translation(self):
        blob = torch.zeros(1, 1, 100, 50)
        blob[..., 45:50, 20:24] = 1.0
        signature = YawSignature()
        signature.window.fill_(1.0)
        difference = signature(blob) - signature(blob.roll((7, 5), (2, 3)))
        self.assertLess(difference.abs().max().item(), 1e-3)


class JointVolumeGradients(unittest.TestCase):
    def test_gradients_match_finite_differences(self):
        generator = torch.Generator().manual_seed(0)
        bev = torch.randn(1, 2, 100, 50, generator=generator)
        features_map = torch.randn(1, 2, 100, 50, generator=generator)
        direction = torch.randn(1, 21, 21, 11, generator=generator).double()
        for which in (0, 1):
            inputs = bev.clone().requires_grad_(), features_map.clone().requires_grad_()
            (joint_volume(*inputs).double() * direction).sum().backward()
            step = torch.randn(bev.shape, generator=generator)
            # The volume is linear in each side, so a large step is exact.
            moved = (bev + step, features_map) if which == 0 else (bev, features_map + step)
            change = (joint_volume(*moved).double() - joint_volume(bev, features_map)) * direction
            expected = change.sum().item()
            found = (gradient_of(inputs[which]).double() * step).sum().item()
            self.assertAlmostEqual(found, expected, delta=1e-4 * max(1.0, abs(expected)))

    @torch.no_grad()
    def test_batch_elements_are_scored_independently(self):
        bev, features_map = torch.randn(3, 4, 100, 50), torch.randn(3, 4, 100, 50)
        together = joint_volume(bev, features_map)
        self.assertEqual(tuple(together.shape), (3, 21, 21, 11))
        for i in range(3):
            alone = joint_volume(bev[i : i + 1], features_map[i : i + 1])
            self.assertTrue(torch.equal(together[i : i + 1], alone))


class Degenerate(unittest.TestCase):
    @torch.no_grad()
    def test_constant_features_give_finite_posteriors(self):
        solvers = sharp_solvers(dataclasses.replace(DEFINITION, x_step_m=1.0, y_step_m=0.5))
        for value in (0.0, 3.0):
            flat = torch.full((1, 4, 100, 50), value)
            for kind in KINDS:
                solution = solvers.solve(kind, flat, flat)
                self.assertTrue(torch.isfinite(solution.estimate).all(), kind)
                for probability in solution.posterior.axes():
                    self.assertTrue(torch.isfinite(probability).all(), kind)
                    self.assertAlmostEqual(probability.sum().item(), 1.0, places=4)

    @torch.no_grad()
    def test_without_evidence_the_mean_is_zero(self):
        mean = posterior_mean(torch.full((1, 21), 1 / 21), 2.0, 0.2)
        self.assertAlmostEqual(mean.item(), 0.0, places=5)


class Parameters(unittest.TestCase):
    def test_an_old_checkpoint_does_not_change_parameters_of_newer_solvers(self):
        solvers = sharp_solvers()
        old = {f"log_scale.{name}": torch.tensor(1.5) for name in ("joint", "x", "y", "yaw")}
        solvers.load_state_dict(old)
        self.assertAlmostEqual(solvers.log_scale["yaw"].item(), 1.5)
        self.assertAlmostEqual(solvers.log_scale["banded_x"].item(), math.log(150.0), places=5)
        self.assertAlmostEqual(solvers.gem_omega.item(), 1.0)

    def test_unknown_parameters_are_refused(self):
        with self.assertRaises(RuntimeError):
            sharp_solvers().load_state_dict({"log_scale.sideways": torch.tensor(1.0)})

    def test_unknown_solvers_are_refused(self):
        flat = torch.zeros(1, 1, 100, 50)
        with self.assertRaises(KeyError):
            sharp_solvers().solve("sideways", flat, flat)


if __name__ == "__main__":
    unittest.main()
