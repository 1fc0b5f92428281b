"""The inputs of the appliance's network: their sizes and their scaling.

Every network that trains on the sampler's images and view table has these sizes
(`check_fits_sampler`).
"""

from __future__ import annotations

from torch import Tensor

from training.models.config import (
    CAMERAS,
    PRESETS,
    RASTER_CHANNELS,
    VIEW_COLS,
    VIEW_ROWS,
    VIEW_SLOTS,
    ModelConfig,
)

__all__ = ["CAMERAS", "RASTER_CHANNELS", "VIEW_SLOTS"]

IMAGE_ROWS, IMAGE_COLS = PRESETS["nano"].image_size
FEATURE_ROWS, FEATURE_COLS = PRESETS["nano"].feature_grid
BEV_ROWS, BEV_COLS = VIEW_ROWS, VIEW_COLS
IMAGE_OFFSET, IMAGE_SCALE = 128, 1.0 / 64.0
RASTER_SCALE = 1.0 / 255.0


def real_images(images: Tensor) -> Tensor:
    """RGB uint8 -> the network's input values, (RGB - 128) / 64."""
    return (images.float() - IMAGE_OFFSET) * IMAGE_SCALE


def real_raster(raster: Tensor) -> Tensor:
    return raster.float() * RASTER_SCALE


def check_fits_sampler(config: ModelConfig) -> None:
    """ValueError if a network needs images or a view table of other sizes than the samples'."""
    wanted = (IMAGE_ROWS, IMAGE_COLS), (FEATURE_ROWS, FEATURE_COLS), (BEV_ROWS, BEV_COLS)
    found = config.image_size, config.feature_grid, config.bev_size
    if found != wanted:
        sizes = ", ".join("{} x {}".format(*size) for size in found)
        fitting = ", ".join("{} x {}".format(*size) for size in wanted)
        raise ValueError(
            f"network '{config.name}': found images, image features and BEV features of {sizes}, "
            f"wanted {fitting} as the samples have"
        )
