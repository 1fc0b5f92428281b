"""Loads the native library (training/native): the daemon's code for Python."""

from __future__ import annotations

import ctypes
import os
from functools import lru_cache
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from training.built_file import built_file

ENVIRONMENT = "BEVLOC_TRAINING_LIBRARY"
_BUILD = Path(__file__).resolve().parent.parent / "build"
_LIBRARY = "training/native/libbevloc_training.so"


def library_path() -> Path:
    """$BEVLOC_TRAINING_LIBRARY, or else the library of the build."""
    if chosen := os.environ.get(ENVIRONMENT):
        return Path(chosen)
    if built := built_file(_BUILD, _LIBRARY):
        return built
    raise FileNotFoundError(
        f"{_BUILD}: found no {_LIBRARY}; build the target bevloc_training or set {ENVIRONMENT}"
    )


@lru_cache(maxsize=1)
def _is_built() -> bool:
    return ENVIRONMENT in os.environ or built_file(_BUILD, _LIBRARY) is not None


def runs_natively(features: Tensor) -> bool:
    """Whether the native code can compute with these features: it is built (a training bundle does
    not have it), and they are float32 in the CPU's memory."""
    return features.device.type == "cpu" and features.dtype == torch.float32 and _is_built()


@lru_cache(maxsize=1)
def library() -> ctypes.CDLL:
    """The loaded library, with the signatures declared in training/native/*.h."""
    lib = ctypes.CDLL(str(library_path()))
    pointer, integer = ctypes.c_void_p, ctypes.c_int
    lib.bevloc_joint_volume.argtypes = [integer] * 3 + [pointer] * 3
    lib.bevloc_joint_volume.restype = None
    lib.bevloc_joint_volume_gradients.argtypes = [integer] * 3 + [pointer] * 5
    lib.bevloc_joint_volume_gradients.restype = None
    lib.bevloc_moved_sums.argtypes = [integer] * 5 + [pointer] * 4
    lib.bevloc_moved_sums.restype = None
    lib.bevloc_moved_sums_gradients.argtypes = [integer] * 5 + [pointer] * 6
    lib.bevloc_moved_sums_gradients.restype = None
    lib.bevloc_scene_features.argtypes = [integer] + [pointer] * 3
    lib.bevloc_scene_features.restype = None
    lib.bevloc_view_table.argtypes = [ctypes.c_uint8] + [pointer] * 2
    lib.bevloc_view_table.restype = None
    lib.bevloc_network_create.argtypes = [ctypes.c_char_p, integer, pointer, integer]
    lib.bevloc_network_create.restype = pointer
    lib.bevloc_network_destroy.argtypes = [pointer]
    lib.bevloc_network_destroy.restype = None
    lib.bevloc_network_run.argtypes = [pointer] * 8
    lib.bevloc_network_run.restype = None
    lib.bevloc_solver_create.argtypes = [pointer, ctypes.c_char_p, pointer, integer]
    lib.bevloc_solver_create.restype = pointer
    lib.bevloc_solver_destroy.argtypes = [pointer]
    lib.bevloc_solver_destroy.restype = None
    lib.bevloc_solver_solve.argtypes = [pointer] * 7
    lib.bevloc_solver_solve.restype = None
    return lib


def host_array(tensor: Tensor, dtype: torch.dtype = torch.float32) -> np.ndarray:
    """A tensor's values as a contiguous array in the CPU's memory. Shares the tensor's memory if
    that is possible without conversion."""
    return tensor.detach().to("cpu", dtype).contiguous().numpy()


def address(array: np.ndarray) -> ctypes.c_void_p:
    """The address of a contiguous array. The caller must keep the array alive."""
    assert array.flags.c_contiguous
    return array.ctypes.data_as(ctypes.c_void_p)
