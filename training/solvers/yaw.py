"""Yaw from amplitude spectra: the first half of the decoupled solver, on standardised features.

Signature of each side.
* Features with cells finer than 0.6 m are first averaged over as many whole cells as fit into
  0.6 m.
* Multiply by the separable Hann window 0.5 - 0.5 cos(2 pi n / (N - 1)), n = 0 ... N - 1 (the
  symmetric form), with N = 100 over rows and 50 over columns. Zero-pad to 128 x 128, features at
  the top left. Amplitude A = |FFT2|, not normalised.
* 32 radii rho_j = 0.05 + (j + 0.5) 0.75 / 32 cycles/m, j = 0 ... 31; band b has the radii
  j = 4 b ... 4 b + 3 (8 bands). 360 angles theta_i = i * 0.5 degrees.
* A is sampled bilinearly at row bin rho cos(theta) 0.6 * 128 and column bin
  rho sin(theta) 0.6 * 128; indices wrap modulo 128. (Frequencies along rows belong to x and along
  columns to y. Both axes are reversed, to which A is invariant.) The mean over the four radii of a
  band is s[c, b, i].
* Each (channel, band) is standardised over the 360 angles: Y = (s - mean) / (std + 1e-3), with the
  population standard deviation.

Scores. Rotating F_B by +a moves its amplitude to theta + a, so Y_B^a[i] = Y_B(i - a / 0.5 degrees),
circular over 360 samples (because A is even) and linear between samples: with q = a / 0.5 degrees,
n = floor(q) and w = q - n, Y_B^a[i] = (1 - w) Y_B[i - n] + w Y_B[i - n - 1].
score(a) = -mean over (c, b, i) of (Y_M - Y_B^a)^2. P_yaw = softmax(yaw_scale * score). The estimate
is the mean of P_yaw.
"""

from __future__ import annotations

import math

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from training.solvers.definition import DEFINITION, SolverDefinition, split_shift


class YawSignature(nn.Module):
    """The signature of standardised features: [batch, C, rows, cols] -> [batch, C, bands,
    angles]."""

    window: Tensor
    index: Tensor
    weight: Tensor

    def __init__(self, definition: SolverDefinition = DEFINITION) -> None:
        super().__init__()
        self.definition = definition
        self.pooling = definition.spectrum_pooling
        window = torch.outer(
            torch.hann_window(definition.rows // self.pooling, periodic=False, dtype=torch.float64),
            torch.hann_window(definition.cols // self.pooling, periodic=False, dtype=torch.float64),
        )
        self.register_buffer("window", window, persistent=False)
        index, weight = self._polar_taps()
        self.register_buffer("index", index, persistent=False)
        self.register_buffer("weight", weight, persistent=False)

    def _polar_taps(self) -> tuple[Tensor, Tensor]:
        """For every (band, angle): the indices into the half spectrum and their weights."""
        d = self.definition
        count = d.bands * d.radii_per_band
        step = (d.max_frequency - d.min_frequency) / count
        radius = d.min_frequency + (torch.arange(count, dtype=torch.float64) + 0.5) * step
        theta = torch.arange(d.angles, dtype=torch.float64) * (math.pi / d.angles)
        scale = d.cell_m * self.pooling * d.spectrum_size
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
        return index.contiguous(), (weight / d.radii_per_band).contiguous()

    def forward(self, features: Tensor) -> Tensor:
        d = self.definition
        batch, channels = features.shape[:2]
        if self.pooling > 1:
            features = F.avg_pool2d(features, self.pooling)
        windowed = features * self.window.to(features)
        spectrum = torch.fft.rfft2(windowed, s=(d.spectrum_size, d.spectrum_size))
        power = spectrum.real.square() + spectrum.imag.square()
        amplitude = (power + 1e-12).sqrt()
        table = amplitude.reshape(batch * channels, -1).t().contiguous()
        weight = self.weight.to(features)
        polar = F.embedding_bag(self.index, table, per_sample_weights=weight, mode="sum")
        polar = polar.t().reshape(batch, channels, d.bands, d.angles)
        std, mean = torch.std_mean(polar, dim=3, unbiased=False, keepdim=True)
        return (polar - mean) / (std + d.signature_epsilon)


def yaw_scores(
    signature_bev: Tensor, signature_map: Tensor, definition: SolverDefinition = DEFINITION
) -> Tensor:
    """-MSE of every yaw hypothesis, [batch, count]."""
    angles = definition.angles
    whole, fraction = split_shift(definition.hypotheses()[2] / (math.pi / angles))
    fraction = fraction.to(signature_bev)
    first, last = int(whole.min()), int(whole.max()) + 1
    # |Y_M - Y_B^a|^2 is expanded into correlations at integer shifts, which all hypotheses share.
    wrapped = torch.cat([signature_bev[..., -last:], signature_bev, signature_bev[..., :-first]], 3)
    rolled = wrapped.unfold(3, angles, 1)  # [..., shift (last ... first), angles]
    cross = torch.einsum("bcrsi,bcri->bs", rolled, signature_map).flip(1)
    own = (signature_bev * signature_bev).sum(dim=(1, 2, 3))
    neighbour = (signature_bev * torch.roll(signature_bev, 1, 3)).sum(dim=(1, 2, 3))
    other = (signature_map * signature_map).sum(dim=(1, 2, 3))
    low = (whole - first).to(cross.device)
    interpolated = (1 - fraction) * cross[:, low] + fraction * cross[:, low + 1]
    blur = 2 * fraction * (1 - fraction)
    energy = own[:, None] * (1 - blur) + neighbour[:, None] * blur
    return -(other[:, None] - 2 * interpolated + energy) / signature_bev[0].numel()
