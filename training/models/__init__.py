"""Configurable networks: `BevNetwork(PRESETS["nano"])`."""

from training.models.config import PRESETS, ModelConfig
from training.models.network import BevNetwork

__all__ = ["PRESETS", "BevNetwork", "ModelConfig"]
