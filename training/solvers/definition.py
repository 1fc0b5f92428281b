"""All constants of the solvers' definition."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

# A shift (in cells) that differs from an integer by less counts as that integer.
WHOLE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class SolverDefinition:
    """The grid of the features, the hypotheses and the constants of all solvers."""

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
    spectrum_cell_m: float = 0.6
    bands: int = 8
    radii_per_band: int = 4
    min_frequency: float = 0.05
    max_frequency: float = 0.8
    angles: int = 360
    signature_epsilon: float = 1e-3
    zncc_epsilon: float = 1e-3
    block_m: float = 3.0
    lateral_bands: int = 10
    longitudinal_bands: int = 5
    literal_angles: int = 180
    gem_least: float = 1e-6
    teacher_yaw_noise_rad: float = math.radians(0.2)

    def axes(self) -> tuple[tuple[float, float], ...]:
        """Range and step of the hypotheses of x, y and yaw."""
        return (
            (self.x_range_m, self.x_step_m),
            (self.y_range_m, self.y_step_m),
            (self.yaw_range_rad, self.yaw_step_rad),
        )

    def hypotheses(self) -> tuple[Tensor, Tensor, Tensor]:
        """The hypotheses of x, y and yaw, in float64."""
        x, y, yaw = (hypotheses(*axis) for axis in self.axes())
        return x, y, yaw

    def farthest(self) -> tuple[float, float, float]:
        """The largest hypotheses of x, y and yaw. They may exceed the range if the step does not
        divide it."""
        x, y, yaw = (half_count(*axis) * axis[1] for axis in self.axes())
        return x, y, yaw

    @property
    def crop_cells(self) -> int:
        """The width of the cropped border: the largest shift."""
        return max(self.shift_range)

    @property
    def block_cells(self) -> int:
        return max(1, round(self.block_m / self.cell_m))

    @property
    def shift_range(self) -> tuple[int, int]:
        """The largest shifts of the hypotheses in rows and columns, rounded up."""
        x_m, y_m, _ = self.farthest()
        return whole_cells(x_m, self.cell_m), whole_cells(y_m, self.cell_m)

    @property
    def spectrum_pooling(self) -> int:
        """The number of rows and columns over which finer features are averaged before the Fourier
        transform."""
        return max(1, int(self.spectrum_cell_m / self.cell_m + WHOLE_TOLERANCE))


DEFINITION = SolverDefinition()


def half_count(value_range: float, step: float) -> int:
    """The number of hypotheses on either side of zero."""
    return int(value_range / step + 0.5)


def hypotheses(value_range: float, step: float) -> Tensor:
    """Equally spaced hypotheses -range ... +range, in float64."""
    half = half_count(value_range, step)
    return torch.arange(-half, half + 1, dtype=torch.float64) * step


def whole_cells(distance_m: float, cell_m: float) -> int:
    """A distance in cells, rounded up."""
    return math.ceil(distance_m / cell_m - WHOLE_TOLERANCE)


def split_shift(cells: Tensor) -> tuple[Tensor, Tensor]:
    """Splits shifts in cells (float64) into their integer part and a fraction in [0, 1)."""
    whole = torch.floor(cells + WHOLE_TOLERANCE)
    return whole.long(), (cells - whole).clamp(min=0.0)
