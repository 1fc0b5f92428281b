"""Tests what script/evaluate does with its configuration."""

from __future__ import annotations

import argparse
import contextlib
import io
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from types import ModuleType
from unittest import mock

import yaml

from tests.house.test_documents import ROOT
from tests.support.script_module import load_script
from tests.support.stub_programs import StubPrograms


class EvaluateTest(unittest.TestCase):
    script: ModuleType

    @classmethod
    def setUpClass(cls) -> None:
        cls.script = load_script("evaluate")

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.config = Path(folder.name) / "own.yaml"

    def options(self, rig: Path | None = None) -> argparse.Namespace:
        return argparse.Namespace(config=self.config, rig=rig, model=None)

    def refusal(self, *words: str) -> str:
        """What the script says on standard error when it ends with exit code 2."""
        said, printed = io.StringIO(), io.StringIO()
        arguments = ["evaluate", "--config", str(self.config), *words]
        with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stderr(said):
            with contextlib.redirect_stdout(printed):
                self.assertEqual(self.script.main(), 2)
        self.assertEqual(printed.getvalue(), "")
        return said.getvalue()

    def test_says_in_one_line_what_is_wrong_with_the_configuration(self) -> None:
        found = f"evaluate: {self.config}: found no "
        self.assertRegex(self.refusal("--rig", "x.yaml"), f"^{found}readable file .*\n$")
        for content, what in (
            (b"", "sections"),
            (b"a: [1\nb", "YAML"),
            (b"\xff", "(readable file|YAML)"),
            (b"calibration: 5", "keys in section calibration"),
            (b"model:", "keys in section model"),
        ):
            self.config.write_bytes(content)
            self.assertRegex(self.refusal("--rig", "x.yaml"), f"^{found}{what}.*\n$")

    def test_says_that_the_copy_needs_a_folder_that_can_be_written(self) -> None:
        self.config.write_text("calibration: {rig: a.yaml}\n")
        read_only = OSError(30, "Read-only file system")
        with mock.patch.object(tempfile, "NamedTemporaryFile", side_effect=read_only):
            said = self.refusal("--rig", "x.yaml")
        self.assertRegex(said, f"^evaluate: {self.config.parent}: found no way .*Read-only.*\n$")

    def test_says_when_a_drive_fails(self) -> None:
        self.config.write_text("calibration: {rig: a.yaml}\n")
        with mock.patch.object(self.script, "PROGRAM", Path("/bin/false")):
            with self.assertRaises(self.script.UserError):
                self.script.run_drive(1, None, self.config, self.drive_options())
        with mock.patch.object(self.script, "PROGRAM", self.config.parent / "no"):
            with self.assertRaisesRegex(self.script.UserError, "found no program that runs"):
                self.script.run_drive(1, None, self.config, self.drive_options())

    def test_a_map_file_of_the_configuration_is_an_imported_map_too(self) -> None:
        program = self.config.parent / "bevlocd"
        program.write_text(
            '#!/bin/sh\nwhile [ "$1" != --out ]; do shift; done; mkdir -p "$2"; cd "$2"\n'
            "echo '{}' > result.json; : > poses.csv\n"
        )
        program.chmod(0o755)
        for section, map_file, imported in (
            ("", None, False),
            ("map: {procedural_seed: 3}", None, False),
            ("map: {procedural_seed: 3}", Path("b.osm"), True),
            ("map: {file: a.osm}", None, True),
            ("map: {file: a.osm}", Path("b.osm"), True),
        ):
            self.config.write_text(f"calibration: {{rig: a.yaml}}\n{section}\n")
            with mock.patch.object(self.script, "PROGRAM", program):
                drive = self.script.run_drive(1, map_file, self.config, self.drive_options())
            self.assertEqual(drive.imported, imported, (section, map_file))

    def drive_options(self) -> argparse.Namespace:
        return argparse.Namespace(out=self.config.parent, duration=1.0)

    def test_a_configuration_without_changes_is_used_itself(self) -> None:
        self.config.write_text("calibration: {rig: a.yaml, online: {enabled: true}}\n")
        with self.script.configuration(self.options()) as used:
            self.assertEqual(used, self.config)

    def test_no_drive_knows_what_another_one_learned(self) -> None:
        self.config.write_text("calibration: {rig: a.yaml, online: {enabled: true, file: b}}\n")
        before = self.config.read_text()
        with self.script.configuration(self.options()) as used:
            self.assertEqual(used.parent, self.config.parent)
            calibration = yaml.safe_load(used.read_text())["calibration"]
            self.assertEqual(calibration, {"rig": "a.yaml", "online": {"enabled": True}})
        self.assertFalse(used.exists())
        self.assertEqual(self.config.read_text(), before)

    def test_a_rig_replaces_that_of_the_configuration(self) -> None:
        self.config.write_text("calibration: {rig: a.yaml}\nmodel: {file: c}\n")
        with self.script.configuration(self.options(rig=Path("x.yaml"))) as used:
            stated = yaml.safe_load(used.read_text())
        self.assertEqual(stated["calibration"]["rig"], str(Path("x.yaml").resolve()))
        self.assertEqual(stated["model"], {"file": "c"})


class FreshMachine(unittest.TestCase):
    def test_installs_what_it_imports_before_it_imports_it(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "script"
            stubs = StubPrograms(folder)
            stubs.put("bootstrap")
            shutil.copy(ROOT / "script/evaluate", folder)
            # Without -S, Python would find the packages of this machine.
            command = ["/usr/bin/python3", "-S", str(folder / "evaluate"), "--help"]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            calls = stubs.take_calls()
        self.assertIn("No module named 'yaml'", done.stderr)
        self.assertEqual(calls, ["bootstrap python"])


if __name__ == "__main__":
    unittest.main()
