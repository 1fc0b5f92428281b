"""Configurable networks: `BevNetwork(PRESETS["nano"])`."""

from training.models.config import PRESETS, ModelConfig
from training.models.network import BevNetwork
from training.models.onednn import turn_off_if_wrong

__all__ = ["PRESETS", "BevNetwork", "ModelConfig"]

turn_off_if_wrong()
