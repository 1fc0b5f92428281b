"""Tests what a vehicle does in a bad start of a new version, and how it copies its root."""

import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

from tests.support.stub_programs import StubPrograms

_PROGRAMS = pathlib.Path("vehicle_image/files/usr/libexec/bevloc-image").resolve()
_RESTART = "systemctl --no-block reboot"
_END_OF_TRIAL = "systemd-bless-boot bad"
# The capability cap_net_admin, as the kernel stores it (struct vfs_cap_data).
_CAPABILITY = struct.pack("<IIIII", 0x02000001, 1 << 12, 0, 0, 0)


class CountBadStart(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.stubs = StubPrograms(self.work / "stubs")
        self.stubs.put("systemctl")
        self.stubs.put("systemd-bless-boot")

    def calls_of_a_bad_start(self, file: str = "bad-starts") -> list[str]:
        command = ["sh", str(_PROGRAMS / "count-bad-start"), str(self.work / file)]
        subprocess.run(command, env=self.stubs.environment(), capture_output=True, check=True)
        return self.stubs.take_calls()

    def test_ends_the_trial_at_the_third_bad_start(self) -> None:
        self.assertEqual(self.calls_of_a_bad_start(), [_RESTART])
        self.assertEqual(self.calls_of_a_bad_start(), [_RESTART])
        self.assertEqual(self.calls_of_a_bad_start(), [_END_OF_TRIAL, _RESTART])

    def test_restarts_the_machine_even_if_it_cannot_count(self) -> None:
        for _ in range(4):
            self.assertEqual(self.calls_of_a_bad_start("none/bad-starts"), [_RESTART])

    def test_restarts_the_machine_even_if_the_trial_cannot_be_ended(self) -> None:
        self.stubs.put("systemd-bless-boot", "exit 1")
        for _ in range(3):
            self.assertEqual(self.calls_of_a_bad_start()[-1], _RESTART)


class CopyRoot(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name) / "from"
        self.copy = pathlib.Path(folder.name) / "to"
        self.root.mkdir()
        self.copy.mkdir()
        (self.root / "ping").write_text("program", encoding="ascii")

    def run_program(self) -> None:
        command = ["bash", str(_PROGRAMS / "copy-root"), str(self.root), str(self.copy)]
        subprocess.run(command, check=True)

    @unittest.skipIf(os.geteuid() != 0, "only root may give a file a capability")
    def test_keeps_the_capabilities_of_files(self) -> None:
        try:
            os.setxattr(self.root / "ping", "security.capability", _CAPABILITY)
        except OSError as error:
            self.skipTest(f"files cannot have capabilities here: {error}")
        self.run_program()
        self.assertEqual(os.getxattr(self.copy / "ping", "security.capability"), _CAPABILITY)

    def test_keeps_links_and_modes(self) -> None:
        (self.root / "ping").chmod(0o4711)
        (self.root / "link").symlink_to("ping")
        self.run_program()
        self.assertEqual((self.copy / "ping").stat().st_mode & 0o7777, 0o4711)
        self.assertEqual(os.readlink(self.copy / "link"), "ping")


if __name__ == "__main__":
    unittest.main()
