"""Chooses the precision of the network: bfloat16 if the hardware has fast instructions for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import torch

PRECISIONS = ("auto", "float32", "bfloat16")
_CPU_FLAGS = ("amx_bf16", "avx512_bf16")
_FIRST_CUDA_WITH_BFLOAT16 = (8, 0)  # compute capability
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


def _computes_bfloat16(device: torch.device) -> bool:
    """Whether a GPU has instructions for bfloat16. torch.cuda.is_bf16_supported() also accepts the
    slow emulation on older GPUs."""
    if torch.version.hip is not None:
        return True
    return torch.cuda.get_device_capability(device) >= _FIRST_CUDA_WITH_BFLOAT16


def choose_precision(wanted: str, device: torch.device, flags: set[str]) -> Precision:
    """`wanted`: one of PRECISIONS. `flags`: the CPU's feature flags."""
    if wanted != "auto":
        return Precision(wanted == "bfloat16", f"--precision {wanted}")
    if device.type == "cuda":
        able = _computes_bfloat16(device)
        return Precision(able, f"the GPU {'has' if able else 'lacks'} bfloat16")
    if not torch._C._get_mkldnn_enabled():
        return Precision(False, "oneDNN, which has the instructions of the CPU, is off")
    for flag in _CPU_FLAGS:
        if flag in flags:
            return Precision(True, f"the CPU has {flag}")
    return Precision(False, f"the CPU has neither {' nor '.join(_CPU_FLAGS)}")
