"""What the vehicle stores, read from its disk after a power cut."""

import dataclasses
import pathlib
import shutil
import tempfile

import yaml

from tests.hil.lab.agent import LabError
from tests.hil.vehicle_image.disk import Disk, check_file_system, read_files


@dataclasses.dataclass(frozen=True)
class Stored:
    """Checksums of what must never change, and the sizes of the files of earlier starts."""

    root_a: str
    config: dict[str, bytes]
    sizes: dict[str, int]
    learned: dict


def read_stored(disk: Disk) -> Stored:
    """Reads the disk; raises LabError if a file system or a file is damaged."""
    work = pathlib.Path(tempfile.mkdtemp(prefix="bevloc-data-"))
    try:
        image = work / "data.img"
        disk.copy_partition("bevloc-data", image)
        check_file_system(image)
        config = read_files(image, "/etc/bevloc", work)
        files = read_files(image, "/var/lib/bevloc", work / "state")
        return Stored(
            disk.checksum("bevloc-a"),
            {p.name: p.read_bytes() for p in config.iterdir()},
            {str(p.relative_to(files)): p.stat().st_size for p in files.rglob("*") if p.is_file()},
            _learned(files / "calibration.yaml"),
        )
    finally:
        shutil.rmtree(work)


def check_nothing_lost(before: Stored, after: Stored, settled: dict[str, int]) -> None:
    """Compares with an earlier state. `settled`: the files that the start before this one found."""
    if after.root_a != before.root_a:
        raise LabError("the root file system has changed, wanted one that is read-only")
    if after.config != before.config:
        raise LabError("/etc/bevloc has changed, wanted what was installed")
    if after.learned.keys() != before.learned.keys():
        raise LabError(f"calibration.yaml: found {after.learned}, wanted {before.learned}")
    for name, size in settled.items():
        if after.sizes.get(name, 0) < size:
            raise LabError(f"{name}: found {after.sizes.get(name)} bytes, wanted {size}")


def _learned(file: pathlib.Path) -> dict:
    if not file.exists():
        return {}
    found = yaml.safe_load(file.read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise LabError(f"{file.name}: found {found!r}, wanted what was learned")
    return found
