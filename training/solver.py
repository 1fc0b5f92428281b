"""The differentiable pose solvers. THIS DOCSTRING IS THE DEFINITION that the C++ run time follows
(pipeline/solver/); golden vectors hold the two together.

Frames. Features are [C, 100, 50] at 0.6 m; row u lies at x = 30 - (u + 0.5) 0.6 m (row 0 is the
front), column v at y = 15 - (v + 0.5) 0.6 m (column 0 is the left). The correction (x, y, a) maps
vehicle points onto the map drawn at T0: p_M = R(a) p_B + t, a counter-clockwise seen from above.
Hypotheses: x = -2 ... +2 m by 0.2 (21), y = -1 ... +1 m by 0.2 (11), a = -2 ... +2 degrees by 0.2
(21), in increasing order.

1. Standardise each channel of F_B and of F_M once over all its 5000 cells:
   (f - mean) / (std + 0.01), std of the population (divided by 5000). All that follows reads the
   standardised features.

2. Yaw signature of each side.
   * Multiply by the separable Hann window 0.5 - 0.5 cos(2 pi n / (N - 1)), n = 0 ... N - 1 (the
     symmetric form), N = 100 over rows and 50 over columns; place at the top left of 128 x 128
     zeros; amplitude A = |FFT2|, not normalised.
   * 32 radii rho_j = 0.05 + (j + 0.5) 0.75 / 32 cycles/m, j = 0 ... 31; band b holds the radii
     j = 4 b ... 4 b + 3 (8 bands). 360 angles theta_i = i * 0.5 degrees.
   * A is read bilinearly at row bin rho cos(theta) 0.6 * 128 and column bin
     rho sin(theta) 0.6 * 128, indices wrapping modulo 128 (frequencies along rows go with x and
     along columns with y; both axes point backwards, which A does not see). The four radii of a
     band are averaged: s[c, b, i].
   * Each (channel, band) is standardised over the 360 angles: Y = (s - mean) / (std + 1e-6),
     population std.

3. Yaw scores. Turning F_B by +a moves its amplitude to theta + a, so
   Y_B^a[i] = Y_B(i - a / 0.5 degrees), circular over 360 samples (the amplitude is even), linear
   between samples: with q = a / 0.5 degrees, n = floor(q), w = q - n,
   Y_B^a[i] = (1 - w) Y_B[i - n] + w Y_B[i - n - 1].
   score(a) = -mean over (c, b, i) of (Y_M - Y_B^a)^2; P_yaw = softmax(yaw_scale * score);
   the estimate is the posterior mean.

4. Turn F_B once about the vehicle by the estimated yaw: F'(p) = F_B(R(-a) p), bilinear, each tap
   outside the grid counts as zero. (In training: by the true yaw with noise of 0.2 degrees.)

5. Axis features and scores. A 4-cell border is cropped on every side.
   * x: A[c, u] = mean over columns 4 ... 45 (GeM, eq. 12, with omega = 1: the features are
     signed). A_B^x[u] = A_B(u + x / 0.6), linear between rows, for u = 4 ... 95.
   * y: A[c, v] = mean over rows 4 ... 95; A_B^y[v] = A_B(v + y / 0.6) for v = 4 ... 45.
   * Per channel, over the cropped positions: z_c = cov(A_B^t, A_M) / sqrt((var(A_B^t) + 1e-3)
     (var(A_M) + 1e-3)), population moments of these very positions; score = mean over c of z_c;
     P = softmax(scale * score) with x_scale or y_scale; the estimate is the posterior mean.

6. The joint volume (pipeline/solver/joint_volume.h, blocks of 5 x 5 cells, cubic look-up) scores
   all 21 x 21 x 11 hypotheses: ZNCC(a, x, y) in the standardise-once form. P = softmax(joint_scale
   * ZNCC) over all of them; the marginals of P are the distributions of x, y and yaw; the estimates
   are their means.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.joint_volume import joint_volume


@dataclass(frozen=True)
class SolverDefinition:
    """Every constant of the definition above."""

    rows: int = 100
    cols: int = 50
    cell_m: float = 0.6
    x_range_m: float = 2.0
    x_step_m: float = 0.2
    y_range_m: float = 1.0
    y_step_m: float = 0.2
    yaw_range_rad: float = math.radians(2.0)
    yaw_step_rad: float = math.radians(0.2)
    standard_epsilon: float = 0.01
    spectrum_size: int = 128
    bands: int = 8
    radii_per_band: int = 4
    min_frequency: float = 0.05
    max_frequency: float = 0.8
    angles: int = 360
    signature_epsilon: float = 1e-6
    crop_cells: int = 4
    zncc_epsilon: float = 1e-3
    block_cells: int = 5
    teacher_yaw_noise_rad: float = math.radians(0.2)

    def axes(self) -> tuple[tuple[float, float], ...]:
        """Range and step of the hypotheses of x, y and yaw."""
        return (
            (self.x_range_m, self.x_step_m),
            (self.y_range_m, self.y_step_m),
            (self.yaw_range_rad, self.yaw_step_rad),
        )


DEFINITION = SolverDefinition()


def hypotheses(value_range: float, step: float) -> Tensor:
    """Equally spaced hypotheses -range ... +range."""
    half = round(value_range / step)
    return torch.arange(-half, half + 1, dtype=torch.float64).mul(step).float()


@dataclass(frozen=True)
class Posterior:
    """Distributions over the hypotheses, [batch, count] each."""

    x: Tensor
    y: Tensor
    yaw: Tensor

    def axes(self) -> tuple[Tensor, Tensor, Tensor]:
        return self.x, self.y, self.yaw


def standardise(features: Tensor) -> Tensor:
    """Step 1, for features [batch, C, rows, cols]."""
    std, mean = torch.std_mean(features, dim=(2, 3), unbiased=False, keepdim=True)
    return (features - mean) / (std + DEFINITION.standard_epsilon)


class YawSignature(nn.Module):
    """Step 2: standardised features [batch, C, rows, cols] -> [batch, C, bands, angles]."""

    def __init__(self, definition: SolverDefinition = DEFINITION) -> None:
        super().__init__()
        self.definition = definition
        window = torch.outer(
            torch.hann_window(definition.rows, periodic=False),
            torch.hann_window(definition.cols, periodic=False),
        )
        self.register_buffer("window", window, persistent=False)
        index, weight = self._polar_taps()
        self.register_buffer("index", index, persistent=False)
        self.register_buffer("weight", weight, persistent=False)

    def _polar_taps(self) -> tuple[Tensor, Tensor]:
        """For every (band, angle): where to read the half spectrum, and with which weights."""
        d = self.definition
        count = d.bands * d.radii_per_band
        step = (d.max_frequency - d.min_frequency) / count
        radius = d.min_frequency + (torch.arange(count, dtype=torch.float64) + 0.5) * step
        theta = torch.arange(d.angles, dtype=torch.float64) * (math.pi / d.angles)
        scale = d.cell_m * d.spectrum_size
        row = radius[:, None] * torch.cos(theta) * scale
        col = radius[:, None] * torch.sin(theta) * scale
        row0, col0 = row.floor(), col.floor()
        half_cols = d.spectrum_size // 2 + 1
        indices, weights = [], []
        for i in (0, 1):
            for j in (0, 1):
                weights.append((1 - (row - row0 - i).abs()) * (1 - (col - col0 - j).abs()))
                wrapped = torch.remainder(row0 + i, d.spectrum_size)
                indices.append((wrapped * half_cols + col0 + j).long())
        shape = (4, d.bands, d.radii_per_band, d.angles)
        index = torch.stack(indices).reshape(shape).permute(1, 3, 0, 2).reshape(-1, 4 * shape[2])
        weight = torch.stack(weights).reshape(shape).permute(1, 3, 0, 2).reshape(index.shape)
        return index.contiguous(), (weight / d.radii_per_band).float().contiguous()

    def forward(self, features: Tensor) -> Tensor:
        d = self.definition
        batch, channels = features.shape[:2]
        spectrum = torch.fft.rfft2(features * self.window, s=(d.spectrum_size, d.spectrum_size))
        power = spectrum.real.square() + spectrum.imag.square()
        amplitude = (power + 1e-12).sqrt()
        table = amplitude.reshape(batch * channels, -1).t().contiguous()
        polar = F.embedding_bag(self.index, table, per_sample_weights=self.weight, mode="sum")
        polar = polar.t().reshape(batch, channels, d.bands, d.angles)
        std, mean = torch.std_mean(polar, dim=3, unbiased=False, keepdim=True)
        return (polar - mean) / (std + d.signature_epsilon)


def yaw_scores(signature_bev: Tensor, signature_map: Tensor) -> Tensor:
    """Step 3: -MSE of every yaw hypothesis, [batch, count]."""
    d = DEFINITION
    shift = hypotheses(d.yaw_range_rad, d.yaw_step_rad).double() / (math.pi / d.angles)
    whole = torch.round(shift * 1e6).div(1e6).floor().long()  # 2.0 stays 2 whatever its last bit
    fraction = (shift - whole).to(signature_bev)
    first, last = int(whole.min()), int(whole.max()) + 1
    # |Y_M - Y_B^a|^2 expands into correlations at integer shifts: nothing is rolled per hypothesis.
    wrapped = torch.cat([signature_bev[..., -last:], signature_bev, signature_bev[..., :-first]], 3)
    rolled = wrapped.unfold(3, d.angles, 1)  # [..., shift (last ... first), angles]
    cross = torch.einsum("bcrsi,bcri->bs", rolled, signature_map).flip(1)
    own = (signature_bev * signature_bev).sum(dim=(1, 2, 3))
    neighbour = (signature_bev * torch.roll(signature_bev, 1, 3)).sum(dim=(1, 2, 3))
    other = (signature_map * signature_map).sum(dim=(1, 2, 3))
    low = (whole - first).to(cross.device)
    interpolated = (1 - fraction) * cross[:, low] + fraction * cross[:, low + 1]
    blur = 2 * fraction * (1 - fraction)
    energy = own[:, None] * (1 - blur) + neighbour[:, None] * blur
    return -(other[:, None] - 2 * interpolated + energy) / signature_bev[0].numel()


def rotate(features: Tensor, yaw_rad: Tensor) -> Tensor:
    """Step 4: features [batch, C, rows, cols] turned about the vehicle by yaw [batch]."""
    d = DEFINITION
    device = features.device
    x = (0.5 * d.rows - 0.5 - torch.arange(d.rows, device=device, dtype=torch.float32))[:, None]
    y = (0.5 * d.cols - 0.5 - torch.arange(d.cols, device=device, dtype=torch.float32))[None, :]
    cos, sin = torch.cos(yaw_rad)[:, None, None], torch.sin(yaw_rad)[:, None, None]
    source_x, source_y = cos * x + sin * y, -sin * x + cos * y
    # grid_sample's unit: the grid's edges lie at -1 and +1; x to its rows, y to its columns.
    grid = torch.stack((-source_y / (0.5 * d.cols), -source_x / (0.5 * d.rows)), dim=3)
    return F.grid_sample(features, grid.to(features), padding_mode="zeros", align_corners=False)


def _axis_scores(axis_bev: Tensor, axis_map: Tensor, shifts: Tensor) -> Tensor:
    """ZNCC of axis features [batch, C, n] for every shift in cells, [batch, count]."""
    d = DEFINITION
    crop, inner = d.crop_cells, axis_bev.shape[2] - 2 * d.crop_cells
    shifts = torch.round(shifts.double() * 1e6).div(1e6)
    whole = shifts.floor().long()
    fraction = (shifts - whole).to(axis_bev)[:, None]
    start = (whole + crop).to(axis_bev.device)
    windows = axis_bev.unfold(2, inner, 1)  # [batch, C, start, inner]
    last = windows.shape[2] - 1
    # A whole shift needs no right neighbour; at the last window there is none.
    right = windows[:, :, (start + 1).clamp(max=last)]
    shifted = (1 - fraction) * windows[:, :, start] + fraction * right
    shifted = shifted - shifted.mean(dim=3, keepdim=True)
    fixed = axis_map[:, :, crop : crop + inner]
    fixed = (fixed - fixed.mean(dim=2, keepdim=True))[:, :, None]
    covariance = (shifted * fixed).mean(dim=3)
    variances = (shifted.square().mean(dim=3) + d.zncc_epsilon) * (
        fixed.square().mean(dim=3) + d.zncc_epsilon
    )
    return (covariance / variances.sqrt()).mean(dim=1)


def longitudinal_scores(turned_bev: Tensor, features_map: Tensor) -> Tensor:
    """Step 5, x."""
    d = DEFINITION
    inner = slice(d.crop_cells, d.cols - d.crop_cells)
    shifts = hypotheses(d.x_range_m, d.x_step_m) / d.cell_m
    return _axis_scores(turned_bev[..., inner].mean(3), features_map[..., inner].mean(3), shifts)


def lateral_scores(turned_bev: Tensor, features_map: Tensor) -> Tensor:
    """Step 5, y."""
    d = DEFINITION
    inner = slice(d.crop_cells, d.rows - d.crop_cells)
    shifts = hypotheses(d.y_range_m, d.y_step_m) / d.cell_m
    return _axis_scores(turned_bev[:, :, inner].mean(2), features_map[:, :, inner].mean(2), shifts)


class PoseSolvers(nn.Module):
    """Both solvers with their learned softmax scales (SolverParameters of pipeline/solver)."""

    def __init__(self) -> None:
        super().__init__()
        self.signature = YawSignature()
        self.log_scale = nn.ParameterDict(
            {
                name: nn.Parameter(torch.tensor(math.log(value)))
                for name, value in (("joint", 80.0), ("x", 20.0), ("y", 20.0), ("yaw", 20.0))
            }
        )

    def scale(self, name: str) -> Tensor:
        return self.log_scale[name].exp()

    def joint(self, bev: Tensor, features_map: Tensor) -> Posterior:
        """Step 6, from standardised features."""
        scores = joint_volume(bev, features_map)
        batch, yaws, xs, ys = scores.shape
        probability = torch.softmax((scores * self.scale("joint")).reshape(batch, -1), dim=1)
        volume = probability.reshape(batch, yaws, xs, ys)
        return Posterior(volume.sum((1, 3)), volume.sum((1, 2)), volume.sum((2, 3)))

    def decoupled(self, bev: Tensor, features_map: Tensor, yaw_rad: Tensor | None) -> Posterior:
        """Steps 2 to 5, from standardised features. `yaw_rad`: the yaw that the axis step uses
        (teacher forcing); None: the estimate."""
        signatures = self.signature(torch.cat((bev, features_map)))
        scores = yaw_scores(*signatures.chunk(2))
        yaw = torch.softmax(scores * self.scale("yaw"), dim=1)
        if yaw_rad is None:
            yaw_rad = posterior_mean(yaw, DEFINITION.yaw_range_rad, DEFINITION.yaw_step_rad)
        turned = rotate(bev, yaw_rad.detach())
        x = torch.softmax(longitudinal_scores(turned, features_map) * self.scale("x"), dim=1)
        y = torch.softmax(lateral_scores(turned, features_map) * self.scale("y"), dim=1)
        return Posterior(x, y, yaw)


def posterior_mean(probability: Tensor, value_range: float, step: float) -> Tensor:
    return probability @ hypotheses(value_range, step).to(probability)


def estimate(posterior: Posterior) -> Tensor:
    """The posterior's means (x m, y m, yaw rad), [batch, 3]."""
    means = [posterior_mean(p, *axis) for p, axis in zip(posterior.axes(), DEFINITION.axes())]
    return torch.stack(means, dim=1)


@dataclass(frozen=True)
class Solution:
    """What a solver says of a batch: (x m, y m, yaw rad), [batch, 3], and the distributions."""

    estimate: Tensor
    deviation: Tensor
    posterior: Posterior

    @staticmethod
    def of(posterior: Posterior) -> Solution:
        """Means and standard deviations of the posterior."""
        means, deviations = estimate(posterior), []
        for i, (probability, axis) in enumerate(zip(posterior.axes(), DEFINITION.axes())):
            square = probability @ hypotheses(*axis).to(probability).square()
            deviations.append((square - means[:, i].square()).clamp(min=1e-9).sqrt())
        return Solution(means, torch.stack(deviations, dim=1), posterior)
