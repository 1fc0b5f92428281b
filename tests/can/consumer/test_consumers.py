"""Runs the three consumers of can/consumer on the golden log, and compares the constants."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CONSUMER = ROOT / "can/consumer"


def output_of(*command: str) -> str:
    # From the folder of the consumer, because ROOT/can would hide the package can of python3-can.
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=CONSUMER)
    return done.stdout


class ConsumersTest(unittest.TestCase):
    maxDiff = None

    def setUp(self) -> None:
        self.log = str(CONSUMER / "golden.log")
        self.expected = (CONSUMER / "golden.txt").read_text()

    def test_c_reads_the_golden_log(self) -> None:
        self.assertEqual(output_of(os.environ["CONSUMER_C"], self.log), self.expected)

    def test_cpp_reads_the_golden_log(self) -> None:
        self.assertEqual(output_of(os.environ["CONSUMER_CPP"], self.log), self.expected)

    @unittest.skipIf(importlib.util.find_spec("can.io") is None, "python3-can is not installed")
    def test_python_reads_the_golden_log(self) -> None:
        reader = str(CONSUMER / "bevloc_reader.py")
        self.assertEqual(output_of(sys.executable, reader, self.log), self.expected)

    def test_python_knows_the_capture_time_in_utc(self) -> None:
        sys.path.insert(0, str(CONSUMER))
        self.addCleanup(sys.path.remove, str(CONSUMER))
        reader = importlib.import_module("bevloc_reader")
        receiver = reader.Receiver()

        def receive(name: str, counter: int, content: bytes, time_s: float) -> None:
            message = reader.MESSAGES[name]
            data = bytes([counter]) + content.ljust(message.length - 2, b"\0")
            crc = reader.crc8_h2f(data + bytes([message.data_id]))
            receiver.receive(reader.LOCALIZER_BASE + message.id_offset, bytes([crc]) + data, time_s)

        for part in reader.PARTS:
            capture_us = (2**32 - 5).to_bytes(4, "little") if part == "LOC_Time" else b""
            receive(part, 0, capture_us, 1.0)
        self.assertIsNone(receiver.capture_utc_us(1.0), "no LOC_Clock yet")
        receive("LOC_Clock", 0, (7).to_bytes(4, "little") + (123).to_bytes(2, "little"), 1.0)
        self.assertEqual(receiver.capture_utc_us(1.3), 2)
        self.assertAlmostEqual(receiver.utc_error_ms, 1.23)
        self.assertIsNone(receiver.capture_utc_us(1.301), "too old")
        receive("LOC_Clock", 1, (7).to_bytes(4, "little") + b"\xff\xff", 1.2)
        self.assertIsNone(receiver.capture_utc_us(1.2), "not synchronized")

    def test_the_golden_log_has_every_fault(self) -> None:
        for word in ("timeout", "beyond_limit", "not_valid", " 1 wrong CRC", " 1 repeated"):
            self.assertIn(word, self.expected)

    def test_constants_are_those_of_the_message_table(self) -> None:
        writer = os.environ["BEVLOC_DBC"]
        files = {"--c-header": "bevloc_messages.h", "--python": "bevloc_messages.py"}
        for option, name in files.items():
            with self.subTest(name):
                self.assertEqual(output_of(writer, option), (CONSUMER / name).read_text(),
                                 f"write it again: bevloc_dbc {option} > can/consumer/{name}")

    def test_the_header_is_c99(self) -> None:
        source = f'#include "{CONSUMER}/bevloc.h"\nint main(void) {{ return 0; }}\n'
        subprocess.run(
            ["cc", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", f"-I{ROOT}",
             "-fsyntax-only", "-x", "c", "-"], input=source, text=True, check=True)


if __name__ == "__main__":
    unittest.main()
