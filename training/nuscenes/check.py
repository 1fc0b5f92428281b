"""Reads every sample of a nuScenes tree, reports the bad ones and draws some for inspection.

    /usr/bin/python3 -m training.nuscenes.check DIR --scenes FILE --draw 20 --out sheets

A sheet shows the six network images with the map's lines projected into them, and the raster. If
calibration, ego poses and map are right, the lines lie on the lines in the images.
"""

from __future__ import annotations

import argparse
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from PIL import Image

from tooling.option_types import whole_number
from training.nuscenes.camera import HEIGHT_PX, WIDTH_PX, look_through
from training.nuscenes.dataset import NuscenesDataset, View
from training.nuscenes.errors import NuscenesError
from training.nuscenes.geometry import inverse_se3
from training.nuscenes.problems import Problems

EXIT_BAD_SAMPLES = 1
EXIT_BAD_TREE = 2
COLOURS = ((255, 160, 0), (60, 120, 255), (255, 40, 40))  # dividers, crossings, boundaries
_POINTS_PER_M = 20
_NEAREST_M = 1.0  # closer points are not projected


def check(dataset: NuscenesDataset) -> Problems:
    """Makes every sample once and returns the problems found."""
    problems = Problems()

    def try_sample(position: int) -> None:
        try:
            dataset.sample(position, np.zeros(3))
        except NuscenesError as error:
            problems.add(dataset.sample_tokens[position], error)

    with ThreadPoolExecutor(os.cpu_count()) as workers:
        list(workers.map(try_sample, range(len(dataset))))
    return problems


def sheet(dataset: NuscenesDataset, position: int) -> Image.Image:
    """The six images in two rows, magnified twice, with the raster of the true pose beside them."""
    token = dataset.sample_tokens[position]
    segments = dataset.map_segments(token, dataset.map_from_vehicle(token))
    layers = [_points(layer) for layer in segments]
    images = np.stack([_image(view, layers) for view in dataset.views(token)])
    grid = images.reshape(2, 3, HEIGHT_PX, WIDTH_PX, 3).transpose(0, 2, 1, 3, 4)
    grid = grid.reshape(2 * HEIGHT_PX, 3 * WIDTH_PX, 3).repeat(2, axis=0).repeat(2, axis=1)
    drawn = dataset.sample(position, np.zeros(3)).raster_truth[..., None] / 255.0
    raster = (drawn * np.array(COLOURS)[:, None, None]).max(0).astype(np.uint8)
    height = max(len(grid), len(raster))
    columns = [np.pad(part, ((0, height - len(part)), (0, 0), (0, 0))) for part in (grid, raster)]
    return Image.fromarray(np.concatenate(columns, axis=1))


def _points(segments: np.ndarray) -> np.ndarray:
    """Points [n, 3] on the ground along segments [n, 2, 2]."""
    length = np.hypot(*(segments[:, 1] - segments[:, 0]).T)
    count = np.ceil(length * _POINTS_PER_M).astype(int) + 1
    part = np.concatenate([np.empty(0), *(np.linspace(0, 1, n) for n in count)])[:, None]
    start, end = (np.repeat(segments[:, i], count, axis=0) for i in range(2))
    return np.pad(start + part * (end - start), ((0, 0), (0, 1)))


def _image(view: View, layers: list[np.ndarray]) -> np.ndarray:
    """The network image [96, 320, 3] with the map's lines drawn in."""
    image = look_through(view.path, view.real, view.network).transpose(1, 2, 0).copy()
    camera_from_vehicle = inverse_se3(view.vehicle_from_camera)
    for points, colour in zip(layers, COLOURS):
        seen = points @ camera_from_vehicle[:3, :3].T + camera_from_vehicle[:3, 3]
        x, y, z = seen[seen[:, 2] > _NEAREST_M].T
        col = np.rint(view.network.fx_px * x / z + view.network.cx_px).astype(int)
        row = np.rint(view.network.fy_px * y / z + view.network.cy_px).astype(int)
        inside = (col >= 0) & (col < WIDTH_PX) & (row >= 0) & (row < HEIGHT_PX)
        image[row[inside], col[inside]] = colour
    return image


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=Path, help="folder with v1.0-*, samples and maps")
    parser.add_argument(
        "--scenes", type=Path, help="file with one scene name per line; default: all scenes"
    )
    parser.add_argument("--version", default="", help="v1.0-*, if there are several")
    parser.add_argument(
        "--draw", type=whole_number(0), default=0, help="number of sheets, spread over all samples"
    )
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the sheets")
    options = parser.parse_args()
    try:
        dataset = NuscenesDataset(options.root, options.scenes, options.version)
    except NuscenesError as error:
        print(error, file=sys.stderr)
        sys.exit(EXIT_BAD_TREE)
    problems = check(dataset)
    print(f"{len(dataset)} samples: {problems.summary()}")
    good = [i for i, token in enumerate(dataset.sample_tokens) if token not in problems.messages]
    options.out.mkdir(parents=True, exist_ok=True)
    for position in good[:: max(1, len(good) // max(1, options.draw))][: options.draw]:
        path = options.out / f"{dataset.sample_tokens[position]}.png"
        sheet(dataset, position).save(path)
    sys.exit(EXIT_BAD_SAMPLES if problems.messages else 0)


if __name__ == "__main__":
    main()
