"""Tests the training bundle: its size, its independence of the machine, and a run."""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import torch

from training.bundle import (
    LIMIT_BYTES,
    BundleError,
    copy_weights,
    make,
    options_of_run,
    size_of,
)
from training.bundle_train import CONTINUES, options, without_budget
from training.checkpoint import read_checkpoint, state_of_weights
from training.config import FIRST_VALIDATION_SEED, TrainingConfig
from training.sampler_process import (
    ENVIRONMENT,
    LOADER,
    PROGRAM,
    RECORD,
    SamplerError,
    SamplerOptions,
    SamplerProcess,
)

# Packages that machines with PyTorch may lack.
FOREIGN = ("onnx", "PIL", "matplotlib", "yaml")
RUN = ("--batch", "1", "--validation-samples", "1", "--sampler-threads", "1")


def first_sample(program: Path) -> bytes:
    with unittest.mock.patch.dict(os.environ, {ENVIRONMENT: str(program)}):
        process = SamplerProcess(SamplerOptions(FIRST_VALIDATION_SEED))
    record = np.empty(1, RECORD)
    try:
        process.read(record)
        return record.tobytes()
    finally:
        process.close()


class Bundle(unittest.TestCase):
    folder: Path
    bundle: Path

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.bundle = cls.folder / "bundle"
        arguments = argparse.Namespace(init=None, run=None, photos=None)
        make(arguments, ["--samples", "2", *RUN], cls.bundle)

    def bare(self, *command: str) -> subprocess.CompletedProcess:
        """Runs a command without the environment and the further packages of this machine."""
        hidden = self.folder / "hidden"
        hidden.mkdir(exist_ok=True)
        for package in FOREIGN:
            (hidden / f"{package}.py").write_text(f"raise ImportError('no {package} here')\n")
        environment = {"PATH": "", "LD_LIBRARY_PATH": "", "PYTHONPATH": str(hidden)}
        return subprocess.run(
            command, env=environment, cwd="/", capture_output=True, text=True, timeout=280
        )

    def test_it_is_small(self):
        self.assertLess(size_of(self.bundle), LIMIT_BYTES)
        self.assertFalse(list(self.bundle.rglob("*dnnl*")))

    def test_the_sampler_loads_no_library_of_the_machine(self):
        sampler = self.bundle / "sampler"
        loader = (str(sampler / LOADER), "--inhibit-cache", "--library-path", str(sampler))
        listed = self.bare(*loader, "--list", str(sampler / PROGRAM))
        self.assertEqual(listed.returncode, 0, listed.stderr)
        lines = [line.strip() for line in listed.stdout.splitlines() if "vdso" not in line]
        self.assertGreater(len(lines), 5)
        for line in lines:
            self.assertIn(str(sampler), line)

    def test_its_sampler_makes_the_same_samples(self):
        own = first_sample(self.bundle / "sampler" / PROGRAM)
        self.assertEqual(len(own), RECORD.itemsize)
        self.assertEqual(own, first_sample(Path(os.environ[ENVIRONMENT])))

    def test_it_trains_and_resumes_with_torch_and_numpy_alone(self):
        train = (sys.executable, str(self.bundle / "train"))
        first = self.bare(*train)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("finished", first.stdout)
        checkpoint = self.bundle / "run" / "checkpoint.pt"
        self.assertEqual(read_checkpoint(checkpoint)["samples"], 2)
        self.assertEqual(options_of_run(checkpoint.parent), ["--samples", "2", *RUN[:4]])
        second = self.bare(*train, "--samples", "3")
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertEqual(read_checkpoint(checkpoint)["samples"], 3)

    def test_a_missing_package_is_named(self):
        ended = self.bare(sys.executable, "-S", str(self.bundle / "train"))
        self.assertEqual(ended.returncode, 1)
        self.assertRegex(ended.stderr, "^train: .*found no NumPy, wanted it")

    def test_checkpoints_that_would_be_too_large_are_compact(self):
        arguments = argparse.Namespace(init=None, run=None, photos=None)
        given = ["--samples", "2", "--network", "small", "--view", "lut"]
        make(arguments, given, self.folder / "small")
        stored = json.loads((self.folder / "small" / "options.json").read_text())
        self.assertEqual(stored, [*given, "--compact"])
        self.assertNotIn("--compact", (self.bundle / "options.json").read_text())

    def test_wrong_options_are_refused_when_it_is_made(self):
        arguments = argparse.Namespace(init=None, run=None, photos=None)
        said = io.StringIO()
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(said):
            make(arguments, ["--nuisances", "wild"], self.folder / "wrong")
        self.assertIn("'wild'", said.getvalue())
        self.assertFalse((self.folder / "wrong").exists())

    def test_a_bundle_that_is_too_large_is_refused(self):
        photos = self.folder / "photos"
        photos.mkdir()
        with (photos / "large").open("wb") as file:
            file.truncate(LIMIT_BYTES)
        arguments = argparse.Namespace(init=None, run=None, photos=photos)
        with self.assertRaisesRegex(BundleError, "MiB, wanted at most 60 MiB"):
            make(arguments, ["--samples", "2"], self.folder / "large")
        self.assertFalse((self.folder / "large").exists())


class Options(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def filled(
        self, run: TrainingConfig, *options: str, photos: Path | None = None
    ) -> tuple[TrainingConfig, list[str]]:
        """The configuration and the options of a bundle that continues a run."""
        torch.save(state_of_weights({}, run.as_dict()), self.folder / "checkpoint.pt")
        arguments = argparse.Namespace(init=None, run=self.folder, photos=photos)
        with unittest.mock.patch("training.bundle.fill") as fill:
            make(arguments, list(options), self.folder / "bundle")
        (self.folder / "bundle").rmdir()
        return fill.call_args.args[1:3]

    def bundled(self, run: TrainingConfig, *options: str) -> list[str]:
        return self.filled(run, *options)[1]

    def test_a_bundle_continues_a_run_without_the_end_of_its_part(self):
        run = TrainingConfig(minutes=60, stop_after_minutes=9, batch=16)
        self.assertEqual(self.bundled(run), ["--minutes", "60", "--batch", "16"])

    def test_a_bundle_continues_a_run_with_the_given_budget(self):
        run = TrainingConfig(minutes=60, batch=16)
        self.assertEqual(self.bundled(run, "--samples=8"), ["--batch", "16", "--samples=8"])

    def test_a_bundle_continues_a_run_with_its_photographs(self):
        own, others = self.folder / "own", self.folder / "others"
        for photos in (own, others):
            photos.mkdir()
        run = TrainingConfig(minutes=60, photos=str(own))
        config, options = self.filled(run)
        # The bundle's program names the folder that the photographs have there.
        self.assertEqual((config.photos, options), (str(own), ["--minutes", "60"]))
        self.assertEqual(self.filled(run, photos=others)[0].photos, str(others))
        self.assertEqual(self.filled(TrainingConfig(minutes=60))[0].photos, "")

    def test_a_bundle_does_not_continue_a_run_without_its_photographs(self):
        run = TrainingConfig(minutes=60, photos="/nowhere")
        message = "checkpoint.pt: found a run with the photographs '/nowhere', wanted this folder"
        with self.assertRaisesRegex(BundleError, message):
            self.bundled(run)
        self.assertFalse((self.folder / "bundle").exists())

    def test_a_bundle_cannot_continue_a_run_on_recorded_drives(self):
        run = TrainingConfig(samples=8, recordings="mine", map="town.osm")
        with self.assertRaisesRegex(BundleError, "^--recordings: found recorded drives, wanted a"):
            self.bundled(run)
        self.assertFalse((self.folder / "bundle").exists())

    def test_a_bundle_that_continues_a_run_says_so(self):
        config, out = TrainingConfig(samples=8), self.folder / "bundle"
        torch.save(state_of_weights({}, config.as_dict()), self.folder / "checkpoint.pt")
        out.mkdir()
        copy_weights(config, self.folder, out)
        self.assertTrue((out / CONTINUES).is_file())
        self.assertTrue((out / "run" / "checkpoint.pt").is_file())

    def test_a_bundle_that_fails_leaves_no_folder(self):
        arguments = argparse.Namespace(init=None, run=None, photos=None)
        out = self.folder / "bundle"
        for error in (BundleError("too large"), KeyboardInterrupt()):
            with unittest.mock.patch("training.bundle.copy_sampler", side_effect=error):
                with self.assertRaises(type(error)):
                    make(arguments, ["--samples", "8"], out)
            self.assertFalse(out.exists())

    def test_a_given_budget_replaces_that_of_the_bundle(self):
        own = ["--minutes", "60", "--batch", "32", "--samples=8"]
        self.assertEqual(without_budget(own), ["--batch", "32"])


class RunFolder(unittest.TestCase):
    """What `train` of a bundle resumes."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bundle, self.other = Path(folder.name) / "bundle", Path(folder.name) / "other"
        for run in (self.bundle / "run", self.other):
            run.mkdir(parents=True)
        (self.bundle / "options.json").write_text("[]")
        patched = unittest.mock.patch("training.bundle_train.FOLDER", self.bundle)
        patched.start()
        self.addCleanup(patched.stop)

    def test_train_resumes_the_run_of_its_option(self):
        elsewhere = (["--run", str(self.other)], [f"--run={self.other}"])
        (self.bundle / "run" / "checkpoint.pt").touch()
        self.assertIn("--resume", options([]))
        for given in elsewhere:
            self.assertNotIn("--resume", options(given))
        (self.other / "checkpoint.pt").touch()
        for given in elsewhere:
            self.assertIn("--resume", options(given))

    def test_train_does_not_start_anew_in_place_of_the_run_that_came_with_it(self):
        (self.bundle / CONTINUES).touch()
        (self.bundle / "run" / "checkpoint.pt").touch()
        self.assertIn("--resume", options([]))
        message = f"^train: --run: found no checkpoint.pt in {self.other}, wanted that of the run"
        with self.assertRaisesRegex(SystemExit, message):
            options(["--run", str(self.other)])
        (self.other / "checkpoint.pt").touch()
        self.assertIn("--resume", options(["--run", str(self.other)]))


class Sampler(unittest.TestCase):
    def test_missing_photographs_end_it(self):
        with self.assertRaisesRegex(SamplerError, "ended with status 2"):
            SamplerProcess(SamplerOptions(1, photos="/nowhere"))

    def test_its_end_is_reported(self):
        process = SamplerProcess(SamplerOptions(1))
        process._process.kill()
        with self.assertRaisesRegex(SamplerError, "ended with status -9"):
            process.read(np.empty(100, RECORD))

    def test_a_missing_program_is_named(self):
        with unittest.mock.patch.dict(os.environ, {ENVIRONMENT: "/nowhere/sampler"}):
            with self.assertRaisesRegex(SamplerError, "^/nowhere/sampler: cannot be started"):
                SamplerProcess(SamplerOptions(1))


if __name__ == "__main__":
    torch.set_num_threads(1)
    unittest.main()
