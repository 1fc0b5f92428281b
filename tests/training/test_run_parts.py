"""Tests the parts of a run: options, precision, patience, checkpoints and progress."""

import contextlib
import dataclasses
import io
import tempfile
import unittest
from pathlib import Path
from unittest.mock import patch

import torch

from training.checkpoint import load_network, network_of, read_checkpoint, write_checkpoint
from training.config import TrainingConfig
from training.early_stop import Patience
from training.errors import CheckpointError, TrainingError
from training.models import PRESETS, BevNetwork
from training.options import parse_config
from training.precision import choose_precision, cpu_flags
from training.progress import Progress

CPU = torch.device("cpu")


class Options(unittest.TestCase):
    def refusal(self, *arguments: str, processes: int = 1) -> str:
        said = io.StringIO()
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(said):
            parse_config(list(arguments), "", processes)
        return said.getvalue()

    def test_every_field_is_an_option(self):
        arguments = ["--samples", "8", "--run", "x", "--network", "small", "--clip-norm", "2"]
        config = parse_config([*arguments, "--resume"], "")
        self.assertEqual((config.run, config.samples, config.resume), (Path("x"), 8, True))
        self.assertEqual((config.network, config.clip_norm, config.minutes), ("small", 2.0, 0.0))

    def test_invalid_options_are_refused(self):
        budget = ("--samples", "8")
        self.assertIn("--minutes or --samples", self.refusal())
        self.assertIn("--minutes or --samples", self.refusal(*budget, "--minutes", "1"))
        self.assertIn("'float16'", self.refusal(*budget, "--precision", "float16"))
        self.assertIn("'wild'", self.refusal(*budget, "--nuisances", "wild"))
        self.assertIn("'hope'", self.refusal(*budget, "--on-error", "hope"))
        self.assertIn("multiple of 3 processes", self.refusal(*budget, processes=3))
        self.assertIn("'tiny'", self.refusal(*budget, "--network", "tiny"))
        self.assertIn("'magic'", self.refusal(*budget, "--view", "magic"))
        self.assertIn("384 x 896", self.refusal(*budget, "--network", "paper-resnet50"))
        self.assertIn("found 401, wanted at least 4294967296", self.refusal(*budget, "--seed=401"))
        self.assertIn("no --scenes", self.refusal(*budget, "--validation-scenes", "val.txt"))
        self.assertIn("found no --nuscenes", self.refusal(*budget, "--scenes", "train.txt"))
        self.assertIn("found no --recordings", self.refusal(*budget, "--rig", "rig.yaml"))
        self.assertIn("unrecognized", self.refusal(*budget, "--record", "drives"))
        self.assertIn("found 0.0, wanted more", self.refusal(*budget, "--validation-minutes", "0"))
        self.assertIn("found 0, wanted 1 to 1024", self.refusal(*budget, "--sampler-threads", "0"))
        self.assertIn("found 0, wanted at least 1", self.refusal(*budget, "--log-steps", "0"))
        self.assertIn("wanted less than 2^63", self.refusal(*budget, "--seed", str(2**64)))

    def test_runs_with_different_seeds_share_no_scene(self):
        budget = ("--samples", "8")
        for seed in (2**32 + 1, 2**32 + 2**29):
            said = self.refusal(*budget, f"--seed={seed}")
            self.assertIn(f"--seed: found {seed}, wanted a multiple of {2**30}", said)
        for factor in (4, 5, 6, 56):
            accepted = parse_config([*budget, f"--seed={factor * 2**30}"], "")
            self.assertEqual(accepted.seed, factor * 2**30)

    def test_more_processes_need_seeds_further_apart(self):
        budget = ("--samples", "8", "--batch", "240")
        for processes, apart in ((3, 2**32), (8, 2**31), (16, 2**32), (5, 2**33)):
            said = self.refusal(*budget, f"--seed={2**33 + 2**30}", processes=processes)
            self.assertIn(f"wanted a multiple of {apart}", said)
            parse_config([*budget, f"--seed={2**33}"], "", processes)

    def test_the_seed_of_nuscenes_is_no_scene(self):
        parse_config(["--samples", "8", "--nuscenes", "tree", f"--seed={2**32 + 1}"], "")

    def test_each_number_has_a_range(self):
        for field in dataclasses.fields(TrainingConfig):
            kind = type(field.default)
            if kind not in (int, float):
                continue
            budget = "--minutes=1" if field.name == "samples" else "--samples=8"
            for wrong in ("-1",) if kind is int else ("-1", "nan", "inf"):
                option = f"--{field.name.replace('_', '-')}"
                self.assertIn(f"error: {option}: found", self.refusal(budget, f"{option}={wrong}"))


class Precisions(unittest.TestCase):
    def test_auto_follows_the_processor(self):
        self.addCleanup(torch.backends.mkldnn.set_flags, torch.backends.mkldnn.set_flags(True)[0])
        self.assertTrue(choose_precision("auto", CPU, {"avx2", "avx512_bf16"}).bfloat16)
        self.assertTrue(choose_precision("auto", CPU, {"amx_bf16"}).bfloat16)
        chosen = choose_precision("auto", CPU, {"avx2"})
        self.assertEqual(str(chosen), "float32 (the CPU has neither amx_bf16 nor avx512_bf16)")

    def test_auto_follows_the_gpu(self):
        second = torch.device("cuda", 1)
        for capability, able in (((7, 5), False), ((8, 0), True), ((9, 0), True)):
            with patch("torch.cuda.get_device_capability", return_value=capability) as asked, \
                    patch("torch.cuda.is_bf16_supported", return_value=True), \
                    patch("torch.version.hip", None):
                self.assertEqual(choose_precision("auto", second, set()).bfloat16, able)
            asked.assert_called_once_with(second)

    def test_auto_needs_onednn_on_the_processor(self):
        self.addCleanup(torch.backends.mkldnn.set_flags, torch.backends.mkldnn.set_flags(False)[0])
        chosen = choose_precision("auto", CPU, {"amx_bf16"})
        self.assertFalse(chosen.bfloat16)
        self.assertIn("oneDNN", str(chosen))

    def test_an_explicit_choice_is_kept(self):
        self.assertTrue(choose_precision("bfloat16", CPU, set()).bfloat16)
        self.assertFalse(choose_precision("float32", CPU, {"amx_bf16"}).bfloat16)

    def test_flags_are_read_as_linux_writes_them(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "cpuinfo"
            self.assertEqual(cpu_flags(file), set())
            file.write_text("processor\t: 0\nmodel name\t: made up\nflags\t\t: fpu avx512_bf16\n")
            self.assertEqual(cpu_flags(file), {"fpu", "avx512_bf16"})


class Patiences(unittest.TestCase):
    def watched(self, figure: str, values: list[float], limit: int = 2) -> Patience:
        patience = Patience(figure, limit)
        for i, value in enumerate(values):
            patience.watch({figure: value}, 100 * i)
        return patience

    def test_lower_errors_and_higher_iou_are_improvements(self):
        rising = [0.1, 0.2, 0.3]
        self.assertTrue(self.watched("joint_x_mae", rising).exhausted)
        self.assertFalse(self.watched("iou_divider", rising).exhausted)
        self.assertFalse(self.watched("joint_x_mae", [0.5, 0.6, 0.4, 0.5]).exhausted)

    def test_no_limit_never_ends(self):
        self.assertFalse(self.watched("joint_x_mae", [0.1] * 9, limit=0).exhausted)

    def test_a_resumed_run_continues_counting(self):
        patience = Patience("joint_x_mae", 2)
        patience.resume(self.watched("joint_x_mae", [0.1, 0.2]).state())
        self.assertEqual((patience.best, patience.waited), (0.1, 1))
        patience.watch({"joint_x_mae": 0.1}, 300)
        self.assertTrue(patience.exhausted)

    def test_the_count_restarts_for_another_figure(self):
        patience = Patience("iou_divider", 2)
        patience.resume(self.watched("joint_x_mae", [0.1, 0.2]).state())
        self.assertEqual((patience.best, patience.waited), (None, 0))

    def test_the_count_restarts_after_other_scenes(self):
        state = self.watched("joint_x_mae", [0.1, 0.2]).state()
        del state["scenes"]  # as in a checkpoint of older code
        patience = Patience("joint_x_mae", 2)
        patience.resume(state)
        self.assertEqual((patience.best, patience.waited), (None, 0))

    def test_a_bias_is_refused_as_the_figure(self):
        with self.assertRaisesRegex(TrainingError, "'joint_x_bias', wanted one of"):
            Patience("joint_x_bias", 1).check(["joint"], ["x"], ["divider"])
        Patience("joint_x_mae", 1).check(["joint"], ["x"], ["divider"])


class Checkpoints(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "checkpoint.pt"

    def write(self, network: BevNetwork, config: dict) -> None:
        weights = network.state_dict()
        state = {"model": weights, "ema": weights, "samples": 0, "config": config}
        torch.save(state, self.path)

    def test_the_chosen_network_is_restored(self):
        config = {"network": "small", "view": "lut"}
        network = BevNetwork(network_of({"config": config}, self.path))
        self.write(network, config)
        loaded = load_network(self.path)
        self.assertEqual((loaded.config.name, loaded.config.view), ("small-lut", "lut"))
        self.assertTrue(torch.equal(loaded.head.second.weight, network.head.second.weight))
        self.assertFalse(loaded.training)

    def test_a_full_disk_leaves_the_checkpoint(self):
        self.path.write_text("good")

        def fill_the_disk(_: dict, path: Path) -> None:
            path.write_text("half")
            raise OSError("no space left")

        with patch("torch.save", side_effect=fill_the_disk), self.assertRaises(OSError):
            write_checkpoint({}, self.path)
        self.assertEqual(self.path.read_text(), "good")

    def test_an_old_checkpoint_without_a_network_name_is_nano(self):
        self.write(BevNetwork(PRESETS["nano"]), {"bf16": True})
        self.assertEqual(load_network(self.path).config, PRESETS["nano"])

    def test_files_that_are_no_checkpoints_are_refused_with_the_reason(self):
        with self.assertRaisesRegex(CheckpointError, f"^{self.path}: no such file"):
            read_checkpoint(self.path)
        for content in (b"", b"PK\x03\x04 cut short", b"\x80\x02."):
            self.path.write_bytes(content)
            with self.assertRaisesRegex(CheckpointError, f"^{self.path}: unreadable.*\\)$"):
                read_checkpoint(self.path)
        torch.save({"model": {}}, self.path)
        with self.assertRaisesRegex(CheckpointError, "found no 'ema'"):
            read_checkpoint(self.path)
        torch.save([1, 2], self.path)
        with self.assertRaisesRegex(CheckpointError, "wanted a checkpoint of training.train"):
            read_checkpoint(self.path)

    def test_weights_that_do_not_fit_are_refused_in_one_line(self):
        self.write(BevNetwork(PRESETS["nano"]), {"network": "small"})
        with self.assertRaisesRegex(CheckpointError, "current network 'small'") as caught:
            load_network(self.path)
        self.assertNotIn("\n", str(caught.exception))
        self.write(BevNetwork(PRESETS["nano"]), {"network": "gone"})
        with self.assertRaisesRegex(CheckpointError, "network: found 'gone'"):
            load_network(self.path)


class Lines(unittest.TestCase):
    def test_rate_and_waiting_refer_to_the_busy_time(self):
        progress = Progress()
        progress.add(torch.tensor([1.0, 2.0]), samples=8, busy_s=1.5, waited_s=0.0)
        progress.add(torch.tensor([3.0, 4.0]), samples=8, busy_s=0.5, waited_s=0.5)
        self.assertEqual(progress.mean_losses().tolist(), [2.0, 3.0])
        self.assertEqual(progress.rate, 8.0)
        self.assertEqual(progress.bottleneck, "25 % waiting for samples")


if __name__ == "__main__":
    unittest.main()
