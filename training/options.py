"""The command line of training.train."""

from __future__ import annotations

import argparse
import dataclasses

from training.config import TrainingConfig
from training.data import NUISANCES
from training.model import check_fits_sampler
from training.models.config import network_config
from training.nuscenes.stream import ON_ERROR
from training.precision import PRECISIONS

_CHOICES = {"precision": PRECISIONS, "nuisances": NUISANCES, "on_error": ON_ERROR}


def parse_config(arguments: list[str], description: str, processes: int = 1) -> TrainingConfig:
    """Every field of TrainingConfig is an option. Ends the program where they make no sense."""
    parser = argparse.ArgumentParser(prog="training.train", description=description)
    for field in dataclasses.fields(TrainingConfig):
        option = "--" + field.name.replace("_", "-")
        if isinstance(field.default, bool):
            parser.add_argument(option, action="store_true")
        else:
            parser.add_argument(option, type=type(field.default), default=field.default)
    config = TrainingConfig(**vars(parser.parse_args(arguments)))
    if (config.minutes > 0) == (config.samples > 0):
        parser.error("give the budget: either --minutes or --samples")
    for option, choices in _CHOICES.items():
        if (found := getattr(config, option)) not in choices:
            name = option.replace("_", "-")
            parser.error(f"--{name}: found '{found}', wanted one of {', '.join(choices)}")
    if config.batch < 1 or config.batch % processes:
        parser.error(f"--batch: found {config.batch}, wanted a multiple of {processes} processes")
    for option in ("checkpoint_minutes", "validation_minutes"):
        if getattr(config, option) <= 0:
            minutes = getattr(config, option)
            parser.error(f"--{option.replace('_', '-')}: found {minutes:g} minutes, wanted more")
    try:
        check_fits_sampler(network_config(config.network, config.view))
    except ValueError as error:
        parser.error(str(error))
    return config
