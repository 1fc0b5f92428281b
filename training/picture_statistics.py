"""Compares the simulator's pictures with real ones, as the network sees them.

    /usr/bin/python3 -m training.picture_statistics --photos build/photos --real DIR --rig FILE

Prints a Markdown table with a row for each kind of sample, and one for the pictures of --real: a
folder with front.jpg, back.jpg, ... of the cameras of --rig.
"""

from __future__ import annotations

import argparse
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np
import yaml
from PIL import Image

from tooling.errors import run_program
from tooling.markdown import row, table
from tooling.option_types import positive
from training.data import SamplerStream
from training.errors import TrainingError
from training.model import IMAGE_COLS, IMAGE_ROWS

SEED = 1_700_000
HORIZON_ROW = 14.0  # pipeline/preprocessing/network_camera.h
LUMA = np.array([0.299, 0.587, 0.114])


@dataclass(frozen=True)
class Statistics:
    """Means over pictures, in 8-bit steps unless stated otherwise."""

    brightness: float
    contrast: float  # standard deviation of the brightness in a picture
    road_range: float  # from the 10th to the 90th percentile in the lower half
    saturation: float  # 0 to 1
    red_blue: float  # absolute difference of red and blue
    gradient: float  # between neighbouring pixels
    laplacian: float  # absolute value: sharpness and noise
    spectrum: float  # slope of the logarithmic power over the logarithmic frequency of rows


def statistics_of(pictures: np.ndarray) -> Statistics:
    """`pictures`: uint8 [count, rows, columns, 3]."""
    colour = pictures.astype(np.float64)
    luma = colour @ LUMA
    most, least = colour.max(-1), colour.min(-1)
    across = np.diff(luma, axis=2)[:, :-1]
    down = np.diff(luma, axis=1)[:, :, :-1]
    inner = luma[:, 1:-1, 1:-1]
    around = luma[:, :-2, 1:-1] + luma[:, 2:, 1:-1] + luma[:, 1:-1, :-2] + luma[:, 1:-1, 2:]
    low, high = np.percentile(luma[:, luma.shape[1] // 2 :], (10, 90), axis=(1, 2))
    rows = (luma - luma.mean(2, keepdims=True)) * np.hanning(luma.shape[2])
    power = (np.abs(np.fft.rfft(rows, axis=2)) ** 2).mean((0, 1))
    band = slice(4, len(power) * 3 // 4)
    frequency = np.arange(len(power))[band]
    return Statistics(
        brightness=luma.mean(),
        contrast=luma.std((1, 2)).mean(),
        road_range=(high - low).mean(),
        saturation=((most - least) / np.maximum(most, 1.0)).mean(),
        red_blue=np.abs(colour[..., 0] - colour[..., 2]).mean(),
        gradient=np.hypot(across, down).mean(),
        laplacian=np.abs(4.0 * inner - around).mean(),
        spectrum=np.polyfit(np.log(frequency), np.log(power[band]), 1)[0],
    )


def simulated(nuisances: str, photos: str, samples: int) -> np.ndarray:
    stream = SamplerStream(SEED, 0, 1, 0.0, nuisances=nuisances, photos=photos)
    images = np.concatenate([stream.next(8).images.numpy() for _ in range(0, samples, 8)])
    stream.close()
    return images.reshape(-1, 3, IMAGE_ROWS, IMAGE_COLS).transpose(0, 2, 3, 1)


def network_crop(picture: Image.Image, principal_row: float) -> np.ndarray:
    """The picture at the network's width, with its principal row at the network's horizon. Rows
    beyond the picture repeat its last one."""
    scale = IMAGE_COLS / picture.width
    size = (IMAGE_COLS, round(picture.height * scale))
    pixels = np.asarray(picture.convert("RGB").resize(size, Image.BOX))
    top = max(0, round((principal_row + 0.5) * scale - 0.5 - HORIZON_ROW))
    rows = np.minimum(np.arange(top, top + IMAGE_ROWS), len(pixels) - 1)
    return pixels[rows]


def real(folder: Path, rig: Path) -> np.ndarray:
    """The pictures of a folder as the network sees them. TrainingError if there is none."""
    crops = []
    for name, camera in yaml.safe_load(rig.read_text())["cameras"].items():
        for file in sorted(folder.glob(f"{name}.*")):
            with Image.open(file) as picture:
                crops.append(network_crop(picture, camera["cy_px"]))
    if not crops:
        raise TrainingError(f"{folder}: found no picture of a camera of {rig}, wanted one of each")
    return np.stack(crops)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=positive, default=64, help="of each kind")
    parser.add_argument("--photos", default="", help="folder of script/photos")
    parser.add_argument("--real", type=Path, help="folder with one picture of each camera")
    parser.add_argument("--rig", type=Path, help="rig file of --real")
    options = parser.parse_args()
    if bool(options.real) != bool(options.rig):
        parser.error("--real and --rig: found one of them, wanted both or none")
    names = [field.name.replace("_", " ") for field in fields(Statistics)]
    # Before the samples are rendered, so that a missing picture is named at once.
    real_pictures = real(options.real, options.rig) if options.real else None
    print(table(("pictures", *names), ()), end="")

    def print_row(name: str, pictures: np.ndarray) -> None:
        values = [f"{value:.2f}" for value in astuple(statistics_of(pictures))]
        print(row([name, *values]), flush=True)

    for nuisances in ("usual", "street"):
        print_row(f"{nuisances} samples", simulated(nuisances, "", options.samples))
    if options.photos:
        with_photos = simulated("street", options.photos, options.samples)
        print_row("street samples, photographs", with_photos)
    if real_pictures is not None:
        print_row("real frame", real_pictures)


if __name__ == "__main__":
    run_program(main)
