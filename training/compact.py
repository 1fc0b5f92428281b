"""Compact checkpoints: five bytes for a weight in place of sixteen, for machines that return small
files only.

Vectors, which are few (biases, batch normalisation, scales), stay as they are. For a matrix or a
kernel, the weights and their average are kept in float16 relative to the largest one (to 0.05 %),
and Adam's mean squared gradient in quarters of an octave (to 9 %). Its mean gradient is dropped,
because a resumed run has it again after some ten steps.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

_MARK = "compact"
_VERSION = 1
_STEPS_PER_OCTAVE = 4
_LEAST_OCTAVE = -58  # the square of a gradient that is lost in AdamW's epsilon
_LARGEST_CODE = 255


def pack(state: dict[str, Any]) -> dict[str, Any]:
    """The compact form of a checkpoint's state."""
    optimiser = state["optimiser"]
    return {
        **state,
        _MARK: _VERSION,
        "model": _each(state["model"], _pack_half),
        "ema": _each(state["ema"], _pack_half),
        "optimiser": {
            **optimiser,
            "state": {key: _pack_moments(v) for key, v in optimiser["state"].items()},
        },
    }


def unpack(state: dict[str, Any]) -> dict[str, Any]:
    """The state of a checkpoint, compact or not."""
    if _MARK not in state:
        return state
    optimiser = state["optimiser"]
    return {
        **{key: value for key, value in state.items() if key != _MARK},
        "model": _each(state["model"], _unpack),
        "ema": _each(state["ema"], _unpack),
        "optimiser": {
            **optimiser,
            "state": {key: _unpack_moments(v) for key, v in optimiser["state"].items()},
        },
    }


def _each(tensors: dict[str, Any], change: Any) -> dict[str, Any]:
    return {name: change(value) for name, value in tensors.items()}


def _is_large(value: Any) -> bool:
    return isinstance(value, Tensor) and value.ndim > 1 and value.dtype == torch.float32


def _pack_half(value: Any) -> Any:
    if not _is_large(value):
        return value
    largest = max(float(value.abs().max()), 1e-30)
    return {"half": (value / largest).half(), "largest": largest}


def _pack_moments(moments: dict[str, Any]) -> dict[str, Any]:
    """The state of one of AdamW's parameters."""
    squares = moments["exp_avg_sq"]
    if not _is_large(squares):
        return moments
    octaves = torch.log2(squares.clamp(min=2.0**_LEAST_OCTAVE)) - _LEAST_OCTAVE
    code = (_STEPS_PER_OCTAVE * octaves).round().clamp(max=_LARGEST_CODE).to(torch.uint8)
    return {"step": moments["step"], "code": code}


def _unpack(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    return value["half"].float() * value["largest"]


def _unpack_moments(moments: dict[str, Any]) -> dict[str, Any]:
    if "code" not in moments:
        return moments
    octaves = moments["code"].float() / _STEPS_PER_OCTAVE + _LEAST_OCTAVE
    squares = torch.exp2(octaves)
    return {"step": moments["step"], "exp_avg": torch.zeros_like(squares), "exp_avg_sq": squares}
