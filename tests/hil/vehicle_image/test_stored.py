"""Tests the judge of the power cuts, and the commands that the lab reads from a page."""

import pathlib
import unittest

from tests.hil.lab.agent import LabError
from tests.hil.lab.bring_up import MOST_COMMANDS, PAGE, commands_of
from tests.hil.vehicle_image.stored import Stored, check_nothing_lost

_BEFORE = Stored(
    root_a="12ab",
    config={"bevlocd.yaml": b"cameras: {}\n"},
    sizes={"recording/1.mcap": 100, "recording/2.mcap": 50},
    learned={"rig_crc32": 1, "errors": [0.0]},
)


def _after(**changes: object) -> Stored:
    return Stored(**{**vars(_BEFORE), **changes})


class CheckNothingLost(unittest.TestCase):
    def expect_lost(self, message: str, after: Stored) -> None:
        with self.assertRaisesRegex(LabError, message):
            check_nothing_lost(_BEFORE, after, {"recording/1.mcap": 100})

    def test_accepts_new_files_and_new_values(self):
        after = _after(
            sizes={"recording/1.mcap": 100, "recording/3.mcap": 7},
            learned={"rig_crc32": 1, "errors": [0.5]},
        )
        check_nothing_lost(_BEFORE, after, {"recording/1.mcap": 100})

    def test_finds_a_root_that_was_written(self):
        self.expect_lost("root file system", _after(root_a="34cd"))

    def test_finds_a_changed_configuration(self):
        self.expect_lost("/etc/bevloc", _after(config={"bevlocd.yaml": b""}))

    def test_finds_a_shorter_file(self):
        self.expect_lost("found 99 bytes, wanted 100", _after(sizes={"recording/1.mcap": 99}))

    def test_finds_a_missing_file(self):
        self.expect_lost("found None bytes, wanted 100", _after(sizes={}))

    def test_finds_a_learned_calibration_that_is_gone(self):
        self.expect_lost("calibration.yaml", _after(learned={}))


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
