"""Chooses the precision of the network: bfloat16 if the hardware has fast instructions for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import torch

PRECISIONS = ("auto", "float32", "bfloat16")
_CPU_FLAGS = ("amx_bf16", "avx512_bf16")
_CPU_INFO = Path("/proc/cpuinfo")


@dataclass(frozen=True)
class Precision:
    bfloat16: bool
    reason: str

    def __str__(self) -> str:
        return f"{'bfloat16' if self.bfloat16 else 'float32'} ({self.reason})"


def cpu_flags(cpu_info: Path = _CPU_INFO) -> set[str]:
    """The feature flags of the first processor as Linux on x86 lists them; empty elsewhere."""
    try:
        lines = cpu_info.read_text().splitlines()
    except OSError:
        return set()
    listed = (line.partition(":")[2].split() for line in lines if line.startswith("flags"))
    return set(next(listed, ()))


def choose_precision(wanted: str, device: torch.device, flags: set[str]) -> Precision:
    """`wanted`: one of PRECISIONS. `flags`: the CPU's feature flags."""
    if wanted != "auto":
        return Precision(wanted == "bfloat16", f"--precision {wanted}")
    if device.type == "cuda":
        able = torch.cuda.is_bf16_supported()
        return Precision(able, f"the GPU {'has' if able else 'lacks'} bfloat16")
    for flag in _CPU_FLAGS:
        if flag in flags:
            return Precision(True, f"the CPU has {flag}")
    return Precision(False, f"the CPU has neither {' nor '.join(_CPU_FLAGS)}")
