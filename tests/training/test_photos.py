"""Tests the preparation of photographs (training/photos.py)."""

from __future__ import annotations

import unittest
from pathlib import Path

import numpy as np
from PIL import Image

from training.photos import LIST, read_list, square, without_seam


class List(unittest.TestCase):
    def test_the_own_list_is_understood(self) -> None:
        photos = read_list(LIST.read_text(), Path("/torcs"))
        self.assertGreater(len(photos), 50)
        for photo in photos:
            self.assertIn(photo.side_px, (64, 128, 256), photo.path)

    def test_a_line_with_missing_words_is_named(self) -> None:
        with self.assertRaisesRegex(ValueError, "line 2: found 2 words"):
            read_list("# comment\nasphalt 6.4\n", Path())

    def test_numbers_after_the_file_are_its_part(self) -> None:
        [photo] = read_list("crown 1 a.png 0.1 0.2 0.3 0.4", Path("/b"))
        self.assertEqual(photo.path, Path("/b/a.png"))
        self.assertEqual(photo.part, (0.1, 0.2, 0.3, 0.4))


class Square(unittest.TestCase):
    def test_the_end_continues_in_the_start(self) -> None:
        ramp = np.linspace(0.0, 255.0, 160).reshape(-1, 1)
        joined = without_seam(ramp, 0)
        self.assertEqual(len(joined), 140)
        largest_step = np.abs(np.diff(np.concatenate([joined, joined[:1]]), axis=0)).max()
        self.assertLess(largest_step, 15.0)

    def test_transparent_parts_of_a_crown_are_black_and_nothing_else_is(self) -> None:
        pixels = np.zeros((40, 40, 4), np.uint8)
        pixels[20:, :, 3] = 255  # the upper half is transparent, the lower half black
        [photo] = read_list("crown 1 a.png", Path())
        result = np.asarray(square(photo, Image.fromarray(pixels)))
        self.assertEqual(result.shape, (256, 256, 3))
        self.assertEqual(result[:100].max(), 0)
        self.assertGreater(result[-100:].min(), 0)


if __name__ == "__main__":
    unittest.main()
