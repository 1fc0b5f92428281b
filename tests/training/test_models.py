"""Tests the configurable networks."""

import math
import unittest
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch
from torch import nn

from tests.training.synthetic import gradient_of
from training import model_table
from training.models import PRESETS, BevNetwork, ModelConfig
from training.models.config import VIEWS
from training.models.cost import cost_of, measure, sample_inputs
from training.models.efficientnet import EfficientNetB0
from training.models.layers import Attention, cell_centres, sine_encoding
from training.models.network import make_view
from training.models.onednn import turn_off_if_wrong
from training.models.resnet50 import ResNet50
from training.models.rig import Camera, nominal_cameras
from training.models.view_dense import DenseView
from training.models.view_kernel import kernel_of_table
from training.solvers.definition import DEFINITION

CELLS = 5000
NANO_STATE = Path(__file__).with_name("nano_state.txt")  # names and shapes


def setUpModule():
    torch.set_num_threads(1)
    torch.manual_seed(1)


def reduced(config: ModelConfig) -> ModelConfig:
    """The configuration with smaller images and narrower attention if the preset's are large."""
    if config.token_grid is None:
        return config
    return replace(
        config,
        image_size=(128, 256),
        token_grid=(4, 8),
        query_grid=(16, 8),
        width=64,
        feedforward_width=128,
        position_width=128,
    )


def small_view(kind: str) -> tuple[ModelConfig, nn.Module]:
    config = ModelConfig(
        name=kind, view=kind, width=16, heads=2, query_grid=(10, 5), image_size=(32, 64)
    )
    return config, make_view(config, None).eval()


def parameters(module: nn.Module) -> int:
    return sum(parameter.numel() for parameter in module.parameters())


def table_of(
    projections: dict[int, tuple[int, float, float]], grid: tuple[int, int]
) -> tuple[torch.Tensor, torch.Tensor]:
    """A view table in which each given BEV cell projects to (camera, row, column)."""
    rows, cols = grid
    index = torch.zeros(1, 8, CELLS, dtype=torch.long)
    weight = torch.zeros(1, 8, CELLS)
    for cell, (camera, row, col) in projections.items():
        top, left = math.floor(row), math.floor(col)
        for n in range(4):
            r, c = top + n // 2, left + n % 2
            index[0, n, cell] = (camera * rows + min(r, rows - 1)) * cols + min(c, cols - 1)
            weight[0, n, cell] = (1 - abs(row - r)) * (1 - abs(col - c))
    return index, weight


class Presets(unittest.TestCase):
    def test_nano_has_the_weights_of_its_checkpoints(self):
        found = {
            name: "x".join(map(str, value.shape)) or "scalar"
            for name, value in BevNetwork(PRESETS["nano"]).state_dict().items()
        }
        lines = NANO_STATE.read_text().splitlines()
        self.assertEqual(found, dict(line.split() for line in lines))

    def test_shapes(self):
        nano = PRESETS["nano"]
        others = (
            replace(nano, channels=4),
            replace(nano, channels=64, bev_size=(400, 200)),
            replace(nano, trunk="efficientnet_b0", image_size=(128, 384), view="kernel"),
            replace(nano, view="dense"),
        )
        for config in (*PRESETS.values(), *others):
            network = BevNetwork(config).to("meta")
            outputs = network(*sample_inputs(config, "meta"))
            expected = [(1, config.channels, *config.bev_size)] * 2 + [(1, 3, 400, 200)] * 2
            self.assertEqual([tuple(output.shape) for output in outputs], expected, config.name)

    def test_the_solvers_use_the_networks_cell_size(self):
        definition = replace(PRESETS["nano"], bev_size=(400, 200)).solver_definition()
        self.assertEqual((definition.rows, definition.cols), (400, 200))
        self.assertAlmostEqual(definition.cell_m, 0.15)
        self.assertEqual(PRESETS["nano"].solver_definition(), DEFINITION)

    def test_gradients_reach_every_parameter(self):
        fine = replace(PRESETS["nano"], bev_size=(400, 200), width=16, head_width=8)
        for config in (*PRESETS.values(), fine):
            config = reduced(config)
            network = BevNetwork(config)
            outputs = network(*sample_inputs(config, "cpu"))
            sum((output * torch.randn_like(output)).mean() for output in outputs).backward()
            for name, parameter in network.named_parameters():
                if not name.startswith("solvers."):
                    self.assertIsNotNone(parameter.grad, f"{config.name}: {name}")
                    gradient = gradient_of(parameter)
                    self.assertTrue(gradient.isfinite().all(), f"{config.name}: {name}")
                    self.assertTrue(gradient.any(), f"{config.name}: {name}")

    def test_training_in_bfloat16(self):
        for kind in VIEWS:
            config, view = small_view(kind)
            features = torch.randn(6, config.width, *config.feature_grid, requires_grad=True)
            table = table_of({7: (0, 1.25, 2.5), 8: (1, 1.25, 2.5)}, config.feature_grid)
            exact = view(features, *table)
            with torch.autocast("cpu", dtype=torch.bfloat16):
                bev = view(features.bfloat16(), *table).float()
            torch.testing.assert_close(bev, exact, rtol=0.1, atol=0.1)
            bev.square().mean().backward()
            self.assertTrue(gradient_of(features).isfinite().all())

    def test_invalid_configurations_are_refused(self):
        wrong: tuple[dict[str, Any], ...] = (
            {"trunk": "vgg"},
            {"view": "flat"},
            {"channels": 5},
            {"bev_size": (50, 100)},
            {"width": 50},
            {"kernel_size": 2},
            {"image_size": (100, 320)},
            {"token_grid": (21, 49)},
            {"trunk": "resnet50", "image_size": (96, 320)},
        )
        for fields in wrong:
            with self.assertRaisesRegex(ValueError, "network 'nano': "):
                replace(PRESETS["nano"], **fields)
        with self.assertRaisesRegex(ValueError, "5 cameras, wanted 6"):
            BevNetwork(replace(PRESETS["nano"], view="dense"), nominal_cameras((96, 320))[:5])


class KnownNetworks(unittest.TestCase):
    def assert_close(self, found: float, millions: float) -> None:
        self.assertAlmostEqual(found / (1e6 * millions), 1.0, delta=0.01)

    def test_resnet50(self):
        trunk = ResNet50()
        self.assert_close(parameters(trunk), 23.5)
        self.assert_close(parameters(trunk) + parameters(nn.Linear(2048, 1000)), 25.6)
        self.assertIn("layer2.0.downsample.1.running_var", trunk.state_dict())
        trunk.to("meta").eval()
        cost = measure(trunk, lambda: trunk(torch.empty(1, 3, 224, 224, device="meta")))
        self.assert_close(sum(cost.macs.values()), 4087.0)

    def test_efficientnet_b0(self):
        trunk = EfficientNetB0()
        last = nn.ModuleList([nn.Conv2d(320, 1280, 1, bias=False), nn.BatchNorm2d(1280)])
        self.assert_close(parameters(trunk) + parameters(last), 4.0)
        with_classifier = parameters(trunk) + parameters(last) + parameters(nn.Linear(1280, 1000))
        self.assert_close(with_classifier, 5.29)
        self.assertIn("features.2.0.block.2.fc1.bias", trunk.state_dict())
        trunk.to("meta").eval()
        cost = measure(trunk, lambda: trunk(torch.empty(1, 3, 224, 224, device="meta")))
        last_macs = 320 * 1280 * 7 * 7
        self.assert_close(sum(cost.macs.values()) + last_macs, 384.0)

    def test_bemapnet(self):
        for name, neck_millions in (("paper-resnet50", 1.43), ("paper-efficientnet", 0.59)):
            trunk = BevNetwork(PRESETS[name]).get_submodule("trunk.neck")
            self.assert_close(parameters(trunk), neck_millions)
        network = BevNetwork(PRESETS["paper-resnet50"])
        mix = network.get_submodule("trunk.mix")
        self.assert_close(parameters(network.view) + parameters(mix), 20.28)


class ViewTransforms(unittest.TestCase):
    @torch.no_grad()
    def test_cells_that_no_camera_sees_are_zero(self):
        for kind in VIEWS:
            config, view = small_view(kind)
            features = torch.randn(6, config.width, *config.feature_grid)
            index, weight = table_of({7: (0, 1.25, 2.5), 4999: (5, 2.0, 6.0)}, config.feature_grid)
            bev = view(features, index, weight).flatten(2)[0]
            self.assertEqual(bev.any(0).nonzero().flatten().tolist(), [7, 4999], kind)

    @torch.no_grad()
    def test_samples_of_a_batch_do_not_mix(self):
        for kind in VIEWS:
            config, view = small_view(kind)
            features = torch.randn(12, config.width, *config.feature_grid)
            tables = [table_of({3: (camera, 1.5, 2.5)}, config.feature_grid) for camera in (0, 4)]
            index, weight = (torch.cat(parts) for parts in zip(*tables))
            both = view(features, index, weight)
            for sample, table in enumerate(tables):
                alone = view(features[6 * sample : 6 * sample + 6], *table)
                torch.testing.assert_close(both[sample : sample + 1], alone, rtol=1e-4, atol=1e-5)

    @torch.no_grad()
    def test_missing_cameras_have_no_effect(self):
        for kind in VIEWS:
            config, view = small_view(kind)
            features = torch.randn(6, config.width, *config.feature_grid)
            table = table_of({7: (0, 1.25, 2.5), 8: (1, 1.25, 2.5)}, config.feature_grid)
            before = view(features, *table)
            features[2:] += 10.0
            torch.testing.assert_close(view(features, *table), before)
            features[1] += 10.0
            self.assertFalse(torch.allclose(view(features, *table), before), kind)


class KernelViews(unittest.TestCase):
    @torch.no_grad()
    def test_an_image_cell_affects_only_the_bev_cells_whose_keys_cover_it(self):
        config, view = small_view("kernel")
        rows, cols = config.feature_grid
        generator = torch.Generator().manual_seed(5)
        place = torch.rand(CELLS, 2, generator=generator) * torch.tensor([rows - 1, cols - 1])
        camera = torch.randint(6, (CELLS,), generator=generator)
        projections = {
            cell: (int(camera[cell]), float(place[cell, 0]), float(place[cell, 1]))
            for cell in range(0, CELLS, 10)
        }
        table = table_of(projections, config.feature_grid)
        features = torch.randn(6, config.width, rows, cols)
        before = view(features, *table)
        # A feature moves from one image cell to its neighbour.
        features[3, :, 2, 5] = features[3, :, 2, 4]
        features[3, :, 2, 4] = 0.0
        changed = (view(features, *table) != before).any(1).flatten().nonzero().flatten().tolist()
        covered = [
            cell
            for cell, (seen, row, col) in projections.items()
            if seen == 3 and abs(round(row) - 2) <= 1 and 3 <= round(col) <= 6
        ]
        self.assertGreater(len(covered), 5)
        self.assertEqual(changed, covered)

    def test_keys_lie_around_the_projection(self):
        index, weight = table_of({42: (2, 1.75, 0.0)}, (4, 8))
        kernel = kernel_of_table(index, weight, (4, 8), 3)
        valid = kernel.log_share[0, 42].isfinite()
        # Column -1 is outside the image, and there is no second camera.
        self.assertEqual(int(valid.sum()), 6)
        first = 2 * 32
        expected = [first + row * 8 + col for row in (1, 2, 3) for col in (0, 1)]
        self.assertEqual(kernel.key[0, 42][valid].tolist(), expected)
        offsets = [(row - 1.75, col) for row in (1, 2, 3) for col in (0, 1)]
        torch.testing.assert_close(kernel.offset[0, 42][valid], torch.tensor(offsets))
        self.assertFalse(kernel.log_share[0, 41].isfinite().any())

    @torch.no_grad()
    def test_a_camera_fades_in(self):
        config, view = small_view("kernel")
        features = torch.randn(6, config.width, *config.feature_grid)
        index, weight = table_of({9: (0, 1.5, 2.5)}, config.feature_grid)
        other, _ = table_of({9: (1, 0.5, 1.5)}, config.feature_grid)
        alone = view(features, index, weight)
        index[:, 4:] = other[:, :4]
        weight[:, 4:, 9] = 0.25e-6
        torch.testing.assert_close(view(features, index, weight), alone, rtol=1e-4, atol=1e-4)
        weight[:, :, 9] = 0.125
        self.assertFalse(torch.allclose(view(features, index, weight), alone, atol=1e-2))


class DenseViews(unittest.TestCase):
    @torch.no_grad()
    def test_image_cells_above_the_horizon_have_no_effect(self):
        config, view = small_view("dense")
        assert isinstance(view, DenseView)
        above = view.above_horizon.unflatten(0, (6, *config.feature_grid))
        self.assertTrue(above.any() and not above.all())
        features = torch.randn(6, config.width, *config.feature_grid)
        table = table_of({c: (c, 1.5, 2.5) for c in range(6)}, config.feature_grid)
        before = view(features, *table)
        features += 10.0 * above[:, None]
        torch.testing.assert_close(view(features, *table), before)

    def test_ground_positions_of_image_cells(self):
        # The camera looks forward from 1.5 m height; the horizon is between rows 3 and 4 of 8.
        pose = torch.tensor([[0.0, 0, 1, 2], [-1, 0, 0, 0.5], [0, -1, 0, 1.5], [0, 0, 0, 1]])
        camera = Camera(10.0, 10.0, 3.5, 3.5, pose)
        ground, sees = camera.ground_positions((8, 8), (8, 8))
        self.assertEqual(sees.any(1).tolist(), [False] * 4 + [True] * 4)
        # Row 6 is 2.5 pixels below the horizon: 1.5 * 10 / 2.5 = 6 m ahead. Column 0 is 3.5 pixels
        # left of the centre.
        torch.testing.assert_close(ground[6, 0], torch.tensor([2 + 6.0, 0.5 + 6.0 * 3.5 / 10]))
        self.assertEqual(ground[0, 0].tolist(), [0.0, 0.0])
        # The centres of cells of 2 x 2 pixels lie between pixels.
        coarse, _ = camera.ground_positions((8, 8), (4, 4))
        torch.testing.assert_close(coarse[3, 0, 0], torch.tensor(2 + 1.5 * 10 / 3.0))

    def test_the_nominal_rig_looks_all_around(self):
        for camera, azimuth_deg in zip(nominal_cameras((384, 896)), (55, 0, -56, 109, 180, -111)):
            ground, sees = camera.ground_positions((384, 896), (21, 49))
            bottom = ground[-1, 24] - camera.vehicle_from_camera[:2, 3]
            self.assertTrue(sees[-1].all())
            turn = math.degrees(math.atan2(bottom[1], bottom[0])) - azimuth_deg
            self.assertLess(abs((turn + 180) % 360 - 180), 2.5)

    def test_bev_cells(self):
        x, y = cell_centres(100, 50, (0.6, 0.6))
        self.assertAlmostEqual(float(x[0, 0]), 29.7, places=5)
        self.assertAlmostEqual(float(y[0, 0]), 14.7, places=5)
        self.assertAlmostEqual(float(x[-1, 0]), -29.7, places=5)
        self.assertEqual(float(y[3, 0]), -float(y[3, -1]))

    def test_positions_are_encoded_y_first(self):
        encoded = sine_encoding(torch.tensor([3.0]), torch.tensor([-2.0]), 8)[0]
        y, x = (
            [math.sin(v), math.sin(v / 100), math.cos(v), math.cos(v / 100)] for v in (-2.0, 3.0)
        )
        torch.testing.assert_close(encoded, torch.tensor(y + x))


class Convolutions(unittest.TestCase):
    def test_equal_the_products_for_24_channels(self):
        """oneDNN 3.7 fails this, so importing training.models must have turned it off."""
        image, weights = torch.rand(1, 24, 6, 8), torch.rand(16, 24, 3, 3)
        patches = nn.functional.unfold(image, 3)
        wanted = (weights.flatten(1) @ patches).reshape(1, 16, 4, 6)
        found = nn.functional.conv2d(image, weights)
        self.assertLess((found - wanted).abs().max().item(), 1e-4)

    def test_only_wrong_versions_are_turned_off(self):
        was_on = torch.backends.mkldnn.set_flags(True)[0]
        self.addCleanup(torch.backends.mkldnn.set_flags, was_on)
        for version, is_on in (("v2.6.3", True), ("v3.8.1", True), ("v3.7.2", False)):
            turn_off_if_wrong(f"  - Intel(R) MKL-DNN {version} (Git Hash N/A)")
            self.assertEqual(torch._C._get_mkldnn_enabled(), is_on, version)


class Costs(unittest.TestCase):
    def test_attention(self):
        attention = Attention(8, 2, 0.0).to("meta").eval()
        query, key = torch.empty(1, 5, 8, device="meta"), torch.empty(1, 7, 8, device="meta")
        cost = measure(attention, lambda: attention(query, key, key))
        projections = (5 + 7 + 7 + 5) * 8 * 8
        self.assertEqual(sum(cost.macs.values()), projections + 2 * 5 * 7 * 8)

    def test_freed_memory_does_not_count(self):
        chain = nn.Sequential(*(nn.Conv2d(4, 4, 1) for _ in range(5))).to("meta")
        image = torch.empty(1, 4, 16, 16, device="meta")
        self.assertEqual(measure(chain, lambda: chain(image)).peak_bytes, 2 * 4 * 4 * 16 * 16)

    def test_operations_in_place_take_no_memory(self):
        layer = nn.Sequential(nn.Conv2d(4, 4, 1), nn.ReLU(inplace=True)).to("meta")
        image = torch.empty(1, 4, 16, 16, device="meta")
        self.assertEqual(measure(layer, lambda: layer(image)).peak_bytes, 4 * 4 * 16 * 16)

    def test_parts_of_nano(self):
        cost = cost_of(PRESETS["nano"])
        million = {part: round(macs / 1e6, 1) for part, macs in cost.macs.items() if macs}
        self.assertEqual(
            million,
            {
                "trunk": 609.6,
                "view": 1.9,
                "bev_encoder": 207.4,
                "bev_compress": 103.7,
                "map_encoder": 126.7,
                "map_compress": 103.7,
                "head": 76.8,
            },
        )

    def test_the_document_has_the_counted_costs(self):
        document = model_table.DOCUMENT.read_text()
        for config in model_table.configurations():
            cells = model_table.counted_cells(config, cost_of(config))
            self.assertIn(f"| {' | '.join(cells)} |", document)


if __name__ == "__main__":
    unittest.main()
