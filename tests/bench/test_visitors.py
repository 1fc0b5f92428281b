"""Tests the figures of tests/bench/visitors and its clients; nothing is driven or timed."""

import socket
import subprocess
import sys
import unittest

from tests.bench import clients
from tests.bench.test_contention import drive
from tests.bench.visitors import CASES, PosePath, Run, ratios, table_of


def run(busy_ms: float, **frames: int) -> Run:
    return Run(drive(p50_ms=30.0, **frames), busy_ms, 1.5)


class VisitorsTest(unittest.TestCase):
    def test_each_round_has_its_own_reference(self):
        self.assertEqual(ratios([run(22.0), run(30.0)], [run(20.0), run(40.0)]), [1.1, 0.75])

    def test_the_table_has_medians_and_sums(self):
        busy = [run(busy_ms, skipped=6, missed=2) for busy_ms in (20.0, 21.0, 24.0)]
        table = table_of({"no page": [run(20.0)] * 3, "hostile clients": busy})
        self.assertIn("| no page | 20.00 | 1.000 (1.000 to 1.000) | 1.50 | 30.0 |", table)
        self.assertIn("| 21.00 | 1.050 (1.000 to 1.200) | 1.50 | 30.0 | 40.0 | 3 | 6 |", table)

    def test_the_times_are_those_of_the_pose_path(self):
        code = "open('/proc/self/comm', 'w').write('vision'); sum(range(10**6)); print(); input()"
        pipe = subprocess.PIPE
        with subprocess.Popen([sys.executable, "-c", code], stdin=pipe, stdout=pipe) as process:
            assert process.stdout
            process.stdout.readline()
            pose_path = PosePath()
            pose_path.read(process.pid)
            process.communicate(b"\n")
        self.assertGreater(pose_path.run_of(drive(used=6)).busy_ms, 1.0)

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
