"""What ONNX's operators compute, in float64 with numpy. Tensors are [n, channels, rows, cols]."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def rounded(x: Array, kind: str, scale: float) -> Array:
    """QuantizeLinear and DequantizeLinear with zero point 0. `kind` is the name of a type."""
    limits = np.iinfo(kind)
    step = float(np.float32(scale))
    return np.clip(np.rint(x / step), limits.min, limits.max) * step


def windows_of(x: Array, size: int) -> Array:
    """All windows of size x size: [n, c, rows, cols] -> [n, c, row, col, size, size]."""
    # NumPy 1.24 declares only a single axis.
    return np.lib.stride_tricks.sliding_window_view(  # type: ignore[call-overload]
        x, (size, size), (2, 3)
    )


def convolve(x: Array, weight: Array, stride: int, pads: tuple[int, ...], groups: int) -> Array:
    x = np.pad(x, ((0, 0), (0, 0), (pads[0], pads[2]), (pads[1], pads[3])))
    windows = windows_of(x, weight.shape[2])[:, :, ::stride, ::stride]
    n, c, h, w = windows.shape[:4]
    outputs = []
    for g in range(groups):
        w_g = np.split(weight, groups)[g].reshape(weight.shape[0] // groups, -1)
        columns = windows[:, g * c // groups:(g + 1) * c // groups].transpose(0, 2, 3, 1, 4, 5)
        outputs.append((columns.reshape(n * h * w, -1) @ w_g.T).reshape(n, h, w, -1))
    return np.concatenate(outputs, -1).transpose(0, 3, 1, 2)


def max_pool(x: Array, size: int, stride: int) -> Array:
    pad = size // 2
    padded = np.pad(x, ((0, 0), (0, 0), (pad, pad), (pad, pad)), constant_values=-np.inf)
    return windows_of(padded, size)[:, :, ::stride, ::stride].max((-1, -2))


def upsample(x: Array, mode: str) -> Array:
    """Twice the rows and columns, as Resize with mode `nearest` or `linear`."""
    if mode == "nearest":
        return x.repeat(2, 2).repeat(2, 3)
    return twice_linear(twice_linear(x, 2), 3)


def twice_linear(x: Array, axis: int) -> Array:
    """Interpolates at half-pixel positions: 3/4 of a cell plus 1/4 of its neighbour."""
    x = np.moveaxis(x, axis, -1)
    before = np.concatenate([x[..., :1], x[..., :-1]], -1)
    after = np.concatenate([x[..., 1:], x[..., -1:]], -1)
    pairs = np.stack([0.75 * x + 0.25 * before, 0.75 * x + 0.25 * after], -1)
    return np.moveaxis(pairs.reshape(*x.shape[:-1], -1), -1, axis)


def depth_to_space(x: Array, block: int, mode: str) -> Array:
    n, c, h, w = x.shape
    c //= block * block
    if mode == "DCR":
        parts = x.reshape(n, block, block, c, h, w).transpose(0, 3, 4, 1, 5, 2)
    else:
        parts = x.reshape(n, c, block, block, h, w).transpose(0, 1, 4, 2, 5, 3)
    return parts.reshape(n, c, h * block, w * block)


def space_to_depth(x: Array, block: int) -> Array:
    n, c, h, w = x.shape
    parts = x.reshape(n, c, h // block, block, w // block, block).transpose(0, 3, 5, 1, 2, 4)
    return parts.reshape(n, c * block * block, h // block, w // block)


def view_transform(x: Array, index: Array, weight: Array) -> Array:
    """[1, channels, cells]: sums the features that a view table's entries point to."""
    features = x.transpose(0, 2, 3, 1).reshape(-1, x.shape[1])
    return (features[index] * weight[:, :, None]).sum(0).T[None]
