"""The command line of training.train."""

from __future__ import annotations

import argparse
import dataclasses
import math
from collections.abc import Callable

from training.config import FIRST_TRAINING_SEED, TrainingConfig
from training.data import NUISANCES, SamplerStream
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

# The fields of TrainingConfig that name recorded drives and say how they are read.
DRIVE_FIELDS = ("recordings", "map", "rig", "reference", "on_error")
# Options that mean nothing without another one.
_NEEDED = {"scenes": "nuscenes", "nuscenes_version": "nuscenes", "rig": "recordings"}
# The numbers that an option may have, never nan or inf, and the fields with this range.
_RANGES: tuple[tuple[str, Callable[[float], bool], tuple[str, ...]], ...] = (
    ("1 to 1024", lambda value: 1 <= value <= 1024, ("threads", "sampler_threads")),
    ("at least 1", lambda value: 1 <= value < math.inf, ("batch", "log_steps")),
    ("less than 2^63", lambda value: value < 2**63, ("seed",)),
    (
        "at least 0",
        lambda value: 0 <= value < math.inf,
        (
            *("minutes", "samples", "stop_after_minutes", "validation_samples", "patience"),
            *("scale_rate_factor", "warm_up_steps", "weight_decay"),
            *("joint_weight", "decoupled_weight", "refined_weight"),
        ),
    ),
    (
        "more than 0",
        lambda value: 0 < value < math.inf,
        (
            *("learning_rate", "clip_norm", "line_width_cells"),
            *("checkpoint_minutes", "validation_minutes"),
        ),
    ),
    (
        "0 to 1",
        lambda value: 0 <= value <= 1,
        (
            *("drop_camera_probability", "final_rate", "anneal_from", "ema_decay"),
            "semantic_stage",
        ),
    ),
    (
        "at least 0 and less than 1",
        lambda value: 0 <= value < 1,
        ("simulated_share", "usual_share"),
    ),
)


def parse_config(arguments: list[str], description: str, processes: int = 1) -> TrainingConfig:
    """Parses the options, one per field of TrainingConfig. Invalid options end the program with a
    message. `processes`: number of processes of the run."""
    parser = argparse.ArgumentParser(
        prog="training.train", description=description, allow_abbrev=False
    )
    for field in dataclasses.fields(TrainingConfig):
        option = option_name(field.name)
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
    for name in DRIVE_FIELDS:
        choices = _CHOICES.get(name)
        parser.add_argument(option_name(name), default=fields[name].default, choices=choices)


def drives_of(options: argparse.Namespace | TrainingConfig) -> Drives:
    """The drives that these options name."""
    return Drives(
        options.recordings,
        options.map,
        options.rig,
        options.reference,
        options.on_error == "skip",
    )


def option_name(field: str) -> str:
    return "--" + field.replace("_", "-")


def _check(config: TrainingConfig, processes: int) -> None:
    """ValueError if the options contradict each other or have invalid values."""
    _check_ranges(config)
    _check_seed(config, processes)
    if (config.minutes > 0) == (config.samples > 0):
        found = "both" if config.minutes > 0 else "none"
        raise ValueError(f"budget: found {found}, wanted either --minutes or --samples")
    for field, choices in _CHOICES.items():
        if (found := getattr(config, field)) not in choices:
            wanted = f"wanted one of {', '.join(choices)}"
            raise ValueError(f"{option_name(field)}: found '{found}', {wanted}")
    if config.batch % processes:
        wanted = f"wanted a positive multiple of {processes} processes"
        raise ValueError(f"--batch: found {config.batch}, {wanted}")
    if config.recordings and config.nuscenes:
        raise ValueError("--recordings: found --nuscenes too, wanted one of them")
    if config.validation_scenes and not config.scenes:
        wanted = "wanted both, so that no scene is trained on and measured"
        raise ValueError(f"--validation-scenes: found no --scenes, {wanted}")
    for field, needed in _NEEDED.items():
        if getattr(config, field) and not getattr(config, needed):
            raise ValueError(f"{option_name(field)}: found no --{needed}, wanted it too")
    if bool(config.recordings) != bool(config.map):
        raise ValueError("--recordings and --map: found one of them, wanted both or none")
    check_fits_sampler(network_config(config.network, config.view))


def _check_seed(config: TrainingConfig, processes: int) -> None:
    """ValueError if a run of as many processes with another seed could show the same scenes."""
    samplers = math.lcm(SamplerStream.STREAMS, processes)
    apart = SamplerStream.SEED_STRIDE * 2 ** (samplers - 1).bit_length()
    if not config.nuscenes and config.seed % apart:
        wanted = f"wanted a multiple of {apart}, because a run uses the scenes of so many seeds"
        raise ValueError(f"--seed: found {config.seed}, {wanted}")


def _check_ranges(config: TrainingConfig) -> None:
    if config.seed < FIRST_TRAINING_SEED:
        wanted = f"wanted at least {FIRST_TRAINING_SEED}, because evaluation has the others"
        raise ValueError(f"--seed: found {config.seed}, {wanted}")
    for wanted, accepts, fields in _RANGES:
        for field in fields:
            if not accepts(value := getattr(config, field)):
                raise ValueError(f"{option_name(field)}: found {value}, wanted {wanted}")
