"""Tests of the lab's judge, on frames given byte by byte."""

import math
import pathlib
import tempfile
import unittest

from tests.hil.lab import dbc
from tests.hil.lab.bus_frames import protected
from tests.hil.lab.drives import judge_poses
from tests.hil.lab.judge import BusLog, Pose, PoseError, Truth, quantile
from tests.hil.lab.outcome import Outcome, table

DBC = pathlib.Path(__file__).parents[3] / "can/bevloc.dbc"
# The example frame of docs/can.md: intact, all signals not available.
NOT_AVAILABLE = "D700000080000080"


class DbcTest(unittest.TestCase):
    def setUp(self) -> None:
        self.messages = dbc.read(DBC)

    def test_knows_every_message(self) -> None:
        text = DBC.read_text(encoding="utf-8")
        self.assertEqual(len(self.messages), text.count("\nBO_ "))
        self.assertEqual(self.messages[0x504].name, "LOC_PosLocal")
        self.assertEqual(self.messages[0x400].name, "VEH_WheelSpeed")
        self.assertEqual((self.messages[0x500].cycle_ms, self.messages[0x504].cycle_ms), (100, 10))

    def test_checks_the_published_frame(self) -> None:
        message, data = self.messages[0x504], bytes.fromhex(NOT_AVAILABLE)
        self.assertTrue(message.is_intact(data))
        for bit in range(8 * len(data)):
            damaged = bytearray(data)
            damaged[bit // 8] ^= 1 << bit % 8
            self.assertFalse(message.is_intact(bytes(damaged)), bit)
        self.assertFalse(message.is_intact(data[:-1]))

    def test_decodes_not_available_as_none(self) -> None:
        values = self.messages[0x504].decode(bytes.fromhex(NOT_AVAILABLE))
        self.assertIsNone(values["LocalEast"])
        self.assertIsNone(values["LocalNorth"])


class BusLogTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.log = pathlib.Path(folder.name) / "candump.log"
        self.messages = dbc.read(DBC)

    def read(self, *lines: str) -> BusLog:
        self.log.write_text("".join(f"{line}\n" for line in lines))
        return BusLog(self.log, DBC)

    def status(self, state: int, **more: int) -> str:
        return "500#" + protected(self.messages[0x500], State=state, **more)

    def position(self, epoch: int, east: int) -> str:
        values = {"EPOCH": epoch, "LocalEast": east, "LocalNorth": 0}
        return "504#" + protected(self.messages[0x504], **values)

    def heading(self, epoch: int, raw: int) -> str:
        return "505#" + protected(self.messages[0x505], EPOCH=epoch, Heading=raw)

    def test_counts_damaged_frames_and_ignores_foreign_ones(self) -> None:
        log = self.read("(1.0) vcan0 504#D700000080000081", "(1.1) vcan0 7A0#00", "nonsense")
        self.assertEqual((log.damaged, log.frames), (1, []))

    def test_lists_states_in_order(self) -> None:
        lines = [f"({i}.5) vcan0 {self.status(state)}" for i, state in enumerate([0, 0, 2, 3, 2])]
        log = self.read(*lines)
        self.assertEqual(log.states(), ["INIT", "TRACKING", "DEGRADED", "TRACKING"])
        self.assertEqual(log.first_status(0.0, State="DEGRADED"), 3.5)
        self.assertEqual(log.localizer_after(3.5), 4.5)
        self.assertIsNone(log.first_status(3.6, State="DEGRADED"))

    def test_measures_silence_and_lists_reasons(self) -> None:
        times = [1.0, 1.5, 4.0, 4.25, 9.0]
        whys: list[dict[str, int]] = [{}, {"Why_CameraMissing": 1}, {}, {"Why_PoseStale": 1}, {}]
        log = self.read(*(f"({t}) vcan0 {self.status(2, **w)}" for t, w in zip(times, whys)))
        self.assertEqual(log.longest_silence_s(1.2, 9.5), 4.75)
        self.assertEqual(log.reasons(1.2, 4.5), ["Why_CameraMissing", "Why_PoseStale"])
        self.assertEqual(log.reasons(4.5, 9.5), [])

    def test_counts_silence_until_the_end_of_the_log(self) -> None:
        log = self.read(*(f"({t}) vcan0 {self.status(2)}" for t in (0.0, 1.0, 2.0)))
        self.assertEqual(log.longest_silence_s(1.0, 6.0), 4.0)
        self.assertEqual(log.longest_silence_s(1.0, 2.25), 1.0)

    def test_finds_no_end_of_a_silence_whose_begin_is_unknown(self) -> None:
        log = self.read(f"(1.0) vcan0 {self.status(2)}")
        self.assertEqual(log.longest_silence_s(0.0, 2.0), math.inf)
        self.assertEqual(self.read().longest_silence_s(0.0, 2.0), math.inf)

    def test_uses_only_poses_of_one_epoch_in_a_valid_state(self) -> None:
        pose = [f"(2.0) vcan0 {self.position(5, 1000)}", f"(2.0) vcan0 {self.heading(5, 9000)}"]
        self.assertEqual(self.read(f"(1.0) vcan0 {self.status(4)}", *pose).valid_poses(), [])
        mixed = [pose[0], f"(2.0) vcan0 {self.heading(6, 9000)}"]
        self.assertEqual(self.read(f"(1.0) vcan0 {self.status(2)}", *mixed).valid_poses(), [])
        (found,) = self.read(f"(1.0) vcan0 {self.status(2)}", *pose).valid_poses()
        scale = self.messages[0x504].signals["LocalEast"].scale
        self.assertAlmostEqual(found.east_m, 1000 * scale)
        self.assertAlmostEqual(found.yaw_rad, 0.0)


class TruthTest(unittest.TestCase):
    def setUp(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "truth.csv"
            # North at 10 m/s, with a yaw that wraps at pi.
            rows = ["time_s,east_m,north_m,yaw_rad,speed_mps", "0,0,0,3.1,10", "1,0,10,-3.1,10"]
            file.write_text("\n".join(rows) + "\n")
            self.truth = Truth(file)

    def test_interpolates_between_rows(self) -> None:
        error = self.truth.error_of(Pose(100.5, -0.5, 5.0, math.pi), 100.0)
        assert error is not None
        self.assertAlmostEqual(error.longitudinal_m, 0.5)
        self.assertAlmostEqual(error.lateral_m, 0.0)
        self.assertAlmostEqual(error.yaw_deg, 0.0)

    def test_gives_no_error_outside_the_drive(self) -> None:
        self.assertIsNone(self.truth.error_of(Pose(99.9, 0.0, 0.0, 0.0), 100.0))
        self.assertIsNone(self.truth.error_of(Pose(101.1, 0.0, 0.0, 0.0), 100.0))


class PosesTest(unittest.TestCase):
    GOOD = PoseError(0.1, 0.1, 0.1)

    def test_wants_valid_poses_most_of_the_time(self) -> None:
        # 100 Hz for 20 s, of which nine tenths must be valid.
        self.assertTrue(judge_poses([self.GOOD] * 1800, 20.0)[0])
        passed, text = judge_poses([self.GOOD] * 1799, 20.0)
        self.assertFalse(passed)
        self.assertIn("1799 valid poses (wanted 1800)", text)
        self.assertFalse(judge_poses([], 20.0)[0])

    def test_wants_small_errors_and_none_beyond_the_alert_limit(self) -> None:
        one_wrong = [self.GOOD] * 1800 + [PoseError(0.1, 0.6, 0.1)]
        self.assertFalse(judge_poses(one_wrong, 20.0)[0])
        self.assertFalse(judge_poses([PoseError(0.1, 0.3, 0.1)] * 1800, 20.0)[0])


class ReportTest(unittest.TestCase):
    def test_quantiles_are_of_absolute_values(self) -> None:
        self.assertEqual(quantile([-3.0, 1.0, 2.0], 1.0), 3.0)
        self.assertEqual(quantile([-3.0, 1.0, 2.0], 0.0), 1.0)

    def test_table_names_failures(self) -> None:
        text = table({"kill": Outcome("SIGKILL", "nothing", None, False)})
        self.assertIn("| kill | SIGKILL | nothing | - | FAIL |", text)


if __name__ == "__main__":
    unittest.main()
