"""Features of a synthetic scene under a known correction, for tests and golden vectors."""

from __future__ import annotations

import math
from collections.abc import Callable

import torch
from torch import Tensor


def smooth_scene(
    channels: int, seed: int, max_frequency: float, components: int = 60
) -> Callable[[Tensor], Tensor]:
    """A random function of the ground, band-limited to `max_frequency` cycles/m: points [..., 2] in
    metres -> values [..., channels]."""
    generator = torch.Generator().manual_seed(seed)
    angle = torch.rand(components, generator=generator) * math.pi
    frequency = 0.05 + (max_frequency - 0.05) * torch.rand(components, generator=generator)
    wave = torch.stack((frequency * angle.cos(), frequency * angle.sin()))
    phase = torch.rand(components, generator=generator) * 2 * math.pi
    mix = torch.randn(components, channels, generator=generator)

    def scene(points: Tensor) -> Tensor:
        return torch.sin(2 * math.pi * (points @ wave) + phase) @ mix

    return scene


def cell_centres(rows: int = 100, cols: int = 50, cell_m: float = 0.6) -> Tensor:
    """Vehicle-frame (x, y) of every cell, [rows, cols, 2]."""
    x = (0.5 * rows - 0.5 - torch.arange(rows)) * cell_m
    y = (0.5 * cols - 0.5 - torch.arange(cols)) * cell_m
    return torch.stack(torch.meshgrid(x, y, indexing="ij"), dim=-1)


def features_under(
    correction: Tensor, seed: int, max_frequency: float = 0.2, channels: int = 8
) -> tuple[Tensor, Tensor]:
    """F_B and F_M [1, C, 100, 50] of one scene. A point p_B in the vehicle frame lies at
    R(a) p_B + t on the map, with correction = (x, y, a) and t = (x, y)."""
    scene = smooth_scene(channels, seed, max_frequency)
    points = cell_centres()
    x, y, yaw = correction.tolist()
    rotation = torch.tensor([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    on_map = points @ rotation.T + torch.tensor([x, y])
    return scene(on_map).permute(2, 0, 1)[None], scene(points).permute(2, 0, 1)[None]
