"""Tests the judge of the power cuts, the arguments, and the commands that the lab reads."""

import contextlib
import io
import pathlib
import tempfile
import unittest
from collections.abc import Callable
from unittest import mock

from tests.hil.lab import __main__ as lab_program
from tests.hil.lab.agent import LabError
from tests.hil.lab.bench import Folders
from tests.hil.lab.bring_up import MOST_COMMANDS, PAGE, commands_of
from tests.hil.vehicle_image import __main__ as image_program
from tests.hil.vehicle_image.stored import Stored, StoredFile, check_nothing_lost

_SETTLED = {"recording/1.mcap": StoredFile(100, "56ef")}
_BEFORE = Stored(
    root_a="12ab",
    config={"bevlocd.yaml": b"cameras: {}\n"},
    files={**_SETTLED, "recording/2.mcap": StoredFile(50, "78ab")},
    learned={"rig_crc32": 1, "errors": [0.0]},
)


def _after(**changes: object) -> Stored:
    return Stored(**{**vars(_BEFORE), **changes})


class CheckNothingLost(unittest.TestCase):
    def expect_lost(self, message: str, after: Stored) -> None:
        with self.assertRaisesRegex(LabError, message):
            check_nothing_lost(_BEFORE, after, _SETTLED)

    def test_accepts_new_files_and_new_values(self):
        after = _after(
            files={**_SETTLED, "recording/3.mcap": StoredFile(7, "9a0b")},
            learned={"rig_crc32": 1, "errors": [0.5]},
        )
        check_nothing_lost(_BEFORE, after, _SETTLED)

    def test_accepts_a_file_that_has_grown(self):
        after = _after(files={"recording/1.mcap": StoredFile(101, "9a0b")})
        check_nothing_lost(_BEFORE, after, _SETTLED)

    def test_finds_a_root_that_was_written(self):
        self.expect_lost("root file system", _after(root_a="34cd"))

    def test_finds_a_changed_configuration(self):
        self.expect_lost("/etc/bevloc", _after(config={"bevlocd.yaml": b""}))

    def test_finds_a_shorter_file(self):
        after = _after(files={"recording/1.mcap": StoredFile(99, "56ef")})
        self.expect_lost("found 99 bytes, wanted 100", after)

    def test_finds_a_file_with_other_bytes(self):
        after = _after(files={"recording/1.mcap": StoredFile(100, "9a0b")})
        self.expect_lost("recording/1.mcap: found other bytes", after)

    def test_finds_a_missing_file(self):
        self.expect_lost("found None bytes, wanted 100", _after(files={}))

    def test_finds_a_learned_calibration_that_is_gone(self):
        self.expect_lost("calibration.yaml", _after(learned={}))


class Arguments(unittest.TestCase):
    def expect_refused(self, message: str, main: Callable[[], int], *arguments: str) -> None:
        said = io.StringIO()
        with (
            mock.patch("sys.argv", ["program", *arguments]),
            contextlib.redirect_stderr(said),
            self.assertRaises(SystemExit) as ended,
        ):
            main()
        self.assertEqual(ended.exception.code, 2)
        self.assertIn(message, said.getvalue())

    def expect_image_refused(self, message: str, *arguments: str) -> None:
        folders = [f"--{name}=x" for name in ("build", "pictures", "results", "work")]
        self.expect_refused(message, image_program.main, *folders, *arguments)

    def test_refuse_no_cuts_at_all(self):
        message = "found '0', wanted a whole number of at least 1"
        self.expect_image_refused(message, "--cuts", "0", "power-cuts")

    def test_refuse_a_folder_that_does_not_have_one_package(self):
        with tempfile.TemporaryDirectory() as name:
            message = f"found 0 files bevloc_*_amd64.deb in {name}, wanted one"
            self.expect_image_refused(message, "--packages", name)
            for version in ("1", "2"):
                (pathlib.Path(name) / f"bevloc_{version}_amd64.deb").touch()
            message = f"found 2 files bevloc_*_amd64.deb in {name}, wanted one"
            self.expect_image_refused(message, "--packages", name)

    def test_refuse_to_boot_a_guest_without_a_scenario(self):
        folders = [f"--{name}=x" for name in Folders.__dataclass_fields__]
        self.expect_refused("found no scenario, wanted one or more", lab_program.main, *folders)


class CommandsOfThePage(unittest.TestCase):
    def test_lead_from_the_packages_to_the_running_service(self):
        commands = commands_of(pathlib.Path(PAGE))
        self.assertLessEqual(len(commands), MOST_COMMANDS)
        self.assertRegex(commands[0], "^apt install ")
        self.assertIn("systemctl enable --now bevlocd", commands)

    def test_need_the_section(self):
        with self.assertRaisesRegex(LabError, "In short"):
            commands_of(pathlib.Path("docs/lab.md"))


if __name__ == "__main__":
    unittest.main()
