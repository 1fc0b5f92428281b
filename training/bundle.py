"""Packs training into one folder that runs on another machine, such as one with a GPU.

    script/bundle-training --out DIR [--init FILE | --run RUN] [--photos DIR] [OPTIONS]

The folder holds the Python of training, the sampler with its libraries and the loader of this
machine, and the weights to start with. OPTIONS are those of training.train; the bundle's program
`train` uses them. See training/README.md.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import torch

from tooling.errors import run_program
from training.bundle_train import CONTINUES, has_budget, without_budget
from training.checkpoint import network_of, read_checkpoint, state_of_weights
from training.config import TrainingConfig
from training.errors import TrainingError
from training.models.config import network_config
from training.models.network import BevNetwork
from training.options import parse_config
from training.rig_ranges import ranges_of_weights, to_store
from training.run_table import TABLES
from training.sampler_process import BUNDLED, LOADER, PROGRAM, sampler_program
from training.sources import training_stream
from training.start_weights import start_with
from training.train import measuring_batches

LIMIT_BYTES = 60 * 2**20
CHECKPOINT_BYTES = 16 * 2**20  # the largest file that other machines return
_BYTES_PER_WEIGHT = 16  # of a checkpoint: weights, average, two moments of the gradient
PACKAGES = ("tooling", "training", "training/models", "training/solvers", "training/nuscenes")
ARCHIVE = ".tar.gz"
# OpenCV loads BLAS and LAPACK, which the sampler does not call. Where OpenBLAS stands in for them,
# it would add 35 MB to the bundle.
PLAIN_BLAS = "/usr/lib/x86_64-linux-gnu/blas:/usr/lib/x86_64-linux-gnu/lapack"
_ROOT = Path(__file__).resolve().parent.parent
# Options that belong to the machine or are set by the bundle's program itself.
_OWN_OPTIONS = (
    *("run", "resume", "stop_after_minutes", "init", "photos"),
    *("threads", "sampler_threads"),
)

README = """# Training bundle of bevloc

Runs on Linux on x86-64 with Python 3.10 or newer, PyTorch 1.13 or newer (with CUDA, if a GPU shall
train) and NumPy. Nothing is installed, and nothing outside this folder is written.

    ./train                     # or: PYTHON train
    ./train --minutes 60 --batch 32 --stop-after-minutes 9

Options are those of training.train (training/config.py lists them); options.json holds the
bundle's own. Results are written to run/. A second call resumes run/checkpoint.pt. Copy run/ back
and continue or export there: script/train --run RUN --resume with the same options.
Exit status: 0 finished, 75 can be resumed, 70 not finite, 2 invalid options, 1 any other error.
"""


class BundleError(TrainingError):
    """The bundle cannot be made as wanted."""


def copy_python(out: Path) -> None:
    for package in PACKAGES:
        (out / package).mkdir(parents=True)
        for source in sorted((_ROOT / package).glob("*.py")):
            shutil.copyfile(source, out / package / source.name)
    shutil.copyfile(_ROOT / "training" / "bundle_train.py", out / "train")
    (out / "train").chmod(0o755)
    (out / "README.md").write_text(README)
    shutil.copyfile(_ROOT / "LICENSE", out / "LICENSE")


def libraries_of(program: Path) -> dict[str, Path]:
    """The shared libraries that a program loads here, by name, and its loader."""
    folders = [PLAIN_BLAS, *filter(None, [os.environ.get("LD_LIBRARY_PATH")])]
    listed = subprocess.run(
        ["ldd", str(program)],
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, "LD_LIBRARY_PATH": ":".join(folders)},
    )
    found: dict[str, Path] = {}
    for line in listed.stdout.splitlines():
        if match := re.match(r"\s*(\S+) => (/\S+)", line):
            found[match[1]] = Path(match[2])
        elif match := re.match(r"\s*(/\S*/ld-linux\S*)", line):
            found[LOADER] = Path(match[1])
        elif "not found" in line:
            raise BundleError(f"{program}:{line}, wanted every library")
    if LOADER not in found:
        raise BundleError(f"{program}: found no {LOADER} in ldd's list, wanted a program of x86-64")
    return found


def copy_sampler(out: Path) -> None:
    """Copies the stripped sampler with all libraries that it loads, so that it uses none of the
    other machine."""
    program = sampler_program()
    out.mkdir()
    subprocess.run(["strip", "-o", str(out / PROGRAM), str(program)], check=True)
    for name, library in libraries_of(program).items():
        shutil.copyfile(library, out / name)
        (out / name).chmod(0o755)


def write_start_weights(config: TrainingConfig, out: Path) -> None:
    """Writes the weights of --init as a checkpoint, because a model file needs packages that the
    bundle lacks."""
    net = BevNetwork(network_config(config.network, config.view))
    start_with(net, Path(config.init), lambda: measuring_batches(config, training_stream))
    stored = to_store(ranges_of_weights(Path(config.init)))
    torch.save(state_of_weights(net.state_dict(), config.as_dict() | stored), out)


def options_of_run(run: Path) -> list[str]:
    """The options with which a run was started, as far as they differ from the defaults."""
    path = run / "checkpoint.pt"
    stored = read_checkpoint(path)["config"]
    options: list[str] = []
    for name, default in TrainingConfig().as_dict().items():
        value = stored.get(name, default)
        if name in _OWN_OPTIONS or value == default:
            continue
        option = f"--{name.replace('_', '-')}"
        options += [option] if value is True else [option, str(value)]
    return options


def photos_of_run(run: Path) -> Path | None:
    """The folder of photographs with which a run was started; None if it had none. BundleError if
    this machine does not have it."""
    path = run / "checkpoint.pt"
    photos = read_checkpoint(path)["config"].get("photos")
    if not photos:
        return None
    if not Path(photos).is_dir():
        raise BundleError(
            f"{path}: found a run with the photographs '{photos}', wanted this folder; name that "
            "of script/photos with --photos"
        )
    return Path(photos)


def checked(options: list[str], init: Path | None, photos: Path | None) -> TrainingConfig:
    """The configuration of the bundle's run. Wrong options end the program. Options without a
    budget are accepted, because `train` may get one. BundleError if the run needs what a bundle
    does not hold, or if a file is missing."""
    given = [*options, "--init", str(init or ""), "--photos", str(photos or "")]
    if not has_budget(options):
        given += ["--samples", "8"]
    config = parse_config(given, "options of the bundle's run")
    if config.recordings:
        raise BundleError(
            "--recordings: found recorded drives, wanted a run on the simulator or nuScenes"
        )
    if config.init and not Path(config.init).is_file():
        raise BundleError(
            f"--init: found no file '{config.init}', wanted a checkpoint or float model file"
        )
    if config.photos and not Path(config.photos).is_dir():
        raise BundleError(
            f"--photos: found no folder '{config.photos}', wanted that of script/photos"
        )
    return config


def copy_weights(config: TrainingConfig, run: Path | None, out: Path) -> None:
    if config.init:
        write_start_weights(config, out / "start.pt")
    if run is not None:
        path = run / "checkpoint.pt"
        found = network_of(read_checkpoint(path), path).name
        wanted = network_config(config.network, config.view).name
        if found != wanted:
            raise BundleError(f"{path}: holds the network '{found}', wanted '{wanted}'")
        (out / CONTINUES).touch()
        (out / "run").mkdir()
        for name in ("checkpoint.pt", *TABLES):
            if (run / name).exists():
                shutil.copyfile(run / name, out / "run" / name)


def size_of(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def make(arguments: argparse.Namespace, options: list[str], out: Path) -> None:
    """Writes the bundle into `out`, which must not exist. BundleError if it is too large. An error
    leaves no folder."""
    photos = arguments.photos
    if arguments.run is not None:
        stored = options_of_run(arguments.run)
        options = [*(without_budget(stored) if has_budget(options) else stored), *options]
        photos = photos or photos_of_run(arguments.run)
    config = checked(options, arguments.init, photos)
    net = BevNetwork(network_config(config.network, config.view))
    weights = sum(parameter.numel() for parameter in net.parameters())
    if _BYTES_PER_WEIGHT * weights > CHECKPOINT_BYTES and not config.compact:
        options = [*options, "--compact"]
    out.mkdir(parents=True)
    try:
        fill(arguments.run, config, options, out)
    except BaseException:
        shutil.rmtree(out)
        raise


def fill(run: Path | None, config: TrainingConfig, options: list[str], out: Path) -> None:
    """Writes the files of the bundle into the empty folder `out`. `run`: the run that the bundle
    continues, if any."""
    copy_python(out)
    copy_sampler(out / BUNDLED)
    if config.photos:
        shutil.copytree(config.photos, out / "photos")
    copy_weights(config, run, out)
    (out / "options.json").write_text(json.dumps(options) + "\n")
    if (size := size_of(out)) > LIMIT_BYTES:
        raise BundleError(
            f"{out}: found {size / 2**20:.1f} MiB, wanted at most {LIMIT_BYTES / 2**20:.0f} MiB"
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="bundle-training", description=__doc__.splitlines()[0], allow_abbrev=False
    )
    parser.add_argument("--out", type=Path, required=True, help=f"new folder, or FILE{ARCHIVE}")
    start = parser.add_mutually_exclusive_group()
    start.add_argument("--init", type=Path, help="checkpoint or float model file to start with")
    start.add_argument("--run", type=Path, help="folder of a run that the bundle continues")
    parser.add_argument(
        "--photos", type=Path, help="folder of script/photos; default: that of --run"
    )
    arguments, options = parser.parse_known_args()
    out: Path = arguments.out
    archive = out.name.endswith(ARCHIVE)
    folder = out.with_name(out.name[: -len(ARCHIVE)]) if archive else out
    for path in {out, folder}:
        if path.exists():
            sys.exit(f"{path}: exists already, wanted a new folder")
    make(arguments, options, folder)
    print(f"{folder}: {size_of(folder) / 2**20:.1f} MiB")
    if archive:
        with tarfile.open(out, "w:gz") as tar:
            tar.add(folder, folder.name)
        shutil.rmtree(folder)
        print(f"{out}: {out.stat().st_size / 2**20:.1f} MiB")


if __name__ == "__main__":
    run_program(main)
