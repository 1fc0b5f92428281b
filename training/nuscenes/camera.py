"""The network camera: a scaled crop of a real one (pipeline/preprocessing/network_camera.h)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from training.nuscenes.errors import (
    CalibrationError,
    MissingFileError,
    UnreadableImageError,
    WrongSizeError,
)

if TYPE_CHECKING:  # training on the simulator's samples does without it
    from PIL import Image

WIDTH_PX, HEIGHT_PX = 320, 96
HORIZON_ROW = 14.0
# JPEG files may be decoded at half their size or less, as long as so many columns remain.
_DECODED_COLUMNS = 2 * WIDTH_PX
# Least vertical component of the camera's down axis: refuses cameras that lie on their side or look
# along the vertical.
_MIN_UPRIGHT = 0.1


@dataclass(frozen=True, slots=True)
class Pinhole:
    """A pinhole camera. (0, 0) is the centre of the top left pixel."""

    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float


def network_camera(real: Pinhole, vehicle_from_camera: np.ndarray) -> Pinhole:
    """The network camera of a real one: the full width is scaled to 320 columns, and the 96 rows
    are chosen so that the horizon of a level vehicle lies in row 14 at the principal column.
    vehicle_from_camera [4, 4] is the calibration. CalibrationError if it is impossible."""
    camera_down, camera_forward = vehicle_from_camera[2, 1], vehicle_from_camera[2, 2]
    if real.fx_px <= 0 or real.fy_px <= 0:
        raise CalibrationError(
            f"found focal lengths {real.fx_px} and {real.fy_px}, wanted positive ones"
        )
    if abs(camera_down) < _MIN_UPRIGHT:
        raise CalibrationError(
            "found a camera on its side or facing the ground, wanted an upright one"
        )
    scale = WIDTH_PX / real.width_px
    f_px = real.fx_px * scale
    return Pinhole(
        width_px=WIDTH_PX,
        height_px=HEIGHT_PX,
        fx_px=f_px,
        fy_px=f_px,
        cx_px=(real.cx_px + 0.5) * scale - 0.5,
        cy_px=HORIZON_ROW + f_px * camera_forward / camera_down,
    )


def look_through(path: Path, real: Pinhole, network: Pinhole) -> np.ndarray:
    """Reads an image file and resamples it to the network camera: RGB planes uint8 [3, 96, 320],
    black outside the real camera's image. NuscenesError if the file is missing, unreadable or of
    another size."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            if image.size != (real.width_px, real.height_px):
                found = "x".join(map(str, image.size))
                wanted = f"{real.width_px}x{real.height_px}"
                raise WrongSizeError(f"{path}: found {found} pixels, wanted {wanted}")
            image.draft("RGB", (_DECODED_COLUMNS, 1))
            pixels = _resample(image.convert("RGB"), real, network)
    except FileNotFoundError:
        raise MissingFileError(f"{path}: found no such file, wanted an image") from None
    except (OSError, SyntaxError) as error:
        raise UnreadableImageError(f"{path}: unreadable as an image ({error})") from None
    return np.ascontiguousarray(np.asarray(pixels).transpose(2, 0, 1))


def _resample(image: Image.Image, real: Pinhole, network: Pinhole) -> Image.Image:
    """Crops and scales in one pass. Pillow's bilinear filter (a triangle whose width follows the
    scale) preserves the position of a line to 0.01 pixels. A box filter over whole pixels would
    shift it by 0.1 pixels, which is 0.25 m at a distance of 30 m."""
    from PIL import Image

    reduced = image.width / real.width_px
    per_row = real.fy_px / network.fy_px
    top = reduced * (real.cy_px + 0.5 - (network.cy_px + 0.5) * per_row)
    bottom = top + reduced * network.height_px * per_row
    # The filter reads beyond the crop. Pillow fills rows outside the image with black.
    reach = int(np.ceil(reduced * per_row)) + 1
    first, last = int(np.floor(top)) - reach, int(np.ceil(bottom)) + reach
    rows = image.crop((0, first, image.width, last))
    return rows.resize(
        (network.width_px, network.height_px),
        Image.Resampling.BILINEAR,
        box=(0, top - first, image.width, bottom - first),
    )
