"""Tests the table of the peers and the tables of docs/performance.md."""

import tempfile
import unittest
from pathlib import Path

from tests.bench.document import DOCUMENT, write_table
from tests.bench.peers.compare import Comparison, table_of
from tests.bench.write_performance import SWEEPS, columns_of, sweep_table
from tooling.errors import MarksError


class ComparisonTest(unittest.TestCase):
    def test_the_ratio_is_the_ratio_of_the_medians(self):
        comparison = Comparison("network")
        for ours_ms, theirs_ms in ((2.0, 9.0), (3.0, 6.0), (100.0, 5.0)):
            comparison.add(1, ours_ms, theirs_ms)
        self.assertEqual(comparison.ratio(1), 2.0)

    def test_table_has_three_columns_for_each_number_of_threads(self):
        comparison = Comparison("network, a peer")
        for threads in (1, 2):
            comparison.add(threads, 4.0 / threads, 6.0)
        lines = table_of([comparison], [1, 2]).splitlines()
        self.assertEqual(len(lines), 3)
        self.assertIn("bevloc, ms, 2 threads", lines[0])
        self.assertEqual(
            lines[2], "| network, a peer | 4.00 | 6.00 | 1.50 | 2.00 | 6.00 | 3.00 |"
        )


class DocumentTest(unittest.TestCase):
    def test_the_page_has_every_table(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "performance.md"
            page.write_text(DOCUMENT.read_text())
            for name in ("stages", "peers", *SWEEPS):
                write_table(name, f"numbers of {name}\n", page)
                self.assertIn(
                    f"<!-- {name}: begin -->\nnumbers of {name}\n<!-- {name}: end -->",
                    page.read_text(),
                )

    def test_a_table_without_marks_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "performance.md"
            page.write_text("nothing")
            with self.assertRaisesRegex(MarksError, "weather: begin"):
                write_table("weather", "", page)
            self.assertEqual(page.read_text(), "nothing")


class SweepTest(unittest.TestCase):
    def test_varied_columns_come_first(self):
        rows = [{"crop_ms": 0.01234567, "elements": 1200.0, "map_mib": 3.0, "road_km": 10.0}]
        columns = columns_of(rows)
        self.assertEqual(columns, ["elements", "road_km", "crop_ms", "map_mib"])
        self.assertEqual(
            sweep_table(rows, columns).splitlines()[2], "| 1200 | 10 | 0.01235 | 3 |"
        )


if __name__ == "__main__":
    unittest.main()
