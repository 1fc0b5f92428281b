"""Measures what each deviation of the decoupled solver from the paper is worth.

    /usr/bin/python3 -m training.ablation --scenes 200

Prints a Markdown table for the decoupled solver (training/solvers/yaw.py, axis.py) and for variants
that differ from it in one point each: mean absolute errors and -log P(truth), eq. 14 summed over
the axes (8.49 if all hypotheses are equally likely). The scenes are the first tuning scenes
(training/native/scene_features.h).

The softmax scales are tuned for the baseline on these scenes. A variant whose scores have another
magnitude gets its own scale for that axis: the baseline's scale times the power of two that gives
the lowest -log P(truth) on the same scenes. All other scales stay. A variant that changes the yaw
estimate also uses it for x and y.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from tooling.markdown import row, table
from tooling.option_types import positive
from training.losses import sample_1d
from training.native import address, library
from training.solver import DEFINITION, Posterior, YawSignature, posterior_mean, yaw_scores
from training.solvers.axis import lateral_scores, longitudinal_scores
from training.solvers.definition import split_shift
from training.solvers.features import rotate, standardise
from training.solvers.literal import gem

CHANNELS = 16
SCALES = (60.0, 250.0, 175.0)
_X, _Y, _YAW = range(3)
_FACTORS = [2.0**exponent for exponent in range(-6, 5)]
_SCENES_AT_ONCE = 50
_TO_REPORTED = torch.tensor([1.0, 1.0, 180.0 / math.pi], dtype=torch.float64)  # m, m, degrees


@dataclass(frozen=True)
class Scenes:
    """Raw features F_B and F_M, [count, C, rows, cols] each, and the true corrections (x m, y m,
    yaw rad), [count, 3]."""

    bev: Tensor
    features_map: Tensor
    correction: Tensor


def first_scenes(count: int) -> Scenes:
    """The first `count` tuning scenes."""
    bev = np.empty((count, CHANNELS, DEFINITION.rows, DEFINITION.cols), np.float32)
    features_map = np.empty_like(bev)
    correction = np.empty((count, 3), np.float64)
    arrays: tuple[np.ndarray, ...] = (bev, features_map, correction)
    library().bevloc_scene_features(count, *map(address, arrays))
    return Scenes(*map(torch.from_numpy, arrays))


class Baseline:
    """The decoupled solver, split into the steps that variants replace."""

    title = "baseline"
    scales = SCALES
    retuned: tuple[int, ...] = ()  # axes whose softmax scale is tuned for the variant

    def __init__(self) -> None:
        self.spectrum = YawSignature()

    def signature(self, features: Tensor) -> Tensor:
        """The yaw signature, [batch, C, bands, angles]."""
        return self.spectrum(features)

    def yaw_scores(self, bev: Tensor, features_map: Tensor) -> Tensor:
        """Scores of the yaw hypotheses from standardised features, [batch, count]."""
        return yaw_scores(self.signature(bev), self.signature(features_map))

    def axis_input(self, raw: Tensor) -> Tensor:
        """The features that the axis step compares, before F_B is rotated."""
        return standardise(raw)

    def axis_scores(self, axis: int, turned_bev: Tensor, features_map: Tensor) -> Tensor:
        """Scores of the hypotheses of x or y, [batch, count]."""
        scores = longitudinal_scores if axis == _X else lateral_scores
        return scores(turned_bev, features_map)

    def choose(self, axis: int, probability: Tensor) -> Tensor:
        """The estimate along `axis`, [batch]."""
        return posterior_mean(probability, *DEFINITION.axes()[axis])


class NoMinus(Baseline):
    """Eq. 9 as printed: P = softmax(MSE), which prefers the yaw with the largest difference."""

    title = "a. eq. 9 without the minus"

    def yaw_scores(self, bev: Tensor, features_map: Tensor) -> Tensor:
        return -super().yaw_scores(bev, features_map)


class UnitScales(Baseline):
    """Eq. 6, 9 and 10 as printed: softmax of the unscaled scores."""

    title = "b. all softmax scales 1"
    scales = (1.0, 1.0, 1.0)


class TurnedCopies(Baseline):
    """Rotates F_B (bilinear) by every yaw hypothesis and transforms each copy. The baseline shifts
    one spectrum along the angle."""

    title = "c. turned copies of F_B"
    retuned = (_YAW,)

    def yaw_scores(self, bev: Tensor, features_map: Tensor) -> Tensor:
        signature_map = self.signature(features_map)
        scores = []
        for yaw_rad in DEFINITION.hypotheses()[_YAW]:
            signature = self.signature(rotate(bev, yaw_rad.expand(len(bev))))
            scores.append(-(signature_map - signature).square().mean((1, 2, 3)))
        return torch.stack(scores, dim=1)


class OneBand(Baseline):
    """Averages the polar amplitude over all radii at once instead of band by band."""

    title = "d. one radial band"
    retuned = (_YAW,)

    def __init__(self) -> None:
        radii = DEFINITION.bands * DEFINITION.radii_per_band
        self.spectrum = YawSignature(replace(DEFINITION, bands=1, radii_per_band=radii))


class IndexUnits(Baseline):
    """Samples the spectrum of the unpadded grid at circles of indices, which are ellipses in
    physical frequency: row bin r cos(theta) of 100, column bin r sin(theta) of 50, r = 1 ... 24."""

    title = "e. polar sampling in index units"
    retuned = (_YAW,)

    def __init__(self) -> None:
        super().__init__()
        d = DEFINITION
        radius = torch.arange(1, min(d.rows, d.cols) // 2, dtype=torch.float64)[:, None]
        theta = torch.arange(d.angles, dtype=torch.float64) * (math.pi / d.angles)
        # Frequency zero is bin n / 2 of the shifted spectrum. grid_sample expects -1 ... 1.
        row = (d.rows // 2 + radius * torch.cos(theta)) * 2 / (d.rows - 1) - 1
        col = (d.cols // 2 + radius * torch.sin(theta)) * 2 / (d.cols - 1) - 1
        self.polar = torch.stack((col, row), dim=2)[None]

    def signature(self, features: Tensor) -> Tensor:
        spectrum = torch.fft.fft2(features * self.spectrum.window.to(features))
        amplitude = torch.fft.fftshift(spectrum, dim=(2, 3)).abs()
        polar = self.polar.to(features).expand(len(features), -1, -1, -1)
        sampled = F.grid_sample(amplitude, polar, align_corners=True)
        bands = sampled.unflatten(2, (DEFINITION.bands, -1)).mean(3)
        std, mean = torch.std_mean(bands, dim=3, unbiased=False, keepdim=True)
        return (bands - mean) / (std + DEFINITION.signature_epsilon)


class NoWindow(Baseline):
    """Transforms the features without a window, so they end abruptly at the grid's edges."""

    title = "f. no Hann window"
    retuned = (_YAW,)

    def __init__(self) -> None:
        super().__init__()
        self.spectrum.window.fill_(1.0)


class Argmax(Baseline):
    """Eq. 6 and 10 as printed: argmax of each distribution. F_B is rotated by the best yaw."""

    title = "g. best hypotheses, not means"

    def choose(self, axis: int, probability: Tensor) -> Tensor:
        return DEFINITION.hypotheses()[axis][probability.argmax(1)]


class NoCrop(Baseline):
    """Averages over the whole of the other axis and compares wherever both sides have cells."""

    title = "h. no border crop"
    retuned = (_X, _Y)

    def axis_scores(self, axis: int, turned_bev: Tensor, features_map: Tensor) -> Tensor:
        averaged = 3 - axis
        sides = turned_bev.mean(averaged), features_map.mean(averaged)
        shifts = DEFINITION.hypotheses()[axis] / DEFINITION.cell_m
        whole, fraction = (values.tolist() for values in split_shift(shifts))
        return torch.stack([_overlap_zncc(*sides, *s) for s in zip(whole, fraction)], dim=1)


def _overlap_zncc(bev: Tensor, features_map: Tensor, whole: int, fraction: float) -> Tensor:
    """ZNCC of axis features [batch, C, n] over their overlap under a shift in cells, [batch]."""
    n = bev.shape[2]
    right = int(fraction > 0)
    first, last = max(0, -whole), min(n, n - whole - right)
    here = bev[..., first + whole : last + whole]
    beyond = bev[..., first + whole + right : last + whole + right]
    a, b = (1 - fraction) * here + fraction * beyond, features_map[..., first:last]
    a, b = a - a.mean(2, keepdim=True), b - b.mean(2, keepdim=True)
    a_variance, b_variance = (v.square().mean(2) + DEFINITION.zncc_epsilon for v in (a, b))
    return ((a * b).mean(2) / (a_variance * b_variance).sqrt()).mean(1)


class Gem(Baseline):
    """Axis features by GeM pooling (eq. 12) with omega = 3. GeM is undefined for negative values,
    so they are clamped to 1e-6."""

    title = "i. GeM, omega = 3, of positive features"
    retuned = (_X, _Y)

    def axis_scores(self, axis: int, turned_bev: Tensor, features_map: Tensor) -> Tensor:
        pooled = (self._pool(side, 3 - axis) for side in (turned_bev, features_map))
        return super().axis_scores(axis, *pooled)

    def _pool(self, features: Tensor, dim: int) -> Tensor:
        """GeM along `dim` inside the border, repeated to the input's size: the baseline's mean over
        `dim` then leaves it unchanged."""
        crop = DEFINITION.crop_cells
        inner = features.narrow(dim, crop, features.shape[dim] - 2 * crop)
        pooled = gem(inner, torch.tensor(3.0), dim, DEFINITION.gem_least)
        return pooled.unsqueeze(dim).expand_as(features)


class RawAxes(Baseline):
    """Axis features of F_B and F_M without standardisation."""

    title = "j. raw features in the axis step"
    retuned = (_X, _Y)

    def axis_input(self, raw: Tensor) -> Tensor:
        return raw


VARIANTS: tuple[type[Baseline], ...] = (
    NoMinus, UnitScales, TurnedCopies, OneBand, IndexUnits, NoWindow, Argmax, NoCrop, Gem, RawAxes
)


def _in_parts(scores: Callable[..., Tensor], *inputs: Tensor) -> Tensor:
    """`scores` of the inputs, computed in parts of _SCENES_AT_ONCE scenes to limit the memory."""
    return torch.cat([scores(*part) for part in zip(*(i.split(_SCENES_AT_ONCE) for i in inputs))])


def _loss(axis: int, probability: Tensor, truth: Tensor) -> float:
    """Mean of -log P(truth); a small constant bounds it, as in training."""
    likelihood = sample_1d(probability, truth[:, axis], *DEFINITION.axes()[axis])
    return -torch.log(likelihood + 1e-8).mean().item()


def _probability(variant: Baseline, axis: int, scores: Tensor, truth: Tensor) -> Tensor:
    """softmax(scale * scores), with the best scale if the variant retunes this axis."""
    factors = _FACTORS if axis in variant.retuned else [1.0]
    scales = [variant.scales[axis] * factor for factor in factors]
    candidates = [torch.softmax(scores * scale, dim=1) for scale in scales]
    return min(candidates, key=lambda candidate: _loss(axis, candidate, truth))


@torch.no_grad()
def solve(variant: Baseline, scenes: Scenes) -> tuple[Tensor, Posterior]:
    """The estimates (x m, y m, yaw rad), [count, 3], and the distributions."""
    sides = standardise(scenes.bev), standardise(scenes.features_map)
    scores = _in_parts(variant.yaw_scores, *sides)
    yaw = _probability(variant, _YAW, scores, scenes.correction)
    yaw_rad = variant.choose(_YAW, yaw)

    turned = rotate(variant.axis_input(scenes.bev), yaw_rad)
    sides = turned, variant.axis_input(scenes.features_map)
    axis_scores = [variant.axis_scores(axis, *sides) for axis in (_X, _Y)]
    x, y = (_probability(variant, i, s, scenes.correction) for i, s in enumerate(axis_scores))
    found = torch.stack((variant.choose(_X, x), variant.choose(_Y, y), yaw_rad), dim=1)
    return found, Posterior(x, y, yaw)


def table_row(variant: Baseline, scenes: Scenes) -> str:
    found, posterior = solve(variant, scenes)
    errors = ((found - scenes.correction).abs() * _TO_REPORTED).mean(0)
    losses = [_loss(i, p, scenes.correction) for i, p in enumerate(posterior.axes())]
    cells = [variant.title, *(f"{error:.3f}" for error in errors.tolist()), f"{sum(losses):.2f}"]
    return row(cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=positive, default=200)
    scenes = first_scenes(parser.parse_args().scenes)
    print(table(("variant", "x m", "y m", "yaw deg", "NLL"), ()), end="")
    variants: tuple[type[Baseline], ...] = (Baseline, *VARIANTS)
    for variant in variants:
        print(table_row(variant(), scenes), flush=True)


if __name__ == "__main__":
    main()
