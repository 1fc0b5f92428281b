"""What the vehicle stores, read from its disk after a power cut."""

import dataclasses
import hashlib
import pathlib
import shutil
import tempfile

import yaml

from tests.hil.lab.agent import LabError
from tests.hil.vehicle_image.disk import Disk, check_file_system, read_files


_LEARNED = "calibration.yaml"


@dataclasses.dataclass(frozen=True)
class StoredFile:
    size: int
    sha256: str


@dataclasses.dataclass(frozen=True)
class Stored:
    """The checksum of the root, the configuration, and what the daemon has stored."""

    root_a: str
    config: dict[str, bytes]
    files: dict[str, StoredFile]  # without the one that the daemon replaces as it learns
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
            _files(files),
            _learned(files / _LEARNED),
        )
    finally:
        shutil.rmtree(work)


def check_nothing_lost(before: Stored, after: Stored, settled: dict[str, StoredFile]) -> None:
    """Compares with an earlier state. `settled`: files of earlier starts, as they were stored."""
    if after.root_a != before.root_a:
        raise LabError("the root file system has changed, wanted one that is read-only")
    if after.config != before.config:
        raise LabError("/etc/bevloc has changed, wanted what was installed")
    if after.learned.keys() != before.learned.keys():
        raise LabError(f"{_LEARNED}: found {after.learned}, wanted {before.learned}")
    for name, wanted in settled.items():
        found = after.files.get(name)
        if found is None or found.size < wanted.size:
            size = found.size if found else None
            raise LabError(f"{name}: found {size} bytes, wanted {wanted.size}")
        if found.size == wanted.size and found != wanted:
            raise LabError(f"{name}: found other bytes than before, wanted the same {wanted.size}")


def _files(folder: pathlib.Path) -> dict[str, StoredFile]:
    found = {str(p.relative_to(folder)): p for p in folder.rglob("*") if p.is_file()}
    return {name: _stored(file) for name, file in found.items() if name != _LEARNED}


def _stored(file: pathlib.Path) -> StoredFile:
    with open(file, "rb") as content:
        return StoredFile(file.stat().st_size, hashlib.file_digest(content, "sha256").hexdigest())


def _learned(file: pathlib.Path) -> dict:
    if not file.exists():
        return {}
    found = yaml.safe_load(file.read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise LabError(f"{file.name}: found {found!r}, wanted what was learned")
    return found
