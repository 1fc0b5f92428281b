"""Interpolation by cubic convolution (Keys 1981, a = -1/2), which is exact for parabolas. The four
taps at fraction t have the weights (-t + 2 t^2 - t^3) / 2, (2 - 5 t^2 + 3 t^3) / 2,
(t + 4 t^2 - 3 t^3) / 2 and (-t^2 + t^3) / 2.
"""

from __future__ import annotations

from torch import Tensor


def cubic_weights(position: Tensor, samples: int) -> Tensor:
    """The weights of `samples` samples in the values at positions [...] (float64):
    [..., samples]."""
    whole = position.floor()
    t = position - whole
    taps = (
        0.5 * (-t + 2 * t**2 - t**3),
        0.5 * (2 - 5 * t**2 + 3 * t**3),
        0.5 * (t + 4 * t**2 - 3 * t**3),
        0.5 * (t**3 - t**2),
    )
    weights = position.new_zeros((*position.shape, samples))
    for k, tap in enumerate(taps):
        weights.scatter_(-1, (whole.long() + k - 1)[..., None], tap[..., None])
    return weights
