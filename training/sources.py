"""Makes streams and sets of samples from the simulator, from nuScenes or from recorded drives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from training.config import (
    FIRST_EVALUATION_SEED,
    FIRST_VALIDATION_SEED,
    USUAL_SEEDS,
    TrainingConfig,
)
from training.data import Batch, DriveStream, MixedStream, SamplerStream, Stream
from training.distributed import WHOLE, Share
from training.errors import TrainingError
from training.nuscenes.dataset import NuscenesDataset
from training.nuscenes.stream import NuscenesStream
from training.nuscenes.tables import read_scene_names
from training.options import drives_of
from training.sampler_process import Drives, SamplerError

BATCH = 8
# Errors and scales of fewer samples are not exact enough. One in twenty scales of sigma that are
# fitted to three independent samples is half of the right one.
FEWEST_SAMPLES = 24


@lru_cache(maxsize=2)
def _dataset(root: str, scenes: str, version: str, line_width_cells: float) -> NuscenesDataset:
    return NuscenesDataset(Path(root), Path(scenes) if scenes else None, version, line_width_cells)


def _nuscenes(
    config: TrainingConfig,
    scenes: str,
    seed: int,
    first: int,
    drop_probability: float,
    share: Share = WHOLE,
) -> NuscenesStream:
    dataset = _dataset(config.nuscenes, scenes, config.nuscenes_version, config.line_width_cells)
    threads = config.sampler_threads
    return NuscenesStream(dataset, seed, first, threads, drop_probability, config.on_error, share)


def training_stream(config: TrainingConfig, first: int, share: Share = WHOLE) -> Stream:
    """A process's share of the run's samples, starting at sample `first`."""
    drop_probability = config.drop_camera_probability
    if config.nuscenes:
        return _nuscenes(config, config.scenes, config.seed, first, drop_probability, share)
    if config.recordings:
        return _drives_and_simulator(config, first, share)
    return _simulator(config, first, share)


def _mixed(
    make_first: Callable[[int], Stream],
    make_second: Callable[[int], Stream],
    second_share: float,
    first: int,
    share: Share,
) -> Stream:
    """Two streams in one, starting at sample `first`. Each maker gets the number of the first
    sample of its own stream."""
    if second_share == 0.0:
        return make_first(first)
    own = first // share.count
    taken = MixedStream.taken(own, second_share)
    stream = make_first((own - taken) * share.count)
    try:
        second = make_second(taken * share.count)
    except SamplerError:
        stream.close()
        raise
    return MixedStream(stream, second, second_share, own)


def _simulator(config: TrainingConfig, first: int, share: Share) -> Stream:
    """Simulated samples. Samples with the usual nuisances show other worlds than the others."""

    def stream(seed: int, first: int, nuisances: str) -> Stream:
        threads, drop = config.sampler_threads, config.drop_camera_probability
        return SamplerStream(seed, first, threads, drop, share, nuisances, config.photos)

    return _mixed(
        lambda first: stream(config.seed, first, config.nuisances),
        lambda first: stream(config.seed + USUAL_SEEDS, first, "usual"),
        config.usual_share,
        first,
        share,
    )


def _drives_and_simulator(config: TrainingConfig, first: int, share: Share) -> Stream:
    """Samples of recorded drives, with simulated ones between them, so that the network does not
    forget what the drives do not show."""

    def drives(first: int) -> Stream:
        threads, drop = config.sampler_threads, config.drop_camera_probability
        return DriveStream(
            drives_of(config), "training", config.seed, first, threads, drop, share
        )

    def simulator(first: int) -> Stream:
        return _simulator(config, first, share)

    return _mixed(drives, simulator, config.simulated_share, first, share)


def _batches(stream: Stream, samples: int) -> Iterator[Batch]:
    for first in range(0, samples, BATCH):
        yield stream.next(min(BATCH, samples - first))
    stream.close()


def simulator_batches(
    samples: int, threads: int, first_seed: int = FIRST_EVALUATION_SEED
) -> list[Batch]:
    """A fixed set of scenes with all cameras: by default those of the model card."""
    return list(_batches(SamplerStream(first_seed, 0, threads, 0.0), samples))


def nuscenes_batches(
    root: str, scenes: str, line_width_cells: float, threads: int, version: str = ""
) -> Iterator[Batch]:
    """Every sample of the scenes once, with all cameras. `version`: v1.0-*, needed if there are
    several."""
    config = TrainingConfig(
        nuscenes=root,
        nuscenes_version=version,
        line_width_cells=line_width_cells,
        sampler_threads=threads,
    )
    stream = _nuscenes(config, scenes, FIRST_EVALUATION_SEED, 0, 0.0)
    return _batches(stream, len(_dataset(root, scenes, version, line_width_cells)))


def drive_batches(drives: Drives, part: str, samples: int, threads: int) -> list[Batch]:
    """The first good samples of a part in a fixed order, with all cameras; each place at most
    once. TrainingError if there is none."""
    left, missing = drives.facts().samples[part], samples
    refusing = replace(drives, skip_bad=False)
    stream = DriveStream(
        refusing, part, FIRST_EVALUATION_SEED, 0, threads, 0.0, blank_bad=drives.skip_bad
    )
    batches: list[Batch] = []
    while (count := min(BATCH, left, missing)) > 0:
        good = stream.next(count).with_cameras()
        left -= count
        missing -= len(good)
        batches += [good] if len(good) > 0 else []
    stream.close()
    if samples > 0 and not batches:
        raise TrainingError(
            f"{drives.recordings}: found no good sample of the part {part}, wanted some; the "
            "reasons are above"
        )
    return batches


def calibration_set(drives: Drives, samples: int, threads: int) -> list[Batch]:
    """The first good samples for calibration. TrainingError if the drives have too few."""
    batches = drive_batches(drives, "calibration", samples, threads)
    if (found := sum(map(len, batches))) < samples:
        _check_part(drives, "calibration", found)
    return batches


def _check_part(drives: Drives, part: str, samples: int) -> None:
    """TrainingError if drives with so many samples of a part cannot be used."""
    least = FEWEST_SAMPLES if part == "calibration" else 1
    if samples < least:
        found = f"{samples or 'no'} sample{'s' if samples > 1 else ''}"
        raise TrainingError(
            f"{drives.recordings}: found {found} of the part {part}, wanted at least {least}; give "
            "drives with reference poses through more squares (docs/own-drives.md)"
        )


def _check_scenes(config: TrainingConfig) -> None:
    """TrainingError if a scene is in both files."""
    trained = set(read_scene_names(Path(config.scenes)))
    for name in read_scene_names(Path(config.validation_scenes)):
        if name in trained:
            raise TrainingError(
                f"{config.validation_scenes}: found {name}, wanted no scene of {config.scenes}"
            )


def validation_set(config: TrainingConfig) -> list[Batch]:
    """A fixed set with all cameras that neither training nor the figures of a finished network
    see. For nuScenes the set is empty unless `validation_scenes` is given. TrainingError if
    recorded drives have too few samples of a part."""
    samples, threads = config.validation_samples, config.sampler_threads
    if config.recordings:
        drives = drives_of(config)
        for part, count in drives.facts().samples.items():
            _check_part(drives, part, count)
        return calibration_set(drives, samples, threads)
    if not config.nuscenes:
        return simulator_batches(samples, threads, FIRST_VALIDATION_SEED)
    if not config.validation_scenes:
        return []
    _check_scenes(config)
    stream = _nuscenes(config, config.validation_scenes, FIRST_VALIDATION_SEED, 0, 0.0)
    return list(_batches(stream, samples))
