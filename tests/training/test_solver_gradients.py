"""Tests autograd through every solver against finite differences."""

from __future__ import annotations

import unittest
from collections.abc import Callable, Mapping

import torch
from torch import Tensor

from tests.training.small_solver import DEGREE, SMALL, random_features, small_solvers
from training.solver import KINDS, Posterior, PoseSolvers, standardise
from training.solvers.lattice import EVERY_SECOND_CELL
from training.solvers.refine import line_zncc, redistribute

# Fixed poses (x m, y m, yaw rad). Poses get no gradient, so they must not depend on the features.
HELD = torch.tensor([[0.17, -0.11, 0.7 * DEGREE], [-0.35, 0.2, -1.2 * DEGREE]]).double()
# Directions of lines through the poses, one for each axis.
LINES = torch.tensor([[1.0, 0.1, 0.02], [0.0, 1.0, 0.0], [0.0, 3.0, 1.0]]).double()
REFINE_SCALES = ("refine_x", "refine_y", "refine_yaw")
STEP = 1e-6


def _standardised(bev: Tensor, features_map: Tensor) -> tuple[Tensor, Tensor]:
    return standardise(bev, SMALL), standardise(features_map, SMALL)


def _coordinate_pass(solvers: PoseSolvers, bev: Tensor, features_map: Tensor) -> Posterior:
    """The searches of a refinement's last round, all through the same pose. The coarse rounds have
    excluded the first hypothesis."""

    def search(axis: int) -> Tensor:
        direction = LINES[axis].expand_as(HELD)
        scores = line_zncc((bev, features_map), HELD, axis, direction, SMALL, EVERY_SECOND_CELL)
        likely = torch.arange(scores.shape[1]) > 0
        before = torch.linspace(0.1, 0.2, scores.shape[1]).to(scores).expand_as(scores)
        return redistribute(scores * solvers.scale(REFINE_SCALES[axis]), likely, before)

    return Posterior(search(0), search(1), search(2))


# The distributions of each solver from raw features; axis steps use a fixed yaw (teacher forcing).
DISTRIBUTIONS: dict[str, Callable[[PoseSolvers, Tensor, Tensor], Posterior]] = {
    "full": lambda s, b, m: s.full(*_standardised(b, m)),
    "full-fft": lambda s, b, m: s.full_fft(*_standardised(b, m)),
    "decoupled-literal": lambda s, b, m: s.literal(b, m, HELD[:, 2]),
    "decoupled": lambda s, b, m: s.decoupled(*_standardised(b, m), HELD[:, 2]),
    "banded": lambda s, b, m: s.banded(*_standardised(b, m)),
    "block": lambda s, b, m: s.joint(*_standardised(b, m)),
    "refine": lambda s, b, m: _coordinate_pass(s, *_standardised(b, m)),
}
LEARNED = {
    "full": {"log_scale.joint"},
    "full-fft": {"log_scale.joint"},
    "decoupled-literal": {"log_scale.x", "log_scale.y", "log_scale.yaw", "log_gem_omega"},
    "decoupled": {"log_scale.x", "log_scale.y", "log_scale.yaw"},
    "banded": {"log_scale.banded_x", "log_scale.banded_y"},
    "block": {"log_scale.joint"},
    "refine": {f"log_scale.{name}" for name in REFINE_SCALES},
}


class FiniteDifferences(unittest.TestCase):
    def setUp(self):
        self.solvers = small_solvers()
        self.sides = [side.requires_grad_() for side in random_features(4)]
        generator = torch.Generator().manual_seed(9)
        self.mix = torch.randn(5 + 3 + 5, generator=generator).double()
        self.generator = generator

    def value(self, kind: str) -> Tensor:
        """A scalar that depends on all distributions."""
        posterior = DISTRIBUTIONS[kind](self.solvers, *self.sides)
        return (torch.cat(posterior.axes(), dim=1).log() * self.mix).sum()

    @torch.no_grad()
    def slope(self, kind: str, parameter: Tensor, direction: Tensor) -> float:
        values = []
        for sign in (1, -1):
            parameter += sign * STEP * direction
            values.append(self.value(kind).item())
            parameter -= sign * STEP * direction
        return (values[0] - values[1]) / (2 * STEP)

    def check(self, kind: str, parameters: Mapping[str, Tensor]) -> None:
        gradients = torch.autograd.grad(self.value(kind), list(parameters.values()))
        for (name, parameter), gradient in zip(parameters.items(), gradients):
            with self.subTest(kind=kind, with_respect_to=name):
                direction = torch.randn(parameter.shape, generator=self.generator).double()
                found = (gradient * direction).sum().item()
                expected = self.slope(kind, parameter, direction)
                self.assertGreater(abs(expected), 1e-3)
                self.assertAlmostEqual(found, expected, delta=1e-5 * max(1.0, abs(expected)))

    def test_gradients_of_the_features_equal_finite_differences(self):
        for kind in DISTRIBUTIONS:
            self.check(kind, dict(zip(("bev", "map"), self.sides)))

    def test_gradients_of_the_parameters_equal_finite_differences(self):
        learned = dict(self.solvers.named_parameters())
        for kind, names in LEARNED.items():
            self.check(kind, {name: learned[name] for name in names})

    def test_a_solver_depends_on_no_other_parameters(self):
        learned = dict(self.solvers.named_parameters())
        for kind, names in LEARNED.items():
            gradients = torch.autograd.grad(
                self.value(kind), list(learned.values()), allow_unused=True
            )
            used = {name for name, g in zip(learned, gradients) if g is not None}
            self.assertEqual(used, names, kind)


class Finite(unittest.TestCase):
    def gradients(self, kind: str, sides: tuple[Tensor, Tensor]) -> list[Tensor]:
        bev, features_map = (side.clone().requires_grad_() for side in sides)
        posterior = small_solvers().float().solve(kind, bev, features_map).posterior
        first = torch.stack([probability[:, 0] for probability in posterior.axes()])
        return list(torch.autograd.grad(-first.log().sum(), (bev, features_map)))

    def test_every_solver_trains_both_sides_in_float32(self):
        bev, features_map = random_features(6)
        for kind in KINDS:
            for gradient in self.gradients(kind, (bev.float(), features_map.float())):
                self.assertTrue(torch.isfinite(gradient).all(), kind)
                self.assertGreater(gradient.abs().max().item(), 1e-6, kind)

    def test_constant_features_give_finite_gradients(self):
        for value in (0.0, 3.0):
            flat = torch.full((1, 2, SMALL.rows, SMALL.cols), value)
            for kind in KINDS:
                for gradient in self.gradients(kind, (flat, flat)):
                    self.assertTrue(torch.isfinite(gradient).all(), f"{kind}, {value}")


if __name__ == "__main__":
    unittest.main()
