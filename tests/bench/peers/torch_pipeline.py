"""Times the PyTorch float reference, from six decoded images and a map to a pose.

    /usr/bin/python3 -m tests.bench.peers.torch_pipeline --threads 1 --runs 20

prints the milliseconds of each part of each run as JSON. Network (training/models), raster
(training/nuscenes/raster.py) and solver (training/solver.py) are those of training; the solver's
sums of moved features are computed by the daemon's C++ code. The weights are random, because they
do not affect the time.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as functional
import yaml
from torch import Tensor

from training.data import view_table
from training.model import IMAGE_COLS, IMAGE_ROWS, real_images, real_raster
from training.models.config import PRESETS
from training.models.layers import channels_last
from training.models.network import BevNetwork
from training.nuscenes import raster
from training.solver import Solution

PARTS = ("images", "raster", "network", "solver")
SOLVER = "banded+refine"
_RIG = Path(__file__).resolve().parents[3] / "config/rig_demo.yaml"
_HORIZON_ROW = 14.0  # kNetworkHorizonRow
_ALL_CAMERAS = 0x3F
_MS_PER_S = 1e3
_SHRINK = 2  # camera pixels per network pixel, along each axis


def sampling_grid(camera: dict) -> Tensor:
    """The positions of the network's pixels in a camera's image for grid_sample(),
    [rows, cols, 2]. It assumes a level camera; the times do not depend on this."""
    width, height = camera["image_size_px"]
    k1, k2 = camera["distortion"][:2]
    scale = IMAGE_COLS / width
    v, u = torch.meshgrid(torch.arange(IMAGE_ROWS), torch.arange(IMAGE_COLS), indexing="ij")
    x = (u - ((camera["cx_px"] + 0.5) * scale - 0.5)) / (camera["fx_px"] * scale)
    y = (v - _HORIZON_ROW) / (camera["fy_px"] * scale)
    r2 = x * x + y * y
    bent = 1 + k1 * r2 + k2 * r2 * r2
    col = camera["fx_px"] * x * bent + camera["cx_px"]
    row = camera["fy_px"] * y * bent + camera["cy_px"]
    return torch.stack(((2 * col + 1) / width - 1, (2 * row + 1) / height - 1), dim=-1)


def street() -> list[np.ndarray]:
    """The segments of each class on a typical street: three dividers, a crossing and four
    boundaries, with a point every 4 m."""
    stations = np.arange(-32.0, 32.0, 4.0)

    def line(y: float) -> np.ndarray:
        from_to = [[(x, y), (x + 4.0, y + 0.1)] for x in stations]
        return np.array(from_to)

    crossing = np.array([[(10.0, -7.0), (10.0, 7.0)], [(13.0, -7.0), (13.0, 7.0)]])
    dividers = np.concatenate([line(y) for y in (-3.5, 0.0, 3.5)])
    boundaries = np.concatenate([line(y) for y in (-12.0, -7.0, 7.0, 12.0)])
    return [dividers, crossing, boundaries]


class Pipeline:
    """Processes one frameset, part by part. Each part stores its result for the next one."""

    def __init__(self) -> None:
        torch.manual_seed(1)
        cameras = yaml.safe_load(_RIG.read_text())["cameras"].values()
        self.grid = torch.stack([sampling_grid(camera) for camera in cameras])
        width, height = next(iter(cameras))["image_size_px"]
        self.camera_images = [
            torch.randint(256, (height, width, 3), dtype=torch.uint8) for _ in range(len(cameras))
        ]
        index, weight = view_table(_ALL_CAMERAS)
        self.table = index[None], weight[None]
        self.segments = street()
        self.net = channels_last(BevNetwork(PRESETS["nano"]).eval())

    def images(self) -> None:
        images = torch.stack(self.camera_images).permute(0, 3, 1, 2).float()
        shrunk = functional.avg_pool2d(images, _SHRINK)
        sampled = functional.grid_sample(shrunk, self.grid, align_corners=False)
        self.image_input = real_images(sampled)[None]

    def raster(self) -> None:
        drawn = raster.draw(self.segments, raster.DEFAULT_LINE_WIDTH_CELLS)
        self.raster_input = real_raster(torch.from_numpy(drawn))[None]

    def network(self) -> None:
        net = self.net
        self.bev = net.bev_compress(net.perceive(self.image_input, *self.table))
        self.map = net.map_compress(net.map_encoder(self.raster_input))

    def solver(self) -> Solution:
        return self.net.solvers.solve(SOLVER, self.bev, self.map)


@torch.no_grad()
def times_ms(runs: int) -> dict[str, list[float]]:
    """The times of each part, after one untimed run."""
    pipeline = Pipeline()
    times: dict[str, list[float]] = {part: [] for part in PARTS}
    for run in range(runs + 1):
        for part in PARTS:
            start = time.perf_counter()
            getattr(pipeline, part)()
            if run > 0:
                times[part].append(_MS_PER_S * (time.perf_counter() - start))
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--runs", type=int, default=20)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    print(json.dumps(times_ms(arguments.runs)))


if __name__ == "__main__":
    main()
