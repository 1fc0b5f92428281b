"""Runs the programs that make samples, and reads their records: bevloc_sampler renders those of the
simulator, bevloc_drive_sampler reads those of recorded drives.

A program, unlike a library, needs nothing of the machine that runs Python: in a training bundle
(training/bundle.py) it runs with the libraries and the loader that lie beside it.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from training.built_file import built_file
from training.errors import TrainingError
from training.model import (
    BEV_COLS,
    BEV_ROWS,
    CAMERAS,
    IMAGE_COLS,
    IMAGE_ROWS,
    RASTER_CHANNELS,
    VIEW_SLOTS,
)
from training.models.config import RASTER_COLS, RASTER_ROWS

ENVIRONMENT = "BEVLOC_SAMPLER"
LOADER = "ld-linux-x86-64.so.2"
PROGRAM = "bevloc_sampler"
DRIVE_PROGRAM = "bevloc_drive_sampler"
BUNDLED = Path("sampler")  # the folder of the program in a training bundle
_ROOT = Path(__file__).resolve().parent.parent
_PIPE_BYTES = 2**20  # Linux allows this much without privileges
_FOREIGN = ("LD_LIBRARY_PATH", "LD_PRELOAD", "LD_AUDIT")  # of this Python, not of the program

# training/native/sample_record.h
_HEADER = np.dtype([("magic", "S8"), ("sizes", "<u4", (8,))])
_MAGIC = b"bevlocS1"
_SIZES = (
    *(CAMERAS, IMAGE_ROWS, IMAGE_COLS),
    *(RASTER_CHANNELS, RASTER_ROWS, RASTER_COLS),
    *(VIEW_SLOTS, BEV_ROWS * BEV_COLS),
)
RECORD = np.dtype(
    [
        ("images", "u1", (CAMERAS, 3, IMAGE_ROWS, IMAGE_COLS)),
        ("raster_prior", "u1", (RASTER_CHANNELS, RASTER_ROWS, RASTER_COLS)),
        ("raster_truth", "u1", (RASTER_CHANNELS, RASTER_ROWS, RASTER_COLS)),
        ("index", "<i4", (VIEW_SLOTS, BEV_ROWS * BEV_COLS)),
        ("weight", "<f4", (VIEW_SLOTS, BEV_ROWS * BEV_COLS)),
        ("correction", "<f4", (3,)),
        ("camera_mask", "<u4"),
    ]
)


class SamplerError(TrainingError):
    """The sampler is missing, refused its options or ended early."""


@dataclass(frozen=True)
class SamplerOptions:
    """Which samples a sampler renders. `nuisances`: usual, strong or street. `photos`: a folder of
    script/photos; empty: the simulator's own textures."""

    program: ClassVar[str] = PROGRAM
    first_seed: int
    first_sample: int = 0
    threads: int = 1
    drop_camera_probability: float = 0.0
    nuisances: str = "usual"
    photos: str = ""


@dataclass(frozen=True)
class DriveFacts:
    """What is known of drives before an image is read. The ranges are those of all cameras: focal
    lengths in the network's images and heights above the ground."""

    samples: dict[str, int]  # by part: training, calibration, held-back
    focal_range_px: tuple[float, float]
    height_range_m: tuple[float, float]


@dataclass(frozen=True)
class Drives:
    """Recorded drives (training/drives/drive_set.h). `rig`: a calibration instead of the recorded
    ones. `reference`: file, own or truth. `skip_bad`: whether the next good sample replaces a bad
    one in training, and fixed sets leave it out; otherwise a bad sample ends the program."""

    recordings: str
    map: str
    rig: str = ""
    reference: str = "file"
    skip_bad: bool = False

    def facts(self) -> DriveFacts:
        """SamplerError if the drives cannot be read."""
        options = DriveOptions(self, first_seed=0)
        command = [*sampler_command(sampler_program(DRIVE_PROGRAM)), *arguments_of(options)]
        done = subprocess.run(
            [*command, "--count"], env=_own_environment(), capture_output=True, text=True
        )
        if done.returncode != 0:
            raise SamplerError(done.stderr.strip())
        lines = [line.split() for line in done.stdout.splitlines()]
        ranges = {name: (float(v[0]), float(v[1])) for name, *v in lines if len(v) == 2}
        samples = {name: int(v[0]) for name, *v in lines if len(v) == 1}
        return DriveFacts(samples, ranges["focal_px"], ranges["height_m"])


@dataclass(frozen=True)
class DriveOptions:
    """Which samples of recorded drives are read: those of `part` (training, calibration or
    held-back) with the numbers first_sample, first_sample + stride, and so on, in an order that the
    seed gives. `blank_bad`: a bad sample comes without cameras and is not replaced, so that no
    place comes twice; for drives that do not skip bad samples."""

    program: ClassVar[str] = DRIVE_PROGRAM
    drives: Drives
    first_seed: int
    first_sample: int = 0
    stride: int = 1
    part: str = "training"
    drop_camera_probability: float = 0.0
    blank_bad: bool = False


def arguments_of(options: SamplerOptions | DriveOptions) -> list[str]:
    """The options on the command line of their program."""
    given = dict(vars(options))
    if drives := given.pop("drives", None):
        given |= vars(drives)
    arguments = []
    for name, value in given.items():
        option = f"--{name.replace('_', '-')}"
        if value is True:
            arguments.append(option)
        elif value is not False and value != "":
            arguments.append(f"{option}={value}")
    return arguments


def sampler_program(name: str = PROGRAM) -> Path:
    """A program beside $BEVLOC_SAMPLER, or the bundle's own one, or that of the build."""
    if chosen := os.environ.get(ENVIRONMENT):
        return Path(chosen) if name == PROGRAM else Path(chosen).with_name(name)
    if (bundled := _ROOT / BUNDLED / name).exists():
        return bundled
    if built := built_file(_ROOT / "build", f"bin/{name}"):
        return built
    raise SamplerError(f"{_ROOT}: found no {name}; build the target {name} or set {ENVIRONMENT}")


def _own_environment() -> dict[str, str]:
    return {key: value for key, value in os.environ.items() if key not in _FOREIGN}


def sampler_command(program: Path) -> list[str]:
    """The command that starts the program. It uses the loader and the libraries beside the program,
    if there are any."""
    folder = program.resolve().parent
    if not (folder / LOADER).exists():
        return [str(program)]
    return [str(folder / LOADER), "--inhibit-cache", "--library-path", str(folder), str(program)]


class SamplerProcess:
    """One running sampler. Its samples come in order and depend on the options alone, except
    `threads`, which only sets how many are rendered ahead at once."""

    def __init__(self, options: SamplerOptions | DriveOptions) -> None:
        """SamplerError if the program is missing or refuses the options."""
        program = sampler_program(options.program)
        self._name = program.name
        command = [*sampler_command(program), *arguments_of(options)]
        try:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, env=_own_environment()
            )
        except OSError as error:
            raise SamplerError(f"{program}: cannot be started ({error.strerror})") from error
        assert self._process.stdout is not None
        self._pipe = self._process.stdout
        with contextlib.suppress(OSError):  # a user may have used up the memory of all pipes
            fcntl.fcntl(self._pipe, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)
        header = np.empty(1, _HEADER)
        self.read(header)
        sizes = tuple(header["sizes"][0].tolist())
        if header["magic"][0] != _MAGIC or sizes != _SIZES:
            self.close()
            raise SamplerError(
                f"{program}: found samples of {header['magic'][0]!r} {sizes}, wanted {_MAGIC!r} "
                f"{_SIZES}; build it again"
            )

    def read(self, array: np.ndarray) -> None:
        """Fills a contiguous array of RECORD with the next samples. Blocks until they are rendered.
        SamplerError if the program has ended."""
        bytes_left = array.view(np.uint8).data
        while bytes_left.nbytes:
            found = self._pipe.readinto(bytes_left)  # type: ignore[attr-defined]  # BufferedReader
            if not found:
                status = self._process.wait()
                self.close()
                raise SamplerError(
                    f"{self._name}: ended with status {status}, wanted samples; the reason is above"
                )
            bytes_left = bytes_left[found:]

    def close(self) -> None:
        """Ends the program. Does nothing if that is done."""
        self._process.kill()
        self._process.wait()
        self._pipe.close()
