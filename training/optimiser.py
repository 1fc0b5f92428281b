"""The optimiser of a run: its groups of parameters and its learning rate."""

from __future__ import annotations

import math

import torch

from training.config import TrainingConfig
from training.models.network import BevNetwork


def make_optimiser(net: BevNetwork, config: TrainingConfig) -> torch.optim.Optimizer:
    """Each group has the "factor" by which its learning rate exceeds learning_rate()."""
    scales = list(net.solvers.parameters())
    rest = [p for p in net.parameters() if not any(p is scale for scale in scales)]
    groups: list[dict] = [
        {
            "params": [p for p in rest if p.ndim > 1],
            "weight_decay": config.weight_decay,
            "factor": 1.0,
        },
        {"params": [p for p in rest if p.ndim <= 1], "weight_decay": 0.0, "factor": 1.0},
        {"params": scales, "weight_decay": 0.0, "factor": config.scale_rate_factor},
    ]
    return torch.optim.AdamW(groups, lr=config.learning_rate, betas=(0.9, 0.98))


def learning_rate(config: TrainingConfig, step: int, spent: float) -> float:
    """The rate of a step. `spent`: share of the budget."""
    warm = min(1.0, (step + 1) / max(1, config.warm_up_steps))
    annealed = max(0.0, spent - config.anneal_from) / max(1e-9, 1.0 - config.anneal_from)
    final = config.final_rate
    cosine = final + (1 - final) * 0.5 * (1 + math.cos(math.pi * annealed))
    return config.learning_rate * warm * cosine
