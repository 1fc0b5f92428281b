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


class RunningVersion(unittest.TestCase):
    """Its entry for the boot loader, and the variables of the firmware."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        (self.work / "entries").mkdir()
        (self.work / "variables").mkdir()
        self.put_entry("bevloc-a.conf")

    def put_entry(self, name: str) -> None:
        (self.work / "entries" / name).write_text("title bevloc 1\n", encoding="ascii")

    def set_variable(self) -> None:
        name = "LoaderBootCountPath-4a67b082-0a4c-41cf-b6c7-440b29bb8c4f"
        (self.work / "variables" / name).touch()

    def entry_and_variables(self) -> list[str]:
        return [str(self.work / "entries/bevloc-b"), str(self.work / "variables")]


class TrialState(RunningVersion):
    def expect(self, state: str) -> None:
        command = ["sh", str(_PROGRAMS / "trial-state"), *self.entry_and_variables()]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, f"{state}\n")

    def test_is_counted_if_the_boot_loader_has_counted_this_start(self) -> None:
        self.put_entry("bevloc-b+9-1.conf")
        self.set_variable()
        self.expect("counted")

    def test_is_uncounted_if_the_firmware_does_not_rename_files(self) -> None:
        self.put_entry("bevloc-b+10.conf")
        self.expect("uncounted")

    def test_is_no_trial_without_a_count_in_the_entry(self) -> None:
        self.put_entry("bevloc-b.conf")
        self.expect("no")
        self.put_entry("bevloc-a+9-1.conf")
        self.expect("no")

    def test_is_no_trial_after_the_version_was_kept_in_this_start(self) -> None:
        self.put_entry("bevloc-b.conf")
        self.set_variable()
        self.expect("no")

    def test_is_a_trial_although_the_boot_partition_cannot_be_read(self) -> None:
        self.set_variable()
        self.expect("counted")


class CountBadStart(RunningVersion):
    def setUp(self) -> None:
        super().setUp()
        self.put_entry("bevloc-b+9-1.conf")
        self.set_variable()
        self.stubs = StubPrograms(self.work / "stubs")
        self.stubs.put("systemctl")
        self.stubs.put("systemd-bless-boot")

    def calls_of_a_bad_start(self, file: str = "bad-starts") -> list[str]:
        command = ["sh", str(_PROGRAMS / "count-bad-start"), str(self.work / file)]
        command += self.entry_and_variables()
        done = subprocess.run(
            command, env=self.stubs.environment(), capture_output=True, text=True, check=True
        )
        self.said = done.stderr
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

    def test_does_nothing_without_a_trial(self) -> None:
        self.put_entry("bevloc-b.conf")
        for _ in range(3):
            self.assertEqual(self.calls_of_a_bad_start(), [])
        self.assertFalse((self.work / "bad-starts").exists())


class BadStartWithoutCount(CountBadStart):
    """The firmware does not rename files, so the boot loader neither counts nor tells the entry."""

    def setUp(self) -> None:
        super().setUp()
        for file in (self.work / "variables").iterdir():
            file.unlink()
        (self.work / "entries/bevloc-b+9-1.conf").rename(self.work / "entries/bevloc-b+10.conf")

    def entries(self) -> list[str]:
        return sorted(file.name for file in (self.work / "entries").iterdir())

    def test_ends_the_trial_at_the_third_bad_start(self) -> None:
        for _ in range(2):
            self.assertEqual(self.calls_of_a_bad_start(), [_RESTART])
            self.assertIn("found firmware that did not rename", self.said)
            self.assertEqual(self.entries(), ["bevloc-a.conf", "bevloc-b+10.conf"])
        self.assertEqual(self.calls_of_a_bad_start(), [_RESTART])
        self.assertEqual(self.entries(), ["bevloc-a.conf", "bevloc-b+0-3.conf"])


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
