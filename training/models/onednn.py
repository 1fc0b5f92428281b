"""Keeps PyTorch from computing convolutions with a version of oneDNN that computes them wrongly.

oneDNN 3.7 (Debian 13's PyTorch 2.6 uses 3.7.2) misplaces weights if a convolution has more than 16
input channels and their number is no multiple of 16 (docs/network.md). PyTorch's own convolutions
are right, but take about ten times as long.
"""

from __future__ import annotations

import re

import torch

_WRONG_VERSIONS = ("3.7",)


def turn_off_if_wrong(build: str | None = None) -> None:
    """Turns oneDNN off for this process; `build` replaces what PyTorch says about its build."""
    found = re.search(r"MKL-DNN v(\d+\.\d+)", build or torch.__config__.show())
    if found and found.group(1) in _WRONG_VERSIONS:
        torch.backends.mkldnn.set_flags(False)
