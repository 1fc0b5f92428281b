"""Tests quantization and the ONNX files, on an untrained network."""

import contextlib
import copy
import io
import math
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import onnx
import torch
from onnx import numpy_helper

from tests.training.synthetic import SyntheticStream
from tests.training.untrained import untrained_network
from training import export_onnx, exported_network
from training.checkpoint import state_of_weights
from training.config import TrainingConfig
from training.data import Batch, view_table
from training.errors import TrainingError
from training.evaluate import float_inference
from training.export_onnx import build_model, check_source, fitting_batches, rig_statements
from training.graph import Walk, check_exportable, folded_convolutions
from training.models import PRESETS, BevNetwork
from training.models.config import network_config
from training.onnx_graph import FloatOnnxBackend, Int8OnnxBackend
from training.quantize import (
    MAX_WEIGHT,
    SCALE_BITS,
    FloatBackend,
    Quantization,
    Scale,
    best_scale,
    bias_steps,
    int8_inference,
    quantize,
    quantize_weights,
    round_bias,
    run,
)
from training.rig_ranges import RANGE_KEYS, RigRanges
from training.runtime import NativeNetwork
from training.sampler_process import DriveFacts, Drives

ROOT = Path(__file__).resolve().parents[2]


def constants_of(model: onnx.ModelProto) -> dict[str, np.ndarray]:
    return {tensor.name: numpy_helper.to_array(tensor) for tensor in model.graph.initializer}


class Scales(unittest.TestCase):
    def test_an_outlier_is_clipped_to_keep_the_other_values_precise(self):
        torch.manual_seed(0)
        values = torch.cat((torch.rand(200_000), torch.tensor([100.0])))
        scale = best_scale(values, unsigned=True)
        error = (scale.quantize(values[:-1]) - values[:-1]).square().mean().sqrt().item()
        self.assertLess(error, (scale.quantize(values[-1]) - values[-1]).abs().item())

    def test_elements_stay_in_their_range(self):
        values = torch.tensor([-1e9, -1.0, 0.0, 1.0, 1e9])
        self.assertEqual(Scale(0.5, True).quantize(values).tolist(), [0, 0, 0, 1.0, 127.5])
        self.assertEqual(Scale(0.5, False).quantize(values).tolist(), [-64, -1.0, 0, 1.0, 63.5])

    def test_activations_count_in_powers_of_two(self):
        for largest in (1e-3, 0.7, 3.0, 1000.0):
            for unsigned in (True, False):
                scale = best_scale(torch.linspace(0, largest, 1000), unsigned)
                self.assertEqual(math.frexp(scale.scale)[0], 0.5)
                clipped = scale.clips(torch.linspace(0, largest, 1000)).float().mean()
                self.assertLess(clipped.item(), 0.2)

    def test_scales_of_weights_have_short_mantissas(self):
        for conv in folded_convolutions(untrained_network()).values():
            mantissa = torch.frexp(quantize_weights(conv).scale).mantissa * 2**SCALE_BITS
            self.assertTrue(torch.equal(mantissa, mantissa.round()), conv.name)

    def test_weights_have_seven_bits(self):
        for conv in folded_convolutions(untrained_network()).values():
            quantized = quantize_weights(conv)
            self.assertLessEqual(int(quantized.weight.abs().max()), MAX_WEIGHT)
            error = (quantized.real_weight() - conv.weight).abs().flatten(1).amax(1)
            self.assertLess((error / conv.weight.abs().flatten(1).amax(1)).max().item(), 0.45)


class Export(unittest.TestCase):
    net: BevNetwork
    batch: Batch
    quantization: Quantization
    model: onnx.ModelProto
    float_model: onnx.ModelProto
    constants: dict[str, np.ndarray]

    @classmethod
    @torch.no_grad()
    def setUpClass(cls):
        torch.set_num_threads(1)
        cls.net, cls.batch = untrained_network(), SyntheticStream(3).next(2)
        cls.quantization = quantize(cls.net, [cls.batch])
        convolutions = cls.quantization.convolutions
        cls.model = build_model(cls.net, convolutions, Int8OnnxBackend(cls.quantization))
        cls.float_model = build_model(cls.net, convolutions, FloatOnnxBackend())
        cls.constants = constants_of(cls.model)

    def test_the_walk_equals_the_network(self):
        with torch.no_grad():
            expected = float_inference(self.net)(self.batch)
            walked = run(
                self.net, self.quantization.convolutions, FloatBackend(self.batch), self.batch
            )
        for a, b in zip(expected, walked):
            torch.testing.assert_close(a, b, rtol=1e-3, atol=1e-4)

    def test_rounding_changes_the_features_little(self):
        expected = run(
            self.net, self.quantization.convolutions, FloatBackend(self.batch), self.batch
        )
        rounded = int8_inference(self.net, self.quantization)(self.batch)
        for a, b in zip(expected, rounded):
            self.assertLess((a - b).std().item(), 0.5 * a.std().item())

    def test_bias_correction_removes_the_mean_rounding_error(self):
        """Checked on the network's outputs, where the errors of all layers add up."""
        convolutions, uncorrected = self.quantization.convolutions, copy.deepcopy(self.quantization)
        for name, step in bias_steps(self.net, uncorrected).items():
            uncorrected.quantized[name].bias = round_bias(convolutions[name].bias, step)
        exact = run(self.net, convolutions, FloatBackend(self.batch), self.batch)
        for side in range(3):
            errors = [
                (int8_inference(self.net, quantization)(self.batch)[side] - exact[side])
                for quantization in (uncorrected, self.quantization)
            ]
            before, after = (error.mean((0, 2, 3)).abs().max().item() for error in errors)
            self.assertLess(after, 0.1 * before)

    def test_the_file_holds_8_bit_weights_and_zero_zero_points(self):
        for name, values in self.constants.items():
            if name.endswith(".zero"):
                self.assertFalse(values.any(), name)
            if name.endswith(".weight"):
                self.assertEqual(values.dtype, np.int8, name)
            if name.endswith(".bias"):
                self.assertEqual(values.dtype, np.int32, name)
            if name.endswith(".scale"):
                self.assertTrue((values > 0).all(), name)
        convolutions = [node for node in self.model.graph.node if node.op_type == "Conv"]
        self.assertEqual(len(convolutions), len(self.quantization.convolutions))

    def test_the_float_file_holds_the_same_network_unrounded(self):
        operators = {node.op_type for node in self.float_model.graph.node}
        self.assertNotIn("QuantizeLinear", operators)
        constants = constants_of(self.float_model)
        for name, conv in self.quantization.convolutions.items():
            np.testing.assert_array_equal(constants[f"{name}.bias"], conv.bias.numpy())
        self.assertEqual(
            [port.name for port in self.float_model.graph.output],
            ["bev_features", "map_features", "bev_mask"],
        )

    def test_a_saved_quantization_computes_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "quantization.pt"
            self.quantization.save(path)
            loaded = Quantization.load(self.net, path)
        expected = int8_inference(self.net, self.quantization)(self.batch)
        for a, b in zip(expected, int8_inference(self.net, loaded)(self.batch)):
            self.assertTrue(torch.equal(a, b))

    @torch.no_grad()
    def test_the_executor_computes_the_simulated_values_to_the_bit(self):
        batch = SyntheticStream(4).next(1)
        index, weight = view_table(int(batch.camera_mask[0]))
        batch.index, batch.weight = index[None], weight[None]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "untrained.onnx"
            onnx.save(self.model, str(path))
            found = NativeNetwork(path)(batch)
        for a, b in zip(found, int8_inference(self.net, self.quantization)(batch)):
            self.assertTrue(torch.equal(a, b))

    def test_weights_after_space_to_depth_are_in_its_channel_order(self):
        name = "map_encoder.layers.0"
        weight = self.quantization.quantized[name].weight.numpy()
        exported = self.constants[f"{name}.weight"]
        for channel in range(3):
            for row in range(2):
                for col in range(2):
                    np.testing.assert_array_equal(
                        exported[:, (row * 2 + col) * 3 + channel],
                        weight[:, channel * 4 + row * 2 + col],
                    )

    def test_parts_that_the_executor_does_not_support_are_refused(self):
        for name, part in (("small", "view transform is kernel"), ("paper-resnet50", "resnet50")):
            with self.assertRaisesRegex(TrainingError, f"'{name}' cannot be exported.*{part}"):
                check_exportable(PRESETS[name])
        with self.assertRaisesRegex(TrainingError, "kernel"):
            Walk(BevNetwork(network_config("nano", "kernel")), {}, FloatOnnxBackend())

    def test_the_model_file_contains_the_solver_parameters(self):
        properties = {entry.key: entry.value for entry in self.model.metadata_props}
        self.assertEqual(properties["bevloc.model"], "nano")
        for name in ("joint", "x", "y", "yaw"):
            expected = self.net.solvers.scale(name).item()
            self.assertAlmostEqual(
                float(properties[f"bevloc.solver.{name}_scale"]), expected, delta=1e-4 * expected
            )
        onnx.checker.check_model(self.model, full_check=True)

    def test_the_model_file_states_the_rig_that_it_was_trained_with(self):
        for path in (None, "models/nano.onnx", "models/nano_float.onnx"):
            model = onnx.load(ROOT / path) if path else self.model
            properties = {entry.key: entry.value for entry in model.metadata_props}
            self.assertEqual(
                properties["bevloc.rig.cameras"],
                "front_left front front_right back_left back back_right",
            )
            self.assertEqual(properties["bevloc.rig.image_size_px"], "320 96")
            focal_px = [float(word) for word in properties["bevloc.rig.focal_px"].split(" ")]
            self.assertAlmostEqual(focal_px[1], 506.56 / 2, delta=0.1)
            heights = [float(word) for word in properties["bevloc.rig.height_m"].split(" ")]
            self.assertEqual(heights[4], 1.579)

    def test_a_model_trained_on_many_rigs_states_their_range(self):
        self.assertNotIn("bevloc.rig.focal_range_px", rig_statements("strong"))
        statements = rig_statements("street")
        least, most = map(float, statements["bevloc.rig.focal_range_px"].split(" "))
        # The rigs see up to 120 degrees, and a network image shows the middle 90 of them.
        widest, narrowest = math.radians(90 / 2), math.radians(50 / 2)
        self.assertAlmostEqual(least, 160 / math.tan(widest), delta=0.1)
        self.assertAlmostEqual(most, 160 / math.tan(narrowest), delta=0.2)

    def test_a_model_trained_on_drives_states_their_rigs_too(self):
        facts = DriveFacts({}, (200.0, 600.0), (1.2, 3.1))
        for nuisances, lowest_m in (("usual", 1.2), ("street", 0.6)):
            statements = rig_statements(nuisances, facts)
            least, most = map(float, statements["bevloc.rig.focal_range_px"].split(" "))
            # The least one is that of the demo rig's back camera, or of the random rigs.
            self.assertLess(least, 162)
            self.assertGreaterEqual(most, 600)
            self.assertLess(most, 640)
            least, most = map(float, statements["bevloc.rig.height_range_m"].split(" "))
            self.assertLessEqual(least, lowest_m)
            self.assertGreater(least, 0.9 * lowest_m)
            self.assertGreaterEqual(most, 3.1)

    def test_a_model_states_the_rigs_of_its_start_and_of_the_simulator_too(self):
        statements = rig_statements("usual", stored=[RigRanges((300.0, 400.0), (1.8, 3.2))])
        # The least ones are those of the demo rig.
        self.assertEqual([statements[key] for key in RANGE_KEYS], ["161.8 400", "1.496 3.2"])


class Sources(unittest.TestCase):
    """Which runs are exported, and with which samples."""

    drives = Drives("drives", "town.osm")
    path = Path("run/checkpoint.pt")

    def refusal(self, config: TrainingConfig, drives: Drives | None = None) -> str:
        with self.assertRaises(TrainingError) as caught:
            check_source(config.as_dict(), self.path, drives)
        return str(caught.exception)

    def test_a_run_on_real_data_is_not_exported_as_one_on_the_simulator(self):
        said = self.refusal(TrainingConfig(nuscenes="/data/nuscenes"))
        self.assertIn("run/checkpoint.pt: found a run on nuScenes (/data/nuscenes)", said)
        said = self.refusal(TrainingConfig(recordings="mine", map="town.osm"))
        self.assertIn("found a run on recorded drives", said)
        self.assertIn("give --recordings mine --map town.osm", said)

    def test_drives_have_the_calibration_and_the_reference_of_the_run(self):
        run = TrainingConfig(recordings="mine", map="m", rig="new.yaml", reference="own")
        said = self.refusal(run)
        self.assertIn("give --recordings mine --map m --rig new.yaml --reference own", said)
        same = replace(self.drives, rig="moved/new.yaml", reference="own")
        check_source(run.as_dict(), self.path, same)
        for others in (
            self.drives,
            replace(same, rig=""),
            replace(same, reference="file"),
        ):
            self.assertEqual(self.refusal(run, others), said)
        recorded = TrainingConfig(recordings="mine", map="m", on_error="skip")
        said = self.refusal(recorded, replace(self.drives, rig="new.yaml"))
        self.assertIn("with the same rig and reference poses", said)
        self.assertTrue(said.endswith("give --recordings mine --map m --on-error skip"), said)

    def test_other_runs_are_exported(self):
        check_source(TrainingConfig().as_dict(), self.path, None)
        check_source({}, self.path, None)  # an old checkpoint
        check_source(TrainingConfig(recordings="mine", map="m").as_dict(), self.path, self.drives)

    def test_ranges_and_scales_are_fitted_on_samples_that_training_does_not_use(self):
        enough = [range(8)]
        with patch("training.sources.drive_batches", return_value=enough) as read:
            self.assertEqual(fitting_batches(self.drives, "street", 8, 2), (enough, enough))
        read.assert_called_once_with(self.drives, "calibration", 8, 2)

    def test_scales_are_not_fitted_to_a_few_samples(self):
        for found, refused in ((23, True), (24, False)):
            with patch("training.sources.drive_batches", return_value=[range(found)]):
                if not refused:
                    fitting_batches(self.drives, "street", 384, 2)
                    continue
                message = f"drives: found {found} samples of the part calibration, wanted at least"
                with self.assertRaisesRegex(TrainingError, message):
                    fitting_batches(self.drives, "street", 384, 2)

    def test_the_score_is_fitted_on_usual_samples(self):
        with patch("training.export_onnx.calibration_batches", side_effect=[["a"], ["b"]]) as read:
            self.assertEqual(fitting_batches(None, "street", 8, 2), (["a"], ["b"]))
        self.assertEqual([call.args for call in read.call_args_list], [(8, 2, "street"), (8, 2)])

    def test_a_network_with_unusable_scales_leaves_the_shipped_model(self):
        batch = SyntheticStream(3).next(1)
        batch.correction[:] = torch.tensor([50.0, 50.0, 1.0])  # no match finds this place
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            checkpoint, shipped = folder / "checkpoint.pt", folder / "models/nano.onnx"
            torch.save(state_of_weights(untrained_network().state_dict(), {}), checkpoint)
            shipped.parent.mkdir()
            shipped.write_text("shipped")
            arguments = ["export", str(checkpoint), str(shipped.parent)]
            with patch("training.export_onnx.fitting_batches", return_value=([batch], [batch])), \
                    patch("training.export_onnx.fit_scales"), patch("sys.argv", arguments):
                with self.assertRaisesRegex(TrainingError, "factor of the .*: found .*, wanted"):
                    export_onnx.main()
            self.assertEqual(shipped.read_text(), "shipped")
            self.assertEqual(list(shipped.parent.iterdir()), [shipped])

    def test_a_network_without_export_is_refused_before_training(self):
        def name_of(*options: str) -> str:
            said = io.StringIO()
            arguments = ["program", "--samples", "8", *options]
            with patch("sys.argv", arguments), contextlib.redirect_stdout(said):
                exported_network.main()
            return said.getvalue().strip()

        self.assertEqual(name_of(), "nano")
        self.assertEqual(name_of("--network", "small", "--view", "lut"), "small-lut")
        with self.assertRaisesRegex(TrainingError, "'small' cannot be exported"):
            name_of("--network", "small")


if __name__ == "__main__":
    unittest.main()
