"""Tests the statistics of pictures (training/picture_statistics.py)."""

from __future__ import annotations

import unittest

import numpy as np
from PIL import Image

from training.picture_statistics import network_crop, statistics_of


def noise(sigma: float) -> np.ndarray:
    grey = np.random.default_rng(1).normal(120.0, sigma, (2, 96, 320, 1))
    return np.repeat(np.clip(grey, 0, 255), 3, axis=3).astype(np.uint8)


class Statistics(unittest.TestCase):
    def test_a_plain_picture_has_no_contrast_and_no_gradient(self) -> None:
        plain = statistics_of(np.full((1, 96, 320, 3), (200, 100, 50), np.uint8) + noise(1.0)[:1])
        self.assertLess(plain.contrast, 3.0)
        self.assertLess(plain.road_range, 6.0)

    def test_noise_is_white_and_grows_with_its_sigma(self) -> None:
        weak, strong = statistics_of(noise(5.0)), statistics_of(noise(20.0))
        self.assertAlmostEqual(strong.contrast, 20.0, delta=1.0)
        self.assertAlmostEqual(strong.laplacian / weak.laplacian, 4.0, delta=0.3)
        self.assertAlmostEqual(strong.spectrum, 0.0, delta=0.1)
        self.assertEqual(strong.saturation, 0.0)

    def test_the_principal_row_comes_to_the_horizon(self) -> None:
        pixels = np.zeros((900, 1600, 3), np.uint8)
        pixels[:450] = 255  # bright above the principal row
        crop = network_crop(Image.fromarray(pixels), 450.0)
        self.assertEqual(crop.shape, (96, 320, 3))
        self.assertEqual(crop[12].min(), 255)
        self.assertEqual(crop[16].max(), 0)


if __name__ == "__main__":
    unittest.main()
