"""Tests the metrics of the evaluation, the tables made from them and the curves of a run."""

import json
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import torch

from tests.training.synthetic import SyntheticStream
from training.curves import draw
from training.data import Batch
from training.evaluate import NATIVE_SOLVERS, Solver, evaluate
from training.losses import sample_1d
from training.report import BEGIN, END, Results, write_results
from training.solver import Posterior, Solution


def fixed_solver(estimate: list[float], deviation: float) -> Solver:
    """A solver that always returns the same estimate."""

    def solve(bev: torch.Tensor, features_map: torch.Tensor) -> Solution:
        flat = [torch.full((len(bev), count), 1 / count) for count in (21, 11, 21)]
        guess = torch.tensor(estimate).repeat(len(bev), 1)
        return Solution(guess, torch.full_like(guess, deviation), Posterior(*flat))

    return solve


def metrics_of(solvers: dict[str, Solver], batches: list[Batch]) -> dict[str, float]:
    """The metrics with a perfect mask and empty features."""

    def infer(batch: Batch) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        bev = torch.zeros(len(batch), 1)
        return bev, bev, batch.raster_truth.float() - 0.5

    return evaluate(infer, solvers, batches, torch.device("cpu"))


class Metrics(unittest.TestCase):
    def setUp(self):
        self.batch = SyntheticStream(0).next(4)
        self.batch.correction = torch.tensor(
            [[1.0, 0.1, 0.0], [1.0, 0.2, 0.0], [1.0, 0.3, 0.0], [-1.0, 0.4, 0.0]]
        )

    def test_errors_are_the_estimate_minus_the_truth(self):
        metrics = metrics_of({"zero": fixed_solver([0.5, 0.0, 0.0], 0.6)}, [self.batch])
        self.assertAlmostEqual(metrics["zero_x_bias"], 0.0, places=6)
        self.assertAlmostEqual(metrics["zero_x_mae"], 0.75, places=6)
        self.assertAlmostEqual(metrics["zero_y_bias"], -0.25, places=6)
        self.assertAlmostEqual(metrics["zero_x_within_1_sigma"], 0.75, places=6)
        self.assertAlmostEqual(metrics["zero_x_within_3_sigma"], 1.0, places=6)
        self.assertAlmostEqual(metrics["prior_x_mae"], 1.0, places=6)
        self.assertAlmostEqual(metrics["iou_divider"], 1.0, places=6)

    def test_a_distribution_is_read_between_its_hypotheses(self):
        probability = torch.tensor([[0.2, 0.6, 0.2]])
        read = sample_1d(probability, torch.tensor([0.1]), 0.2, 0.2)
        self.assertAlmostEqual(read.item(), 0.4, places=6)


class Written(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.models = Path(self.folder.name)
        batch = SyntheticStream(0).next(2)
        solver = fixed_solver([0.0, 0.0, 0.0], 1.0)
        names = ("joint", *NATIVE_SOLVERS)
        metrics = metrics_of({name: solver for name in names}, [batch])
        self.results = Results(12_000, 2, metrics, metrics)

    def tearDown(self):
        self.folder.cleanup()

    def test_the_tables_replace_the_text_between_the_marks(self):
        card = self.models / "README.md"
        card.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
        write_results(self.models, "nano", self.results)
        first = card.read_text()
        self.assertTrue(first.startswith("before\n") and first.endswith(f"{END}\nafter\n"))
        self.assertNotIn("old", first)
        self.assertIn("| Lateral (m) |", first)
        self.assertIn("last run: 12,000", first)
        write_results(self.models, "nano", self.results)
        self.assertEqual(card.read_text(), first)
        saved = json.loads((self.models / "nano_results.json").read_text())
        self.assertEqual(saved["int8"]["block_x_mae"], self.results.int8["block_x_mae"])

    def test_the_card_of_a_blend_states_no_training_samples(self):
        write_results(self.models, "blend", replace(self.results, trained_samples=0))
        card = (self.models / "blend.md").read_text()
        self.assertIn("Evaluation scenes: ", card)
        self.assertNotIn("Training samples", card)

    def test_a_card_without_marks_is_refused(self):
        (self.models / "README.md").write_text("no marks\n")
        with self.assertRaisesRegex(ValueError, "wanted the marks"):
            write_results(self.models, "nano", self.results)

    def test_another_network_gets_a_card_of_its_own(self):
        write_results(self.models, "small-lut", self.results)
        card = (self.models / "small-lut.md").read_text()
        self.assertTrue(card.startswith("# Model card: small-lut\n"))
        self.assertIn("| Lateral (m) |", card)
        self.assertEqual(
            {path.name for path in self.models.iterdir()},
            {"small-lut.md", "small-lut_results.json"},
        )

    def test_curves_become_an_image(self):
        names = "perceived,reconstructed,joint_x,joint_y,joint_yaw,dec_x,dec_y,dec_yaw"
        rows = [f"{25 * i},{200 * i},0.001," + ",".join(["1.5"] * 8) for i in range(1, 20)]
        curves = [f"step,samples,lr,{names}", *rows]
        (self.models / "curves.csv").write_text("\n".join(curves) + "\n")
        image = self.models / "curves.png"
        draw(self.models, image)
        self.assertEqual(image.read_bytes()[1:4], b"PNG")


if __name__ == "__main__":
    unittest.main()
