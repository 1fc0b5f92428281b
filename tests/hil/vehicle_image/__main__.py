"""The program behind script/try-image: makes the vehicle's disk and plays scenarios with it. With
--check, it only checks the options, before script/try-image builds what the scenarios need."""

import argparse
import functools
import pathlib
import re
import shutil
import signal
import subprocess
import sys

from tests.hil.lab.outcome import Outcome
from tests.hil.lab.program import play, report, run
from tests.hil.lab.qemu import KERNEL_OPTIONS
from tests.hil.vehicle_image.disk import Disk
from tests.hil.vehicle_image.machine import Parts
from tests.hil.vehicle_image.repository import PACKAGE, Repositories
from tests.hil.vehicle_image.scenarios import SCENARIOS
from tooling.option_types import positive

HERE = pathlib.Path("tests/hil/vehicle_image")
# In the machine, /lab has the layout of the tree, because configurations use relative paths.
_IN_LAB = ("config/rig_demo.yaml", "models/nano.onnx", "tests/hil/config/drive.yaml")
_OF_THE_SYSTEM = ("libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so")


def main() -> int:
    arguments = _arguments()
    if arguments.check:
        return 0
    # An interrupted run must stop its processes too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    work, results = arguments.work.resolve(), arguments.results.resolve()
    work.mkdir(parents=True, exist_ok=True)
    results.mkdir(parents=True, exist_ok=True)
    repositories = Repositories(arguments.packages, work / "repositories")
    image = work / "disk.img"
    if not arguments.keep_disk:
        repositories.make()
        _make_image(arguments, repositories, image)
    outcomes: dict[str, Outcome] = {}
    for name in arguments.names or SCENARIOS:
        # Each scenario starts with a new disk.
        used = work / "used.img"
        subprocess.run(["cp", "--sparse=always", image, used], check=True)
        cameras = arguments.build.resolve() / "bin/usb_cameras"
        parts = Parts(
            Disk(used), cameras, arguments.pictures, results / name, repositories.folder
        )
        scenario = functools.partial(SCENARIOS[name], parts, arguments.cuts, arguments.seed)
        outcomes[name] = play(name, scenario)
    return report(outcomes, results)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="script/try-image", description=__doc__)
    parser.add_argument("--check", action="store_true", help=argparse.SUPPRESS)
    runs = "--check" not in sys.argv
    for folder in ("build", "pictures", "results", "work"):
        parser.add_argument(f"--{folder}", type=pathlib.Path, required=runs, help=argparse.SUPPRESS)
    parser.add_argument(
        "--packages",
        type=pathlib.Path,
        default=pathlib.Path("build/packages/amd64-bookworm"),
        help="the folder with the packages of script/package",
    )
    parser.add_argument("--cuts", type=positive, default=100, help="number of power cuts")
    parser.add_argument("--seed", type=int, default=1, help="of the moments of the power cuts")
    parser.add_argument("--keep-disk", action="store_true", help="use the disk of the last run")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(SCENARIOS))
    arguments = parser.parse_args()
    for name in arguments.names:
        if name not in SCENARIOS:
            parser.error(f"found no scenario '{name}', wanted one of {', '.join(SCENARIOS)}")
    found = len(list(arguments.packages.glob(PACKAGE)))
    if found != 1 and not arguments.keep_disk:
        parser.error(
            f"found {found} files {PACKAGE} in {arguments.packages}, wanted one; "
            "script/package amd64 bookworm makes the packages"
        )
    return arguments


def _make_image(
    arguments: argparse.Namespace, repositories: Repositories, image: pathlib.Path
) -> None:
    config, extra = image.parent / "config", image.parent / "extra"
    for folder in (config, extra):
        shutil.rmtree(folder, ignore_errors=True)
    config.mkdir()
    for file in (HERE / "config/bevlocd.yaml", "config/rig_demo.yaml", repositories.key):
        shutil.copy(str(file), config)
    shutil.copy(arguments.pictures / "map.bvm", config)
    shutil.copytree(HERE / "files", extra, symlinks=True)
    for name in _IN_LAB:
        (extra / "lab" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(name, extra / "lab" / name)
    vehicle = arguments.build / "bin/vehicle_can"
    for program in ("tests/hil/guest/agent", "/usr/bin/candump", str(vehicle)):
        shutil.copy(program, extra / "lab")
    _copy_libraries(vehicle, extra / "lab/lib")
    command = ["script/image", "--config", config, "--packages", arguments.packages]
    command += ["--extra", extra, "--out", image, "--kernel-options", KERNEL_OPTIONS]
    subprocess.run(command, check=True)


def _copy_libraries(program: pathlib.Path, folder: pathlib.Path) -> None:
    """Copies the libraries of a program, because the vehicle has only those of bevloc."""
    folder.mkdir()
    listing = subprocess.run(["ldd", str(program)], check=True, capture_output=True, text=True)
    for name, path in re.findall(r"(\S+) => (/\S+)", listing.stdout):
        if not name.startswith(_OF_THE_SYSTEM):
            shutil.copy(path, folder / name)


if __name__ == "__main__":
    run(main)
