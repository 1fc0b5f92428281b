"""Averages the weights of two float model files of the same network.

    /usr/bin/python3 -m training.blend FIRST_float.onnx SECOND_float.onnx --share 0.35 --run RUN

Writes RUN/checkpoint.pt for `script/train --export-only RUN`. If the second network was fine-tuned
from the first one, the average keeps what the first does well and gains much of what the second has
learned (Wortsman et al., "Robust fine-tuning of zero-shot models", CVPR 2022).
"""

from __future__ import annotations

import argparse
from pathlib import Path

import torch

from tooling.errors import run_program
from training.checkpoint import new_checkpoint, state_of_weights, write_checkpoint
from training.config import TrainingConfig
from training.models.config import network_config
from training.models.network import BevNetwork
from training.rig_ranges import stated_ranges, to_store
from training.start_weights import load_model_file


def load_float_model(path: Path, config: TrainingConfig) -> BevNetwork:
    net = BevNetwork(network_config(config.network, config.view))
    load_model_file(net, path)
    return net


@torch.no_grad()
def blend(first: BevNetwork, second: BevNetwork, share: float) -> None:
    """Moves each weight of `first` by `share` of the way to that of `second`."""
    others = second.state_dict()
    for name, value in first.state_dict().items():
        if value.is_floating_point():
            value.lerp_(others[name], share)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("first", type=Path, help="float model file")
    parser.add_argument("second", type=Path, help="float model file")
    parser.add_argument("--share", type=float, required=True, help="of the second one, 0 to 1")
    parser.add_argument("--run", type=Path, required=True, help="folder for checkpoint.pt")
    parser.add_argument("--network", default="nano", help="as of training.train")
    parser.add_argument("--view", default="", help="as of training.train")
    arguments = parser.parse_args()
    if not 0.0 <= arguments.share <= 1.0:
        parser.error(f"--share: found {arguments.share:g}, wanted 0 to 1")
    try:
        network_config(arguments.network, arguments.view)
    except ValueError as error:
        parser.error(str(error))
    out = new_checkpoint(arguments.run)
    config = TrainingConfig(run=arguments.run, network=arguments.network, view=arguments.view)
    first, second = (load_float_model(path, config) for path in (arguments.first, arguments.second))
    blend(first, second, arguments.share)
    # The samples of the two runs are unknown here, and the ranges of their cameras come from these.
    ranges = [stated_ranges(path) for path in (arguments.first, arguments.second)]
    stored = to_store([found for found in ranges if found])
    arguments.run.mkdir(parents=True, exist_ok=True)
    write_checkpoint(state_of_weights(first.state_dict(), config.as_dict() | stored), out)
    print(out)


if __name__ == "__main__":
    run_program(main)
