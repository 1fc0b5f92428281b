"""Tests the figures of tests/bench/visitors and its clients; nothing is driven or timed."""

import socket
import unittest

from tests.bench import clients
from tests.bench.test_contention import drive
from tests.bench.visitors import CASES, ratios, table_of


class VisitorsTest(unittest.TestCase):
    def test_each_round_has_its_own_reference(self):
        drives = [drive(p50_ms=22.0), drive(p50_ms=30.0)]
        references = [drive(p50_ms=20.0), drive(p50_ms=40.0)]
        self.assertEqual(ratios(drives, references), [1.1, 0.75])

    def test_the_table_has_medians_and_sums(self):
        quiet = [drive(p50_ms=20.0), drive(p50_ms=20.0), drive(p50_ms=20.0)]
        busy = [drive(p50_ms=p50_ms, skipped=6, missed=2) for p50_ms in (20.0, 21.0, 24.0)]
        table = table_of({"no page": quiet, "hostile clients": busy})
        self.assertIn("| no page | 20.0 | 40.0 | 1.000 (1.000 to 1.000) | 0 | 0 |", table)
        self.assertIn("| hostile clients | 21.0 | 40.0 | 1.050 (1.000 to 1.200) | 3 | 6 |", table)

    def test_the_first_case_is_the_reference(self):
        self.assertFalse(CASES[0].served)
        self.assertIsNone(CASES[0].client)

    def test_a_viewer_asks_again_when_it_is_refused(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            server.settimeout(60)
            with clients.running(clients.view, server.getsockname()[1]):
                for _ in range(2):
                    connection, _ = server.accept()
                    with connection:
                        self.assertTrue(connection.recv(64).startswith(b"GET /events HTTP/1.1"))


if __name__ == "__main__":
    unittest.main()
