"""Reads and writes checkpoints; refuses unreadable and unsuitable ones with a one-line error.

    /usr/bin/python3 -m training.checkpoint training/runs/nano/checkpoint.pt

prints the name of the checkpoint's network.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import torch

from tooling.errors import run_program
from training.compact import unpack
from training.errors import CheckpointError, TrainingError
from training.models.config import ModelConfig, network_config
from training.models.network import BevNetwork

# The network of old checkpoints, which do not name theirs.
_FIRST_NETWORK = {"network": "nano", "view": ""}


def read_checkpoint(path: Path, device: str | torch.device = "cpu") -> dict[str, Any]:
    """The state that Trainer.save wrote. CheckpointError if it cannot be read."""
    if not path.is_file():
        raise CheckpointError(f"{path}: no such file, wanted a checkpoint")
    try:
        state = torch.load(path, map_location=device)
    except Exception as error:  # corrupt files make pickle and the archive reader raise anything
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise CheckpointError(f"{path}: unreadable as a checkpoint ({reason})") from error
    for key in ("model", "ema", "samples", "config"):
        if not isinstance(state, dict) or key not in state:
            raise CheckpointError(
                f"{path}: found no '{key}', wanted a checkpoint of training.train"
            )
    return unpack(state)


def state_of_weights(
    weights: dict[str, Any], config: dict[str, Any], samples: int = 0
) -> dict[str, Any]:
    """The state of a checkpoint with finished weights, which are also its averaged weights.
    `config`: what TrainingConfig.as_dict() gives; an export measures ranges and scales on samples
    with these options. `rig_ranges` is added where it is known (rig_ranges.py)."""
    return {"model": weights, "ema": weights, "samples": samples, "config": config}


def new_checkpoint(run: Path) -> Path:
    """The file for the checkpoint of a new run. TrainingError if the folder holds a run."""
    path = run / "checkpoint.pt"
    if path.exists():
        raise TrainingError(f"{path}: found a run, wanted another folder for --run")
    return path


def write_checkpoint(state: dict[str, Any], path: Path) -> None:
    """Replaces a checkpoint, which stays as it was if the process is killed or the disk is full."""
    partial = path.with_suffix(".partial")
    torch.save(state, partial)
    partial.replace(path)


def nuisances_of(path: Path) -> str:
    """The nuisances of a checkpoint's training samples (TrainingConfig.nuisances). Runs that are
    older than this option had the usual ones."""
    return str(read_checkpoint(path)["config"].get("nuisances", "usual"))


def network_of(state: dict[str, Any], path: Path) -> ModelConfig:
    """The network configuration of a checkpoint. CheckpointError if it is unknown."""
    chosen = {key: state["config"].get(key, first) for key, first in _FIRST_NETWORK.items()}
    try:
        return network_config(chosen["network"], chosen["view"])
    except ValueError as error:
        raise CheckpointError(f"{path}: {error}") from error


def load_weights(net: BevNetwork, state: dict[str, Any], weights: str, path: Path) -> None:
    """Loads a checkpoint's weights into `net`. `weights`: "model" for the last ones, "ema" for
    their moving average. CheckpointError if they do not fit."""
    found = network_of(state, path)
    if found != net.config:
        raise CheckpointError(
            f"{path}: holds the network '{found.name}', wanted '{net.config.name}'"
        )
    try:
        net.load_state_dict(state[weights])
    except (AttributeError, RuntimeError, TypeError) as error:
        first, *details = (line.strip() for line in str(error).splitlines())
        reason = details[0] if details else first
        raise CheckpointError(
            f"{path}: the weights do not fit the current network '{found.name}' ({reason})"
        ) from error


def load_network(path: Path, averaged: bool = True) -> BevNetwork:
    """The network of a checkpoint in evaluation mode, with the averaged or the last weights."""
    state = read_checkpoint(path)
    net = BevNetwork(network_of(state, path))
    load_weights(net, state, "ema" if averaged else "model", path)
    return net.eval()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint", type=Path)
    path = parser.parse_args().checkpoint
    print(network_of(read_checkpoint(path), path).name)


if __name__ == "__main__":
    run_program(main)
