"""The ranges of the cameras that a network was trained with. A run that starts with the weights of
another one stores the ranges of both, because its network knows the cameras of both.

The module needs no package beyond PyTorch where no model file is read, so a training bundle has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from training.checkpoint import read_checkpoint
from training.config import TrainingConfig
from training.errors import CheckpointError
from training.options import drives_of
from training.sampler_process import DriveFacts

# The appliance corrects the calibration that it records, so the rig that it is given differs a
# little from that of its recordings.
RECORDED_MARGIN = 1.05
# The metadata of a model with the ranges of RigRanges, in the order of its fields.
RANGE_KEYS = ("bevloc.rig.focal_range_px", "bevloc.rig.height_range_m")


@dataclass(frozen=True)
class RigRanges:
    """The least and the largest value of all cameras."""

    focal_px: tuple[float, float]
    height_m: tuple[float, float]

    @staticmethod
    def of_drives(facts: DriveFacts) -> RigRanges:
        def widened(found: tuple[float, float]) -> tuple[float, float]:
            return found[0] / RECORDED_MARGIN, found[1] * RECORDED_MARGIN

        return RigRanges(widened(facts.focal_range_px), widened(facts.height_range_m))


# The random rigs of --nuisances street (sim/samples/random_rig.cpp). They have 50 to 120 degrees of
# view, of which a network image shows at most 90 (pipeline/preprocessing/network_camera.h).
RANDOM_RIGS = RigRanges((160, 343), (0.6, 2.6))


def drawn_ranges(nuisances: str) -> list[RigRanges]:
    """Those of the simulated samples beyond the simulator's own rig."""
    return [RANDOM_RIGS] if nuisances == "street" else []


def stated_ranges(path: Path) -> RigRanges | None:
    """The ranges that a model file states; None if its network was trained on one rig.
    CheckpointError if it states anything else."""
    import onnx  # a training bundle reads no model file

    stated = {entry.key: entry.value for entry in onnx.load(str(path)).metadata_props}
    found = [stated[key] for key in RANGE_KEYS if key in stated]
    if not found:
        return None
    try:
        (focal_least, focal_most), (least_m, most_m) = (map(float, text.split()) for text in found)
    except ValueError as error:
        raise CheckpointError(
            f"{path}: found '{', '.join(found)}' as the ranges of the rig in the metadata, wanted "
            "two numbers each for focal length and height"
        ) from error
    return RigRanges((focal_least, focal_most), (least_m, most_m))


def to_store(ranges: list[RigRanges]) -> dict[str, list[dict[str, Any]]]:
    """What the configuration of a checkpoint gets in addition, for stored_ranges()."""
    return {"rig_ranges": [asdict(found) for found in dict.fromkeys(ranges)]}


def stored_ranges(config: Mapping[str, Any]) -> list[RigRanges] | None:
    """All ranges that the weights of a checkpoint have been trained with; None in a checkpoint
    that is older than these. `config`: of the checkpoint."""
    stored = config.get("rig_ranges")
    return None if stored is None else [RigRanges(**ranges) for ranges in stored]


def ranges_of_weights(path: Path) -> list[RigRanges]:
    """All ranges that the weights of a float model file or a checkpoint have been trained with.
    CheckpointError as of read_checkpoint() and stated_ranges()."""
    if path.suffix == ".onnx":
        stated = stated_ranges(path)
        return [stated] if stated else []
    config = read_checkpoint(path)["config"]
    stored = stored_ranges(config)
    return drawn_ranges(config.get("nuisances", "usual")) if stored is None else stored


def ranges_of_run(config: TrainingConfig) -> list[RigRanges]:
    """All ranges that the weights of a new run will have been trained with: those of its samples
    and those of the weights that it starts with."""
    ranges = drawn_ranges(config.nuisances)
    if config.recordings:
        ranges.append(RigRanges.of_drives(drives_of(config).facts()))
    return ranges + (ranges_of_weights(Path(config.init)) if config.init else [])
