"""Tests that scripts take all of their arguments, and refuse those that they do not know."""

from __future__ import annotations

import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from tests.house.test_documents import ROOT
from tests.support.stub_programs import StubPrograms


class Refusals(unittest.TestCase):
    def expect_refused(self, message: str, name: str, *arguments: str) -> None:
        command = [str(ROOT / "script" / name), *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(message, done.stderr)

    def test_bootstrap_names_the_lists(self) -> None:
        self.expect_refused("found list 'pyhton', wanted one of", "bootstrap", "pyhton")
        self.expect_refused(" python ", "bootstrap", "lint", "pyhton")

    def test_docs_sheet_takes_no_arguments(self) -> None:
        self.expect_refused("unrecognized arguments: docs", "docs-sheet", "docs")

    def test_image_does_not_replace_what_is_no_file(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.expect_refused(f"found '{folder}', which is no file", "image", "--out", folder)

    def test_train_checks_the_number_of_scenes_before_it_trains(self) -> None:
        for wrong in ("0", "-5", "1e3", "many"):
            message = f"--evaluation: found '{wrong}', wanted a whole number of at least 1"
            self.expect_refused(message, "train", "--samples", "8", "--evaluation", wrong)

    def test_package_builds_for_this_machine_or_in_a_root(self) -> None:
        for more in (["arm64", "trixie"], ["--test"]):
            self.expect_refused(f"found '--here {' '.join(more)}'", "package", "--here", *more)


class TestScript(unittest.TestCase):
    def test_runs_each_preset_that_it_is_given(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "script"
            stubs = StubPrograms(folder)
            for program in ("bootstrap", "build", "ctest"):
                stubs.put(program)
            shutil.copy(ROOT / "script/test", folder)
            command = [str(folder / "test"), "release", "tsan"]
            subprocess.run(command, env=stubs.environment(), capture_output=True, check=True)
            calls = stubs.take_calls()
        self.assertEqual(
            calls,
            ["bootstrap python", "build release", "ctest --preset release", "build tsan",
             "ctest --preset tsan"],
        )


class SanitizerOptions(unittest.TestCase):
    """They are in the presets, so that every script runs the sanitizers with them."""

    def test_name_files_that_exist(self) -> None:
        presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
        found = {preset["name"]: preset for preset in presets["configurePresets"]}
        for name, variable in (("asan", "LSAN_OPTIONS"), ("tsan", "TSAN_OPTIONS")):
            options = found[name]["environment"][variable]
            file = options.partition("suppressions=${sourceDir}/")[2]
            self.assertTrue((ROOT / file).is_file(), options)


if __name__ == "__main__":
    unittest.main()
