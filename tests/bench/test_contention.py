"""Tests the figures of tests/bench/contention; nothing is driven or timed."""

import unittest

from tests.bench.contention import Drive, exposures_of, p99_ratio, table_of


def drive(p99_ms: float = 40.0, p50_ms: float = 20.0, **frames: int) -> Drive:
    counts = dict.fromkeys(("used", "displaced", "mismatched", "skipped", "under_way", "missed"), 0)
    result = {
        "latency_ms": {"p50": p50_ms, "p99": p99_ms},
        "frames": {"captured": 600, **counts, **frames},
        "realtime_refusals": 3,
    }
    return Drive.of(result, 2048)


class ContentionTest(unittest.TestCase):
    def test_every_exposure_is_captured_or_missed(self):
        self.assertEqual(drive().unaccounted(600.0), 0)
        self.assertEqual(drive(missed=60).unaccounted(660.0), 0)
        self.assertEqual(drive(missed=60).unaccounted(700.0), 40)

    def test_captured_frames_without_outcome_are_counted(self):
        self.assertEqual(drive(under_way=12).unaccounted(600.0), 0)
        self.assertEqual(drive(under_way=18).unaccounted(600.0), 6)

    def test_the_ratio_is_infinite_without_poses(self):
        self.assertEqual(p99_ratio(drive(40.0), drive(60.0)), 1.5)
        self.assertEqual(p99_ratio(drive(40.0), drive(0.0)), float("inf"))

    def test_the_rate_comes_from_the_configuration(self):
        self.assertEqual(exposures_of("cameras:\n  rate_hz: 12.5  # of each\n", 5.0), 300.0)
        with self.assertRaises(SystemExit):
            exposures_of("cameras:\n  driver: replay\n", 4.0)

    def test_table_has_both_drives(self):
        table = table_of(drive(40.0, skipped=6), drive(60.0, skipped=18))
        self.assertRegex(table, r"ratio of p99 +1\.50\n")
        self.assertRegex(table, r"in skipped framesets +6 +18\n")
        self.assertRegex(table, r"simulator, MiB +2 +2$")


if __name__ == "__main__":
    unittest.main()
