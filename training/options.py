"""The command line of training.train."""

from __future__ import annotations

import argparse
import dataclasses

from training.config import FIRST_TRAINING_SEED, TrainingConfig
from training.data import NUISANCES
from training.model import check_fits_sampler
from training.models.config import network_config
from training.nuscenes.stream import ON_ERROR
from training.precision import PRECISIONS
from training.sampler_process import Drives

REFERENCES = ("file", "own", "truth")
_CHOICES = {
    "precision": PRECISIONS,
    "nuisances": NUISANCES,
    "on_error": ON_ERROR,
    "reference": REFERENCES,
}


def parse_config(arguments: list[str], description: str, processes: int = 1) -> TrainingConfig:
    """Parses the options, one per field of TrainingConfig. Invalid options end the program with a
    message. `processes`: number of processes of the run."""
    parser = argparse.ArgumentParser(
        prog="training.train", description=description, allow_abbrev=False
    )
    for field in dataclasses.fields(TrainingConfig):
        option = _option_name(field.name)
        if isinstance(field.default, bool):
            parser.add_argument(option, action="store_true")
        else:
            parser.add_argument(option, type=type(field.default), default=field.default)
    config = TrainingConfig(**vars(parser.parse_args(arguments)))
    try:
        _check(config, processes)
    except ValueError as error:
        parser.error(str(error))
    return config


def add_drive_options(parser: argparse.ArgumentParser) -> None:
    """The options of TrainingConfig that name recorded drives, for other programs."""
    fields = {field.name: field for field in dataclasses.fields(TrainingConfig)}
    for name in ("recordings", "map", "rig", "reference", "on_error"):
        choices = _CHOICES.get(name)
        parser.add_argument(_option_name(name), default=fields[name].default, choices=choices)


def drives_of(options: argparse.Namespace | TrainingConfig) -> Drives:
    """The drives that these options name."""
    return Drives(
        options.recordings,
        options.map,
        options.rig,
        options.reference,
        options.on_error == "skip",
    )


def _option_name(field: str) -> str:
    return "--" + field.replace("_", "-")


def _check(config: TrainingConfig, processes: int) -> None:
    """ValueError if the options contradict each other or have invalid values."""
    if (config.minutes > 0) == (config.samples > 0):
        found = "both" if config.minutes > 0 else "none"
        raise ValueError(f"budget: found {found}, wanted either --minutes or --samples")
    for field, choices in _CHOICES.items():
        if (found := getattr(config, field)) not in choices:
            wanted = f"wanted one of {', '.join(choices)}"
            raise ValueError(f"{_option_name(field)}: found '{found}', {wanted}")
    if config.batch < 1 or config.batch % processes:
        wanted = f"wanted a positive multiple of {processes} processes"
        raise ValueError(f"--batch: found {config.batch}, {wanted}")
    _check_ranges(config)
    if config.recordings and config.nuscenes:
        raise ValueError("--recordings: found --nuscenes too, wanted one of them")
    if config.validation_scenes and not config.scenes:
        wanted = "wanted both, so that no scene is trained on and measured"
        raise ValueError(f"--validation-scenes: found no --scenes, {wanted}")
    if bool(config.recordings) != bool(config.map):
        raise ValueError("--recordings and --map: found one of them, wanted both or none")
    check_fits_sampler(network_config(config.network, config.view))


def _check_ranges(config: TrainingConfig) -> None:
    if config.seed < FIRST_TRAINING_SEED:
        wanted = f"wanted at least {FIRST_TRAINING_SEED}, because evaluation has the others"
        raise ValueError(f"--seed: found {config.seed}, {wanted}")
    for field in ("checkpoint_minutes", "validation_minutes"):
        if (minutes := getattr(config, field)) <= 0:
            raise ValueError(f"{_option_name(field)}: found {minutes:g} minutes, wanted more")
    for field in ("simulated_share", "usual_share"):
        if not 0.0 <= (share := getattr(config, field)) < 1.0:
            wanted = "wanted at least 0 and less than 1"
            raise ValueError(f"{_option_name(field)}: found {share:g}, {wanted}")
