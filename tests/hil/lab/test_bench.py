"""Tests what a scenario reads of its daemon, and how it ends if the guest has ended."""

import pathlib
import re
import socket
import tempfile
import unittest
from unittest import mock

from tests.hil.lab.agent import Agent, LabError
from tests.hil.lab.bench import Run, last_match
from tests.hil.lab.cameras import Cameras


class EndedGuest(unittest.TestCase):
    """The other end of its connections is closed."""

    def setUp(self) -> None:
        self.end, self.other_end = socket.socketpair()
        self.addCleanup(self.end.close)
        self.addCleanup(self.other_end.close)

    def test_is_a_failure_of_the_lab(self) -> None:
        self.other_end.sendall(b"agent ready\n")
        with mock.patch("tests.hil.lab.agent.connect_unix", return_value=self.end):
            agent = Agent("agent", 1.0)
        self.other_end.close()
        for _ in range(2):
            with self.assertRaisesRegex(LabError, "guest: .*; see console.log and qemu.log"):
                agent.run("true")

    def test_so_are_ended_cameras(self) -> None:
        with (
            mock.patch("tests.hil.lab.cameras.connect_unix", return_value=self.end),
            mock.patch("subprocess.Popen"),
        ):
            cameras = Cameras(pathlib.Path("program"), pathlib.Path("pictures"), pathlib.Path())
        self.other_end.shutdown(socket.SHUT_WR)
        with self.assertRaisesRegex(LabError, "cameras: ended, wanted an answer to 'counts'"):
            cameras.counts()
        self.other_end.close()
        with self.assertRaisesRegex(LabError, "cameras: .*, wanted an answer to 'counts'"):
            cameras.counts()


class RunTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bench = mock.MagicMock()
        self.bench.folders.results = pathlib.Path(folder.name)
        self.bench.agent.check.return_value = "1000.75"
        self.bench.cameras.counts.return_value = {"cameras": {}}
        self.bench.cameras.command.return_value = "{}"

    def test_reads_nothing_that_was_logged_before_it(self) -> None:
        with Run(self.bench, "drive") as run:
            run.journal()
        self.bench.agent.check.assert_called_with(
            "journalctl -u bevlocd.service -o cat --since @1000.750000"
        )

    def test_the_first_failure_says_why(self) -> None:
        self.bench.agent.run.side_effect = LabError("guest: Broken pipe")
        with self.assertRaisesRegex(LabError, "no restart"):
            with Run(self.bench, "kill"):
                raise LabError("no restart within 600 s")
        with self.assertRaisesRegex(LabError, "Broken pipe"):
            with Run(self.bench, "kill"):
                pass

    def test_a_vehicle_that_has_not_started_is_a_failure_of_the_lab(self) -> None:
        with self.assertRaisesRegex(LabError, "wanted drive_start"):
            Run(self.bench, "drive").drive_start()

    def test_the_last_daemon_of_a_journal_counts(self) -> None:
        pulses = re.compile(r"(\d+) pulses")
        found = last_match(pulses, "trigger: 7 pulses\ntrigger: 27 pulses\n")
        self.assertEqual(found and found[1], "27")
        self.assertIsNone(last_match(pulses, "INIT\n"))


if __name__ == "__main__":
    unittest.main()
