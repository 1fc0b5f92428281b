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
