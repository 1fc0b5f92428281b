"""Prepares the photographs of training/photos.txt for the simulator (sim/render/photo_library.h).

    /usr/bin/python3 -m training.photos --out build/photos

Writes one square PNG file for each photograph and the index photos.txt.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

LIST = Path(__file__).with_name("photos.txt")
TORCS = Path("/usr/share/games/torcs")
PANEL_SIDE_PX = 256
GROUND_TEXEL_M = 0.05
GROUND_USES = ("asphalt", "concrete", "paving", "grass", "dirt", "gravel")
SEAM_SHARE = 0.125  # of the side: opposite edges of ground are blended over it


@dataclass(frozen=True)
class Photo:
    """One line of photos.txt."""

    use: str
    side_m: float
    path: Path
    part: tuple[float, float, float, float]  # left, top, right, bottom as shares

    @property
    def is_ground(self) -> bool:
        return self.use in GROUND_USES

    @property
    def side_px(self) -> int:
        return round(self.side_m / GROUND_TEXEL_M) if self.is_ground else PANEL_SIDE_PX


def read_list(text: str, folder: Path) -> list[Photo]:
    """The photographs of a list; ValueError with the line if one is not understood."""
    photos = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split("#")[0].split()
        if not words:
            continue
        if len(words) not in (3, 7):
            raise ValueError(f"line {number}: found {len(words)} words, wanted 3 or 7: '{line}'")
        numbers = [float(word) for word in words[3:]] or [0.0, 0.0, 1.0, 1.0]
        left, top, right, bottom = numbers
        photos.append(
            Photo(words[0], float(words[1]), folder / words[2], (left, top, right, bottom))
        )
    return photos


def without_seam(pixels: np.ndarray, axis: int) -> np.ndarray:
    """The picture, shorter by SEAM_SHARE along an axis, whose end fits its start without a seam."""
    pixels = np.moveaxis(pixels, axis, 0)
    seam = int(len(pixels) * SEAM_SHARE)
    weight = np.linspace(0.0, 1.0, seam).reshape(-1, *[1] * (pixels.ndim - 1))
    start = weight * pixels[:seam] + (1.0 - weight) * pixels[-seam:]
    return np.moveaxis(np.concatenate([start, pixels[seam:-seam]]), 0, axis)


def square(photo: Photo, picture: Image.Image) -> Image.Image:
    """The part of a picture that is used, in the size that the simulator reads. The simulator
    takes black for a hole, so no other pixel is black."""
    width, height = picture.size
    left, top, right, bottom = photo.part
    part = picture.crop(
        (int(left * width), int(top * height), int(right * width), int(bottom * height))
    ).convert("RGBA")
    pixels = np.asarray(part, np.float64)
    if photo.is_ground:
        pixels = without_seam(without_seam(pixels, 0), 1)
    side = (photo.side_px, photo.side_px)
    scaled = np.asarray(Image.fromarray(pixels.astype(np.uint8)).resize(side, Image.BICUBIC))
    colours = np.maximum(scaled[..., :3], 1)
    if photo.use == "crown":
        colours = np.where(scaled[..., 3:] < 128, 0, colours)
    return Image.fromarray(colours.astype(np.uint8))


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="training.photos", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder to write")
    parser.add_argument("--torcs", type=Path, default=TORCS, help="folder of torcs-data")
    options = parser.parse_args(arguments)
    photos = read_list(LIST.read_text(), options.torcs)
    missing = [str(photo.path) for photo in photos if not photo.path.is_file()]
    if missing:
        print(f"photos: found no file {missing[0]}; install torcs-data", file=sys.stderr)
        return 1
    options.out.mkdir(parents=True, exist_ok=True)
    index = []
    for number, photo in enumerate(photos):
        name = f"{photo.use}_{number}.png"
        with Image.open(photo.path) as picture:
            square(photo, picture).save(options.out / name)
        index.append(f"{photo.use} {name} {photo.side_px} {photo.side_m:g}\n")
    (options.out / "photos.txt").write_text("".join(index))
    print(f"photos: {len(photos)} photographs in {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
