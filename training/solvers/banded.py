"""Axis matching band by band, on standardised features. The cost is linear in the number of
hypotheses of each axis; nothing is rotated or Fourier-transformed. Not in the paper.

* F_B and F_M are averaged over 10 bands of rows (band b: rows b 100 / 10 ... (b + 1) 100 / 10 - 1,
  rounded down), which gives one lateral profile [C, 50] per band, and over 5 bands of columns,
  which gives one longitudinal profile [C, 100] per band.
* The lateral profiles of each channel are standardised over all bands and positions:
  (p - mean) / (std + 0.01). So are the longitudinal ones.
* c_b[s] = sum over channels and positions of M_b[i] B_b[i + s] / (bands * positions * C), zero
  outside. d_b[s] is the same for longitudinal profiles. Both are interpolated between whole shifts
  s by cubic convolution (cubic.py).
* A rotation by a moves the centre of a row band at x_b by a x_b along y, and the centre of a column
  band at y_b by -a y_b along x:
  lateral(a, y) = sum over b of c_b((y + a x_b) / 0.6),
  longitudinal(a, x) = sum over b of d_b((x - a y_b) / 0.6).
* P(a, x, y) = softmax(banded_y_scale * lateral + banded_x_scale * longitudinal) over all
  hypotheses. Given a, x and y are independent, so the marginals follow from the two tables. The
  estimates are the means of the marginals.
"""

from __future__ import annotations

from functools import lru_cache

import torch
import torch.nn.functional as F
from torch import Tensor

from training.solvers.cubic import cubic_weights
from training.solvers.definition import SolverDefinition, whole_cells
from training.solvers.posterior import Posterior


def banded_scores(
    bev: Tensor, features_map: Tensor, definition: SolverDefinition
) -> tuple[Tensor, Tensor]:
    """longitudinal [batch, yaw, x] and lateral [batch, yaw, y]."""
    d = definition
    longitudinal, lateral = _look_up(d)
    # Longitudinal profiles are the lateral profiles of the transposed features.
    x_bev, x_map = (
        _profiles(f.transpose(2, 3), d.longitudinal_bands, d) for f in (bev, features_map)
    )
    y_bev, y_map = (_profiles(f, d.lateral_bands, d) for f in (bev, features_map))
    return _scores(x_bev, x_map, longitudinal), _scores(y_bev, y_map, lateral)


def banded_posterior(
    longitudinal: Tensor, lateral: Tensor, x_scale: Tensor, y_scale: Tensor
) -> Posterior:
    """The marginals of P, from the tables of banded_scores()."""
    x_logits, y_logits = longitudinal * x_scale, lateral * y_scale
    yaw = torch.softmax(x_logits.logsumexp(2) + y_logits.logsumexp(2), dim=1)
    x = (yaw[..., None] * torch.softmax(x_logits, dim=2)).sum(1)
    y = (yaw[..., None] * torch.softmax(y_logits, dim=2)).sum(1)
    return Posterior(x, y, yaw)


def _bounds(cells: int, bands: int) -> list[tuple[int, int]]:
    """The first cell of each band and the first one after it."""
    bands = min(bands, cells)
    return [(b * cells // bands, (b + 1) * cells // bands) for b in range(bands)]


def _middles(cells: int, bands: int) -> Tensor:
    """The centre of each band in cells from the vehicle, positive to the front or left."""
    middles = [0.5 * (cells - i - j) for i, j in _bounds(cells, bands)]
    return torch.tensor(middles, dtype=torch.float64)


def _profiles(features: Tensor, bands: int, definition: SolverDefinition) -> Tensor:
    """Standardised lateral profiles, [batch, C, band, cols]."""
    bounds = _bounds(features.shape[2], bands)
    profiles = torch.stack([features[:, :, i:j].mean(2) for i, j in bounds], dim=2)
    std, mean = torch.std_mean(profiles, dim=(2, 3), unbiased=False, keepdim=True)
    return (profiles - mean) / (std + definition.standard_epsilon)


def _scores(profiles_bev: Tensor, profiles_map: Tensor, look_up: Tensor) -> Tensor:
    """Scores [batch, yaw, hypothesis] from profiles and the weights of the whole shifts
    [band, yaw, hypothesis, shift]."""
    reach = look_up.shape[3] // 2
    windows = F.pad(profiles_bev, (reach, reach)).unfold(3, profiles_bev.shape[3], 1)
    correlation = torch.einsum("bcksi,bcki->bks", windows, profiles_map) / profiles_map[0].numel()
    return torch.einsum("bks,kahs->bah", correlation, look_up.to(correlation))


@lru_cache(maxsize=4)
def _look_up(definition: SolverDefinition) -> tuple[Tensor, Tensor]:
    """The weights of the correlations in the scores, [band, yaw, hypothesis, shift], for x and for
    y."""
    d = definition
    x, y, yaw = d.hypotheses()
    x_of_band = _middles(d.rows, d.lateral_bands) * d.cell_m
    y_of_band = _middles(d.cols, d.longitudinal_bands) * d.cell_m
    return _weights(x, yaw, -y_of_band, d), _weights(y, yaw, x_of_band, d)


def _weights(values: Tensor, yaw: Tensor, lever_m: Tensor, definition: SolverDefinition) -> Tensor:
    """`lever_m` [band]: displacement of a band along the axis in metres per radian of yaw."""
    shift_m = values + (yaw * lever_m[:, None])[..., None]  # [band, yaw, hypothesis]
    # Cubic convolution reads from one shift below the integer part to two above it.
    reach = whole_cells(shift_m.abs().max().item(), definition.cell_m) + 2
    return cubic_weights(shift_m / definition.cell_m + reach, 2 * reach + 1)
