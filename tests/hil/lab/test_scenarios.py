"""Tests that a scenario fails if its fault has not happened, on a guest that is played."""

import dataclasses
import pathlib
import re
import tempfile
import unittest
from collections.abc import Callable
from typing import cast
from unittest import mock

from tests.hil.lab import dbc, drives, scenarios
from tests.hil.lab.bench import Run
from tests.hil.lab.bus_frames import protected
from tests.hil.lab.cameras import BROKEN_CAMERA, NAMES
from tests.hil.lab.judge import BusLog, PoseError
from tests.hil.lab.outcome import Outcome

DBC = pathlib.Path(__file__).parents[3] / "can/bevloc.dbc"
STATUS = dbc.read(DBC)[0x500]
INIT, TRACKING, DEGRADED = 0, 2, 3
ALL_OK = {name: 1 for name in STATUS.signals if name.startswith("CameraOk_")}
NONE_OK = {**dict.fromkeys(ALL_OK, 0), "Why_CameraMissing": 1}
CYCLE_S = 0.1
GOOD = PoseError(0.1, 0.1, 0.1)

# The raw values of LOC_Status at a time of the guest; None: the daemon does not send.
Bus = Callable[[float], dict[str, int] | None]


class Cameras:
    """The broken camera sends `sent` frames in each second of the guest."""

    def __init__(self, run: "PlayedRun", sent: int) -> None:
        self._run = run
        self._sent = sent
        self.commands: dict[str, float] = {}

    def command(self, line: str) -> str:
        self.commands[line] = self._run.now_s
        return "ok"

    def sent_by(self, name: str) -> int:
        assert name == NAMES[BROKEN_CAMERA]
        return int(self._sent * self._run.now_s)


@dataclasses.dataclass
class PlayedRun:
    """A run whose guest does nothing but let the time pass."""

    folder: pathlib.Path
    bus: Bus
    sent: int = 2
    now_s: float = 100.0

    def __post_init__(self) -> None:
        self.agent = self
        self.cameras = Cameras(self, self.sent)

    def check(self, script: str) -> str:
        printed = f"{self.now_s}\n"
        self.now_s += sum(map(float, re.findall(r"sleep ([\d.]+)", script)))
        self.now_s += max(map(float, re.findall(r"timeout ([\d.]+)", script)), default=0.0)
        return printed

    run = check

    def wall_s(self) -> float:
        return self.now_s

    def start_daemon(self) -> float:
        self.now_s += 1.0
        return 1.0

    def start_vehicle(self) -> None:
        pass

    def show(self, name: str) -> str:
        return "4242"

    def wait_for(self, name: str, wanted: str, timeout_s: float) -> bool:
        self.now_s += 2.0
        return True

    def finish_log(self) -> BusLog:
        times = [100.0 + CYCLE_S * i for i in range(round((self.now_s - 100.0) / CYCLE_S))]
        sent = [(time, values) for time in times if (values := self.bus(time)) is not None]
        log = self.folder / "candump.log"
        lines = [f"({time:.3f}) vcan0 500#{protected(STATUS, **raw)}\n" for time, raw in sent]
        forged = f"({self.now_s:.3f}) vcan0 400#00\n"
        log.write_text("".join(lines) + forged, encoding="ascii")
        return BusLog(log, DBC)


class ScenarioTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        # The poses are judged in test_judge.py.
        for name, value in (("errors_of", [GOOD] * 3000), ("_frames_balance", (True, "")),
                            ("_resident_mib", 50.0), ("_vehicle_ended", True)):
            patch = mock.patch.object(drives, name, return_value=value)
            patch.start()
            self.addCleanup(patch.stop)

    def play(self, scenario: Callable[[Run], Outcome], bus: Bus, sent: int = 2) -> Outcome:
        return scenario(cast(Run, PlayedRun(self.folder, bus, sent)))

    def test_drive_wants_tracking(self) -> None:
        self.assertTrue(self.play(drives.drive, lambda _: {"State": TRACKING}).passed)
        self.assertFalse(self.play(drives.drive, lambda _: {"State": DEGRADED}).passed)

    def test_camera_garbage_wants_garbage_that_the_daemon_refuses(self) -> None:
        def noticed(time_s: float) -> dict[str, int]:
            broken = 114.0 < time_s < 120.0
            return {"State": DEGRADED if broken else TRACKING, "Why_CameraMissing": int(broken)}

        # TRACKING is there at 113 s, and the garbage comes from then until 121 s.
        outcome = self.play(drives.camera_garbage, noticed)
        self.assertTrue(outcome.passed)
        self.assertIn("16 sent", outcome.injected)
        self.assertFalse(self.play(drives.camera_garbage, lambda _: {"State": TRACKING}).passed)
        self.assertFalse(self.play(drives.camera_garbage, noticed, sent=0).passed)

    def test_no_cameras_at_start_wants_none_before_they_are_plugged_in(self) -> None:
        def bus(first_ok_s: float) -> Bus:
            return lambda time_s: (
                {"State": INIT, **NONE_OK}
                if time_s < first_ok_s
                else {"State": TRACKING, **ALL_OK}
            )

        # They are plugged in at 108 s. Each start reports missing cameras at first.
        self.assertTrue(self.play(drives.no_cameras_at_start, bus(108.5)).passed)
        outcome = self.play(drives.no_cameras_at_start, bus(101.25))
        self.assertFalse(outcome.passed)
        self.assertIn("but CameraOk_Back, ", outcome.seen)

    def test_can_down_wants_a_silent_bus(self) -> None:
        # The interface is down from 105 to 108 s.
        def silent(time_s: float) -> dict[str, int] | None:
            return None if 105.0 <= time_s < 108.05 else {}

        outcome = self.play(scenarios.can_down, silent)
        self.assertTrue(outcome.passed)
        self.assertAlmostEqual(outcome.recovery_s or 0.0, 0.1)
        outcome = self.play(scenarios.can_down, lambda _: {})
        self.assertFalse(outcome.passed)
        self.assertIn("MEANWHILE", outcome.seen)

    def test_can_flood_wants_a_daemon_that_continues(self) -> None:
        # The flood comes from 105 to 110 s.
        self.assertTrue(self.play(scenarios.can_flood, lambda _: {}).passed)
        interrupted = self.play(
            scenarios.can_flood, lambda time_s: None if 105.5 < time_s < 110.5 else {}
        )
        self.assertFalse(interrupted.passed)


if __name__ == "__main__":
    unittest.main()
