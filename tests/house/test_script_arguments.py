"""Tests that scripts take all of their arguments, and refuse those that they do not know."""

from __future__ import annotations

import json
import os
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


class Questions(unittest.TestCase):
    def test_the_lab_answers_where_it_cannot_run(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            stubs = StubPrograms(pathlib.Path(name) / "stubs")
            stubs.put("uname", "echo other")
            for command in ("hil --list", "hil --help", "try-image --help"):
                script, option = command.split()
                done = subprocess.run(
                    [str(ROOT / "script" / script), option],
                    env=stubs.environment(), capture_output=True, text=True, check=False,
                )
                self.assertEqual((done.returncode, done.stderr), (0, ""), command)
                self.assertIn("power-cuts" if script == "try-image" else "can-flood", done.stdout)


class FreshClone(unittest.TestCase):
    """Nothing is built in it."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.stubs = StubPrograms(self.work / "script")
        (self.work / "tooling").symlink_to(ROOT / "tooling")

    def run_script(self, name: str) -> subprocess.CompletedProcess[str]:
        shutil.copy(ROOT / "script" / name, self.work / "script")
        command = [str(self.work / "script" / name)]
        return subprocess.run(
            command, env=self.stubs.environment(), capture_output=True, text=True, check=False
        )

    def test_scripts_name_the_program_that_is_missing(self) -> None:
        for name, program in (("golden", "bevlocd"), ("results", "bevloc")):
            done = self.run_script(name)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(
                done.stderr,
                f"{self.work}/build/release/bin/{program}: found no program that runs "
                "(No such file or directory), wanted that of script/build\n",
            )

    def test_docs_sheet_builds_what_it_needs(self) -> None:
        self.stubs.put("bootstrap")
        self.stubs.put("build")
        self.stubs.put("demo", "exit 1")
        self.run_script("docs-sheet")
        self.assertEqual(
            self.stubs.take_calls()[:2],
            ["bootstrap python", "build release bevlocd bevloc bevloc_render_world"],
        )


class BootstrapScript(unittest.TestCase):
    def test_changes_nothing_if_all_packages_are_installed(self) -> None:
        lines = (ROOT / "script/packages.txt").read_text(encoding="utf-8").splitlines()
        names = [line.split()[0] for line in lines if line and not line.startswith("#")]
        # The first one is also there for another architecture, the second one is on hold.
        packages = [(name, "amd64", "install") for name in names] + [(names[0], "i386", "install")]
        packages[1] = (names[1], "amd64", "hold")
        with tempfile.TemporaryDirectory() as name:
            work = pathlib.Path(name)
            (work / "updates").mkdir()
            status = [
                f"Package: {package}\nStatus: {state} ok installed\nMaintainer: a <a@b>\n"
                f"Architecture: {architecture}\nMulti-Arch: same\nVersion: 1\n"
                "Description: none\n\n"
                for package, architecture, state in packages
            ]
            (work / "status").write_text("".join(status), encoding="ascii")
            stubs = StubPrograms(work / "stubs")
            for program in ("apt-get", "sudo"):
                stubs.put(program, "exit 1")
            done = subprocess.run(
                [str(ROOT / "script/bootstrap")],
                env={**stubs.environment(), "DPKG_ADMINDIR": name},
                capture_output=True, text=True, check=False,
            )
            self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
            self.assertEqual(stubs.take_calls(), [])


class CiScript(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        (self.work / ".ci").mkdir()
        shutil.copy(ROOT / ".ci/run", self.work / ".ci")
        self.stubs = StubPrograms(self.work / "script")
        for program in ("test", "lint", "docs", "check-vehicle", "package", "try-packages"):
            self.stubs.put(program)
        self.stubs.put("bootstrap")

    def run_ci(self, bring_up: int, unplug_camera: int, seconds: int = 0) -> tuple[int, str]:
        """Runs CI in which the scenarios of the lab end with these statuses, and 124 at the end
        of the time. Returns its status and what it says of the lab."""
        statuses = f"*bring-up*) exit {bring_up} ;; *unplug-camera) exit {unplug_camera}"
        both = f"*bring-up\\ unplug-camera) exit {unplug_camera}"
        self.stubs.put("hil", f'case "$*" in {both} ;; {statuses} ;; esac')
        done = subprocess.run(
            [str(self.work / ".ci/run")],
            env={**self.stubs.environment(), "SECONDS": str(seconds)},
            capture_output=True, text=True, check=False,
        )
        lines = [line for line in done.stdout.splitlines() if "lab" in line]
        return done.returncode, "\n".join(lines)

    def test_fails_if_a_scenario_failed_before_the_time_was_over(self) -> None:
        status, said = self.run_ci(bring_up=1, unplug_camera=124)
        self.assertEqual(status, 1)
        self.assertRegex(said, "^ci: skipped in the lab, [0-9]+ s were too few for it: unplug-")
        self.assertEqual(self.run_ci(bring_up=77, unplug_camera=1)[0], 1)

    def test_says_which_scenarios_it_skipped(self) -> None:
        self.assertEqual(self.run_ci(bring_up=0, unplug_camera=0), (0, ""))
        status, said = self.run_ci(bring_up=77, unplug_camera=124)
        self.assertEqual(status, 0)
        self.assertIn("for the reason above: bring-up\n", said)
        self.assertIn("too few for it: unplug-camera", said)

    def test_starts_no_scenario_without_time(self) -> None:
        self.stubs.take_calls()
        status, said = self.run_ci(bring_up=1, unplug_camera=1, seconds=2000)
        self.assertEqual((status, said.count("too few")), (0, 2))
        self.assertNotIn("hil", " ".join(self.stubs.take_calls()).replace("bootstrap hil", ""))


@unittest.skipIf(os.geteuid() != 0, "only root may make packages")
class PackageScript(unittest.TestCase):
    def test_the_owner_of_the_tree_can_build_again(self) -> None:
        nobody = 65534
        with tempfile.TemporaryDirectory() as name:
            tree = pathlib.Path(name) / "bevloc"
            tree.mkdir()
            os.chown(tree, nobody, nobody)
            stubs = StubPrograms(tree / "script")
            for program in ("bootstrap", "lintian"):
                stubs.put(program)
            stubs.put("dpkg-parsechangelog", "echo 1")
            log = "build/release/.ninja_log"
            packages = "touch ../bevloc{,-dev,-models,-sim}_1_amd64.deb"
            stubs.put("dpkg-buildpackage", f"mkdir -p build/release; touch {log}; {packages}")
            shutil.copy(ROOT / "script/package", tree / "script")
            subprocess.run(
                [str(tree / "script/package"), "--here"],
                env=stubs.environment(), capture_output=True, check=True,
            )
            for file in ("build", "build/release", log):
                self.assertEqual((tree / file).stat().st_uid, nobody, file)


class TrainScript(unittest.TestCase):
    def test_an_export_of_a_run_on_nuscenes_does_not_look_done(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "script"
            stubs = StubPrograms(folder)
            for program in ("bootstrap", "build"):
                stubs.put(program)
            shutil.copy(ROOT / "script/train", folder)
            export = pathlib.Path(name) / "training/export_onnx.py"
            export.parent.mkdir()
            export.write_text("raise SystemExit('found a run on nuScenes')\n", encoding="utf-8")
            command = [str(folder / "train"), "--export-only", "run", "--nuscenes", "DIR"]
            done = subprocess.run(
                command, env=stubs.environment(), capture_output=True, text=True, check=False
            )
        self.assertEqual((done.returncode, done.stderr), (1, "found a run on nuScenes\n"))


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
