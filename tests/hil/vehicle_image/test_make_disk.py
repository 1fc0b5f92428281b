"""Tests who can read a vehicle's disk, and how its space is shared.

The root file system of the tests has only what make_disk reads.
"""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from tests.support.stub_programs import StubPrograms

_PROGRAM = pathlib.Path("vehicle_image/make_disk").resolve()
_TOOLS = ("jq", "mcopy", "mke2fs", "mkfs.vfat", "sfdisk")
_MISSING = [tool for tool in _TOOLS if shutil.which(tool) is None]
# What the programs in the root would print.
_CHROOT = """
case $2 in
  dpkg) echo amd64 ;;
  dpkg-query) echo 1.0 ;;
  id) echo 4242 ;;
esac
"""
_SMALL = {"BEVLOC_ROOT_MB": "8", "BEVLOC_DATA_MB": "8"}
_JOURNAL = pathlib.Path("vehicle_image/files/etc/systemd/journald.conf.d/size.conf").resolve()
# The recorder leaves this part of the data partition free (firmware/recording/recording_ring.cpp).
_FREE = 1 / 20


def _number_in(file: pathlib.Path, pattern: str) -> int:
    found = re.search(pattern, file.read_text(encoding="utf-8"), re.MULTILINE)
    assert found, f"{file}: found nothing like {pattern}"
    return int(found[1])


class DataPartition(unittest.TestCase):
    def test_has_room_for_the_journal_beside_a_full_ring_of_recordings(self) -> None:
        keep_free_mb = _number_in(_JOURNAL, r"^SystemKeepFree=(\d+)M$")
        data_mb = _number_in(_PROGRAM, r"BEVLOC_DATA_MB:-(\d+)}")
        self.assertLess(keep_free_mb, _FREE * data_mb)


@unittest.skipIf(os.geteuid() != 0, "only root may give files to another user")
@unittest.skipIf(_MISSING, f"found no {', '.join(_MISSING)} (script/packages-python.txt)")
class MakeDisk(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        for name in (
            "root/usr/lib/systemd/boot/efi/systemd-bootx64.efi",
            "root/boot/vmlinuz-1",
            "root/boot/initrd.img-1",
            "config/bevlocd.yaml",
        ):
            (self.work / name).parent.mkdir(parents=True, exist_ok=True)
            (self.work / name).write_text(name, encoding="ascii")
        self.stubs = StubPrograms(self.work / "stubs")
        self.stubs.put("chroot", _CHROOT)

    def test_nobody_else_can_read_the_disk_or_its_parts(self) -> None:
        # This stub looks at the folder of the parts while make_disk runs.
        look = f"stat -c %a {self.work}/disk.img.parts >>{self.work}/modes"
        self.stubs.put("sfdisk", f'{look}\nexec {shutil.which("sfdisk")} "$@"')
        disk = self.work / "disk.img"
        folders = [str(self.work / name) for name in ("root", "config")]
        before = os.umask(0o022)
        try:
            done = subprocess.run(
                ["bash", str(_PROGRAM), str(disk), *folders],
                env={**self.stubs.environment(), **_SMALL},
                capture_output=True,
                text=True,
                check=False,
            )
        finally:
            os.umask(before)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(disk.stat().st_mode & 0o777, 0o600)
        modes = (self.work / "modes").read_text(encoding="ascii").split()
        self.assertEqual(set(modes), {"700"})


if __name__ == "__main__":
    unittest.main()
