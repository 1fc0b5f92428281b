"""Tests the figure of a run's losses and errors."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path
from unittest.mock import patch

from training import curves
from training.run_table import CURVES, VALIDATION, append_row


class Figure(unittest.TestCase):
    def test_the_errors_of_a_run_are_those_on_validation_scenes(self) -> None:
        errors = {name: 0.5 for _, names in curves._VALIDATION_PANELS for name in names}
        losses = {name: 0.5 for _, names in curves._LOSS_PANELS for name in names}
        with tempfile.TemporaryDirectory() as folder:
            run, image = Path(folder), Path(folder) / "curves.png"
            for samples in range(8, 100, 8):
                append_row(run / CURVES, {"samples": samples, **losses})
                append_row(run / VALIDATION, {"samples": samples, **errors})
            with patch("training.curves.plt.close") as closed:
                curves.draw(run, image)
            self.assertTrue(image.is_file())
        (figure,) = closed.call_args.args
        titles = [axes.get_title() for axes in figure.axes]
        self.assertEqual(sum(title.startswith("Validation scenes: ") for title in titles), 2)
        self.assertFalse(any("Evaluation" in title for title in titles))
        curves.plt.close(figure)


if __name__ == "__main__":
    unittest.main()
