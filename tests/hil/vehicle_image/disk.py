"""The vehicle's disk in the lab: it loses what was not flushed when its power is cut."""

import hashlib
import json
import pathlib
import subprocess
import time

from tests.hil.lab.agent import LabError
from tests.hil.lab.qemu import Processes

_SECTOR = 512
_CHUNK = 1 << 22


class Disk:
    """A file with a partition table."""

    def __init__(self, file: pathlib.Path) -> None:
        self.file = file
        table = json.loads(_run(["sfdisk", "--json", str(file)]))["partitiontable"]
        self._partitions = {p["name"]: p for p in table["partitions"]}

    def serve(self, processes: Processes, socket: pathlib.Path, log: pathlib.Path) -> str:
        """Starts a server with a volatile write cache and returns its address for QEMU.

        The server keeps writes in memory until the guest flushes them. Ending it at once loses the
        others, as a power cut does with the cache of a disk.
        """
        socket.unlink(missing_ok=True)
        command = ["nbdkit", "--foreground", "--exit-with-parent", "--unix", str(socket)]
        command += ["--filter=cache", "file", str(self.file), "cache=writeback"]
        server = processes.start(command, log)
        while not socket.exists():
            if server.poll() is not None:
                raise LabError(f"nbdkit ended; see {log}")
            time.sleep(0.05)
        return f"nbd:unix:{socket}"

    def checksum(self, partition: str) -> str:
        """SHA-256 of a partition's bytes."""
        digest = hashlib.sha256()
        left = self._partitions[partition]["size"] * _SECTOR
        with open(self.file, "rb") as disk:
            disk.seek(self._partitions[partition]["start"] * _SECTOR)
            while left > 0:
                digest.update(disk.read(min(left, _CHUNK)))
                left -= min(left, _CHUNK)
        return digest.hexdigest()

    def copy_partition(self, partition: str, to: pathlib.Path) -> None:
        found = self._partitions[partition]
        _run(
            ["dd", f"if={self.file}", f"of={to}", f"bs={_CHUNK}", "conv=sparse"]
            + ["iflag=skip_bytes,count_bytes", f"skip={found['start'] * _SECTOR}"]
            + [f"count={found['size'] * _SECTOR}", "status=none"]
        )


def check_file_system(image: pathlib.Path) -> None:
    """Replays the journal, as the next start does, and raises LabError if an error remains."""
    subprocess.run(["e2fsck", "-p", str(image)], check=False, capture_output=True)
    found = subprocess.run(["e2fsck", "-fn", str(image)], check=False, capture_output=True)
    if found.returncode != 0:
        raise LabError(f"{image}: e2fsck found errors: {found.stdout.decode().strip()}")


def read_files(image: pathlib.Path, folder: str, to: pathlib.Path) -> pathlib.Path:
    """Copies a folder out of an ext4 image and returns the copy."""
    to.mkdir(parents=True, exist_ok=True)
    _run(["debugfs", "-R", f"rdump {folder} {to}", str(image)])
    return to / pathlib.PurePosixPath(folder).name


def _run(command: list[str]) -> str:
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode != 0:
        raise LabError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout
