"""Tests can/consumer/bevloc_reader.py without a bus."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any

CONSUMER = Path(__file__).resolve().parents[3] / "can/consumer"


class ReaderTest(unittest.TestCase):
    def setUp(self) -> None:
        sys.path.insert(0, str(CONSUMER))
        self.addCleanup(sys.path.remove, str(CONSUMER))
        self.reader = importlib.import_module("bevloc_reader")
        self.counter = 0

    def send(self, receiver: Any, name: str, content: int, time_s: float) -> None:
        """`content`: the frame as a number, without its first two bytes."""
        message = self.reader.MESSAGES[name]
        data = bytes([self.counter]) + content.to_bytes(message.length - 2, "little")
        crc = self.reader.crc8_h2f(data + bytes([message.data_id]))
        receiver.receive(receiver.base_id + message.id_offset, bytes([crc]) + data, time_s)

    def send_pose(self, receiver: Any, time_s: float, contents: dict[str, int]) -> None:
        for part in self.reader.PARTS:
            self.send(receiver, part, contents.get(part, 0), time_s)
        self.counter = (self.counter + 1) % 16

    def answer_to_levels(self, limits: dict[str, float], raw: dict[str, int]) -> str:
        """The answer to a pose that is 0 but for these raw values of LOC_Integrity."""
        receiver = self.reader.Receiver(self.reader.AlertLimits(risk_exponent=0, **limits))
        signals = self.reader.MESSAGES["LOC_Integrity"].signals
        content = sum(value << signals[name].start_bit - 16 for name, value in raw.items())
        self.send(receiver, "LOC_Status", 2, 1.0)
        for _ in range(2):
            self.send_pose(receiver, 1.0, {"LOC_Integrity": content})
        return str(receiver.answer(1.0))

    def test_knows_the_capture_time_in_utc(self) -> None:
        receiver = self.reader.Receiver()
        self.send_pose(receiver, 1.0, {"LOC_Time": 2**32 - 5})
        self.assertIsNone(receiver.capture_utc_us(1.0), "no LOC_Clock yet")
        self.send(receiver, "LOC_Clock", 7 + (123 << 32), 1.0)
        self.assertEqual(receiver.capture_utc_us(1.3), 2)
        self.assertAlmostEqual(receiver.utc_error_ms, 1.23)
        self.assertIsNone(receiver.capture_utc_us(1.301), "too old")
        self.assertEqual(receiver.capture_utc_us(0.9), 2)
        self.assertIsNone(receiver.capture_utc_us(0.899), "set back")
        self.send_pose(receiver, 1.1, {"LOC_Time": 0xFFFF << 32})
        self.assertIsNone(receiver.capture_utc_us(1.1), "no images")
        self.send_pose(receiver, 1.2, {"LOC_Time": 2**32 - 5})
        self.assertEqual(receiver.capture_utc_us(1.2), 2)
        self.send(receiver, "LOC_Clock", 7 + (0xFFFF << 32), 1.2)
        self.assertIsNone(receiver.capture_utc_us(1.2), "not synchronized")

    def test_an_axis_without_a_limit_needs_no_protection_level(self) -> None:
        sna = {"ProtectionLongitudinal": 0xFFF}
        limits = {"lateral_m": 0.5, "yaw_deg": 1.0}
        self.assertEqual(self.answer_to_levels(limits, sna), "usable")
        self.assertEqual(self.answer_to_levels({**limits, "longitudinal_m": 1.0}, sna),
                         "not_available")
        for axis, raw in {"lateral_m": {"ProtectionLateral": 0x7FF},
                          "yaw_deg": {"ProtectionYaw": 0x7FF}}.items():
            self.assertEqual(self.answer_to_levels({axis: 1.0}, raw), "not_available")
            self.assertEqual(self.answer_to_levels({}, raw), "usable")

    def test_a_foreign_sender_makes_the_pose_unusable(self) -> None:
        self.assertEqual(self.answer_to_levels({}, {"Why_ForeignSender": 1}), "foreign_sender")

    def test_tells_every_reason(self) -> None:
        all_reasons: set[str] = set()
        for name in ("LOC_Status", "LOC_Integrity"):
            signals = self.reader.MESSAGES[name].signals
            for signal in [signal for signal in signals if signal.startswith("Why_")]:
                receiver = self.reader.Receiver()
                content = 1 << signals[signal].start_bit - 16
                self.send(receiver, "LOC_Status", content if name == "LOC_Status" else 2, 1.0)
                self.send_pose(receiver, 1.0, {} if name == "LOC_Status" else {name: content})
                self.assertEqual(receiver.why(), {signal.removeprefix("Why_")})
                all_reasons |= receiver.why()
        self.assertLess({"GnssMissing", "ForeignSender"}, all_reasons)

    def test_an_unknown_time_source_is_free_running(self) -> None:
        receiver = self.reader.Receiver()
        start = self.reader.MESSAGES["LOC_Status"].signals["TimeSource"].start_bit - 16
        for source in (1, 5):
            self.send(receiver, "LOC_Status", 2 | source << start, 1.0)
            self.counter += 1
            self.assertEqual(receiver.time_source, {1: "PTP", 5: "FREE_RUNNING"}[source])

    def test_no_level_is_within_a_limit_that_is_negative_or_not_a_number(self) -> None:
        for axis in self.reader.LEVELS:
            for limit in (-1.0, float("nan")):
                with self.subTest(axis=axis, limit=limit):
                    self.assertEqual(self.answer_to_levels({axis: limit}, {}), "beyond_limit")


FAKE_PYTHON_CAN = """
import re
import sys
import time
import types

class CanError(Exception):
    pass

class Bus:
    def __init__(self, interface, channel, fd):
        self.channel = channel
        self.silence = 3
        self.log = open("golden.log") if channel.startswith("golden") else []
        if channel == "none":
            raise OSError(19, "No such device")
    def __enter__(self):
        return self
    def __exit__(self, *error):
        print("closed", file=sys.stderr)
    def recv(self, timeout):
        for line in self.log:
            identifier, data = re.search(" ([0-9A-F]{3})#([0-9A-F]*)", line).groups()
            age_s = 10.0 if self.channel == "golden_late" else 0.0
            return types.SimpleNamespace(
                arbitration_id=int(identifier, 16), data=bytes.fromhex(data),
                timestamp=time.time() - age_s, is_extended_id=False, is_remote_frame=False,
                is_error_frame=False)
        self.silence -= 1
        if self.channel == "down" and self.silence < 0:
            raise CanError("Network is down")
        if self.silence < 0:
            raise KeyboardInterrupt
        return None

interface = types.SimpleNamespace(Bus=Bus)
"""


class LiveTest(unittest.TestCase):
    """Runs the program on a bus that a fake python3-can simulates."""

    def read(self, channel: str, package: str = FAKE_PYTHON_CAN, output: int = subprocess.PIPE,
             interface: str = "socketcan") -> subprocess.CompletedProcess[str]:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "can.py").write_text(package)
            return subprocess.run(
                [sys.executable, str(CONSUMER / "bevloc_reader.py"), "--channel", channel,
                 "--interface", interface],
                stdout=output, stderr=subprocess.PIPE, text=True, cwd=CONSUMER,
                env={**os.environ, "PYTHONPATH": folder, "PYTHONDONTWRITEBYTECODE": "1"})

    def test_looks_at_the_answer_without_frames_and_ends_with_the_counters(self) -> None:
        done = self.read("vcan0")
        self.assertEqual((done.returncode, done.stderr), (0, "closed\n"))
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], "0.000 no_pose")
        self.assertTrue(lines[1].startswith("frames: 0 ok"), lines)

    def test_a_pose_that_is_read_late_is_not_usable(self) -> None:
        self.assertIn(" usable ", self.read("golden").stdout)
        late = self.read("golden_late").stdout
        self.assertIn(" timeout", late)
        self.assertNotIn(" usable ", late)
        # The stamps of other interfaces are not of this clock.
        self.assertIn(" usable ", self.read("golden_late", interface="other").stdout)

    def test_says_in_one_line_why_there_are_no_frames(self) -> None:
        done = self.read("none")
        self.assertEqual((done.returncode, done.stderr), (
            2, "none: found no frames ([Errno 19] No such device), wanted a bus that is up\n"))
        done = self.read("down")
        self.assertEqual((done.returncode, done.stderr), (
            2, "closed\ndown: found no frames (Network is down), wanted a bus that is up\n"))
        self.assertIn("frames: 0 ok", done.stdout)
        done = self.read("vcan0", "raise ImportError('none')")
        self.assertEqual((done.returncode, done.stderr), (
            2, "found no python3-can (none), wanted it for a live bus: install it\n"))

    def test_a_closed_pipe_is_one_line(self) -> None:
        reading, writing = os.pipe()
        os.close(reading)
        done = self.read("vcan0", output=writing)
        os.close(writing)
        self.assertEqual(done.returncode, 2)
        self.assertIn("standard output: found a closed pipe, wanted a reader\n", done.stderr)
        self.assertNotIn("Traceback", done.stderr)

    def test_the_c_example_says_why_there_are_no_frames(self) -> None:
        done = subprocess.run([os.environ["CONSUMER_C"], "--interface", "no_such_bus"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"\Ano_such_bus: found no frames \(.+\), wanted a CAN "
                                      r"interface that is up\n\Z")
