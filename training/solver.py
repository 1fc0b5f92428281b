"""The differentiable pose solvers with their learned parameters. Their parts are in
training/solvers/, whose docstrings define what the C++ code implements (pipeline/solver/)."""

from __future__ import annotations

import math
from typing import Any

import torch
from torch import Tensor, nn

from training.solvers.axis import lateral_scores, longitudinal_scores
from training.solvers.banded import banded_posterior, banded_scores
from training.solvers.block import block_scores
from training.solvers.definition import DEFINITION, SolverDefinition, hypotheses
from training.solvers.features import rotate, standardise
from training.solvers.full import full_scores
from training.solvers.full_fft import full_fft_scores
from training.solvers.literal import literal_axis_scores, literal_yaw_scores, scale_together
from training.solvers.posterior import (
    Posterior,
    Solution,
    best_hypotheses,
    estimate,
    joint_posterior,
    posterior_mean,
)
from training.solvers.refine import refine
from training.solvers.yaw import YawSignature, yaw_scores

__all__ = [
    "DEFINITION",
    "KINDS",
    "PoseSolvers",
    "Posterior",
    "Solution",
    "SolverDefinition",
    "YawSignature",
    "best_hypotheses",
    "estimate",
    "hypotheses",
    "posterior_mean",
    "rotate",
    "standardise",
    "yaw_scores",
]

# Names and order of pipeline/solver/solver_factory.h.
KINDS = (
    "full",
    "full-fft",
    "decoupled-literal",
    "decoupled-literal+refine",
    "decoupled",
    "decoupled+refine",
    "banded",
    "banded+refine",
    "block",
    "block+refine",
)
_LITERAL = "decoupled-literal"
_REFINED = "+refine"
_INITIAL_SCALES = {
    "joint": 80.0,
    "x": 20.0,
    "y": 20.0,
    "yaw": 20.0,
    "banded_x": 20.0,
    "banded_y": 20.0,
    "refine_x": 80.0,
    "refine_y": 80.0,
    "refine_yaw": 80.0,
}


class PoseSolvers(nn.Module):
    """All solvers with their learned parameters (pipeline/solver/solver_parameters.h): the inverse
    temperatures of the softmaxes and the literal solver's GeM exponent. All solvers except
    `literal` take standardised features."""

    def __init__(self, definition: SolverDefinition = DEFINITION) -> None:
        super().__init__()
        self.definition = definition
        self.signature = YawSignature(definition)
        self.log_scale = nn.ParameterDict(
            {
                name: nn.Parameter(torch.tensor(math.log(value)))
                for name, value in _INITIAL_SCALES.items()
            }
        )
        self.log_gem_omega = nn.Parameter(torch.tensor(0.0))

    def _load_from_state_dict(
        self, state_dict: dict[str, Tensor], prefix: str, *arguments: Any
    ) -> None:
        """Loads parameters. Those that the checkpoint is too old to contain keep their values."""
        for name, value in self.state_dict(prefix=prefix).items():
            state_dict.setdefault(name, value)
        super()._load_from_state_dict(state_dict, prefix, *arguments)

    def scale(self, name: str) -> Tensor:
        return self.log_scale[name].exp()

    @property
    def gem_omega(self) -> Tensor:
        return self.log_gem_omega.exp()

    def full(self, bev: Tensor, features_map: Tensor) -> Posterior:
        scores = full_scores(bev, features_map, self.definition)
        return joint_posterior(scores, self.scale("joint"))

    def full_fft(self, bev: Tensor, features_map: Tensor) -> Posterior:
        scores = full_fft_scores(bev, features_map, self.definition)
        return joint_posterior(scores, self.scale("joint"))

    def joint(self, bev: Tensor, features_map: Tensor) -> Posterior:
        """The solver "block": distributions from the joint volume of all hypotheses."""
        scores = block_scores(bev, features_map, self.definition)
        return joint_posterior(scores, self.scale("joint"))

    def decoupled(self, bev: Tensor, features_map: Tensor, yaw_rad: Tensor | None) -> Posterior:
        """`yaw_rad` [batch]: the yaw that the axis step uses (teacher forcing); None: the
        estimate."""
        d = self.definition
        signature_bev, signature_map = self.signature(torch.cat((bev, features_map))).chunk(2)
        scores = yaw_scores(signature_bev, signature_map, d)
        yaw = torch.softmax(scores * self.scale("yaw"), dim=1)
        if yaw_rad is None:
            yaw_rad = posterior_mean(yaw, d.yaw_range_rad, d.yaw_step_rad)
        turned = rotate(bev, yaw_rad.detach())
        x = torch.softmax(longitudinal_scores(turned, features_map, d) * self.scale("x"), dim=1)
        y = torch.softmax(lateral_scores(turned, features_map, d) * self.scale("y"), dim=1)
        return Posterior(x, y, yaw)

    def literal(self, bev: Tensor, features_map: Tensor, yaw_rad: Tensor | None) -> Posterior:
        """The solver "decoupled-literal" on raw features. `yaw_rad` as in `decoupled`."""
        d = self.definition
        bev, features_map = scale_together(bev, features_map)
        scores = literal_yaw_scores(bev, features_map, d)
        yaw = torch.softmax(scores * self.scale("yaw"), dim=1)
        if yaw_rad is None:
            yaw_rad = d.hypotheses()[2].to(bev)[yaw.argmax(1)]
        x, y = literal_axis_scores(bev, features_map, yaw_rad, self.gem_omega.to(bev), d)
        x = torch.softmax(x * self.scale("x"), dim=1)
        y = torch.softmax(y * self.scale("y"), dim=1)
        return Posterior(x, y, yaw)

    def banded(self, bev: Tensor, features_map: Tensor) -> Posterior:
        scores = banded_scores(bev, features_map, self.definition)
        return banded_posterior(*scores, self.scale("banded_x"), self.scale("banded_y"))

    def refine(self, bev: Tensor, features_map: Tensor, start: Tensor) -> Posterior:
        """Refines the estimate `start` (x m, y m, yaw rad), [batch, 3]."""
        scales = tuple(self.scale(f"refine_{axis}") for axis in ("x", "y", "yaw"))
        return refine(bev, features_map, start, scales, self.definition)

    def solve(self, kind: str, bev: Tensor, features_map: Tensor) -> Solution:
        """The result of the solver `kind` (one of KINDS, else KeyError) on raw features."""
        sides = standardise(bev, self.definition), standardise(features_map, self.definition)
        first = kind[: -len(_REFINED)] if kind.endswith(_REFINED) else kind
        if first == _LITERAL:
            posterior = self.literal(bev, features_map, None)
            start = best_hypotheses(posterior, self.definition)
        else:
            posterior = self._first(first, *sides)
            start = estimate(posterior, self.definition)
        if first != kind:
            posterior = self.refine(*sides, start)
            start = estimate(posterior, self.definition)
        deviation = Solution.of(posterior, self.definition).deviation
        return Solution(start, deviation, posterior)

    def _first(self, kind: str, bev: Tensor, features_map: Tensor) -> Posterior:
        if kind == "decoupled":
            return self.decoupled(bev, features_map, None)
        matchers = {
            "full": self.full,
            "full-fft": self.full_fft,
            "banded": self.banded,
            "block": self.joint,
        }
        return matchers[kind](bev, features_map)
