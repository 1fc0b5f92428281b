"""Runs the three consumers of can/consumer on the golden log, and compares the constants."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CONSUMER = ROOT / "can/consumer"


def output_of(*command: str) -> str:
    # It runs in the folder of the consumer, because ROOT/can would hide the package can.
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=CONSUMER)
    return done.stdout


def programs() -> list[list[str]]:
    reader = [sys.executable, str(CONSUMER / "bevloc_reader.py")]
    return [[os.environ["CONSUMER_C"]], [os.environ["CONSUMER_CPP"]], reader]


def time_us(line: str) -> int:
    return int(line[1:11]) * 1_000_000 + int(line[12:18])


def shifted(line: str, shift_us: int) -> str:
    now_us = time_us(line) + shift_us
    return f"({now_us // 1_000_000:010}.{now_us % 1_000_000:06}){line[19:]}"


class ConsumersTest(unittest.TestCase):
    maxDiff = None

    def setUp(self) -> None:
        self.log = str(CONSUMER / "golden.log")
        self.expected = (CONSUMER / "golden.txt").read_text()

    def test_c_reads_the_golden_log(self) -> None:
        self.assertEqual(output_of(os.environ["CONSUMER_C"], self.log), self.expected)

    def test_cpp_reads_the_golden_log(self) -> None:
        self.assertEqual(output_of(os.environ["CONSUMER_CPP"], self.log), self.expected)

    def test_python_reads_the_golden_log(self) -> None:
        reader = str(CONSUMER / "bevloc_reader.py")
        self.assertEqual(output_of(sys.executable, reader, self.log), self.expected)

    def answers_to(self, lines: list[str]) -> str:
        """What all three print for a log."""
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "can.log"
            log.write_text("".join(line + "\n" for line in lines))
            outputs = [output_of(*program, str(log)) for program in programs()]
        self.assertEqual(outputs[0], outputs[1])
        self.assertEqual(outputs[0], outputs[2])
        return outputs[0]

    def golden_lines(self, end_us: int = 10**9) -> list[str]:
        lines = Path(self.log).read_text().splitlines()
        return [line for line in lines if time_us(line) < end_us]

    def test_all_read_the_golden_log_of_can_fd(self) -> None:
        expected = (CONSUMER / "golden_fd.txt").read_text()
        self.assertIn("3 lost, 0 repeated, 1 wrong CRC, 1 wrong length", expected)
        for program in programs():
            with self.subTest(program=program):
                self.assertEqual(output_of(*program, str(CONSUMER / "golden_fd.log")), expected)

    def test_a_clock_that_is_set_back_is_a_timeout(self) -> None:
        lines = self.golden_lines(5_400_000)
        statuses = [line for line in lines if " 500#" in line]
        # After the step the log has only LOC_Status, so no pose is complete.
        late = [shifted(line, -300_000) for line in self.golden_lines() if " 500#" in line
                and line not in statuses]
        output = self.answers_to(lines + late)
        self.assertIn("timeout", output.splitlines()[-2])
        back = self.answers_to(lines + [shifted(lines[-1], -6 * 10**5)])
        self.assertEqual(back.splitlines()[-2], "-0.210 timeout")

    def test_the_first_pose_after_a_silence_is_not_usable_because_it_may_be_old(self) -> None:
        lines = self.golden_lines(5_340_000)
        # One whole epoch waited in the sender's controller for an hour.
        waited = [shifted(line, 3_600_000_000) for line in lines if time_us(line) == 5_320_000]
        before = [line for line in lines if time_us(line) < 5_320_000]
        output = self.answers_to(before + waited).splitlines()
        self.assertTrue(output[-2].endswith(" timeout"), output)
        self.assertNotIn("usable", self.answers_to(waited))
        new = [shifted(line, 3_600_000_000) for line in lines if time_us(line) == 5_330_000]
        output = self.answers_to(before + waited + new).splitlines()
        self.assertTrue(output[-2].startswith("3600.330 usable east "), output)

    def test_stamps_that_are_out_of_order_within_a_pose_do_not_matter(self) -> None:
        lines = self.golden_lines()
        jittered = [shifted(line, 700 - 300 * (i % 3)) for i, line in enumerate(lines)]
        self.assertEqual(self.answers_to(jittered).splitlines()[-1], self.expected.splitlines()[-1])

    def test_a_log_may_begin_at_zero(self) -> None:
        lines = [shifted(line, -5_000_000) for line in self.golden_lines()]
        self.assertEqual(self.answers_to(lines), self.expected)

    def test_other_lines_of_candump_are_passed_over(self) -> None:
        lines = [line + "_F" if i % 7 == 0 else line
                 for i, line in enumerate(self.golden_lines())]
        others = ["123#R", "123#R8", "123#0011_F", "12345678#0011", "20000004#0004000000000000",
                  "7FF#", "123##1" + 64 * "0a"]
        lines += ["", *(f"{lines[-1][:19]} can0 {frame}" for frame in others)]
        lines += [f"{lines[0][:18]}123) vcan0 123#00 R"]
        self.assertIn("frames: 840 ok, 52 lost", self.answers_to(lines))

    def test_aligned_names_and_counts_of_dropped_frames_make_no_difference(self) -> None:
        aligned = [line.replace(") can0 ", ")   can0 ") for line in self.golden_lines()]
        dropped = "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)"
        self.assertEqual(self.answers_to([aligned[0], dropped, *aligned[1:]]), self.expected)

    def test_only_the_first_interface_is_read(self) -> None:
        both = []
        for line in self.golden_lines():
            both += [line, line.replace(" can0 ", " can1 "), line.replace(" can0 ", " can2 ")]
        self.assertEqual(self.answers_to(both), self.expected)
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "can.log"
            log.write_text("\n".join(both))
            for program in programs():
                done = subprocess.run([*program, str(log)], check=True, capture_output=True,
                                      text=True, cwd=CONSUMER)
                self.assertEqual(done.stderr, f"{log}:2: found interface can1 after can0, wanted "
                                              "one; all but can0 are skipped\n")

    def test_what_is_no_log_is_refused(self) -> None:
        time = "(0000000005.000000) can0 "
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "can.log"
            for bad in ("garbage", time + "500#ABC", time + "500#00" + 8 * "00", time + "800#00",
                        time + "500#00x", time + "50#00", "(5.0) can0 500#00", "500#00",
                        "(5.000000)  500#00"):
                log.write_text(f"\n{time}123#00\n{bad}\n")
                for program in programs():
                    self.assert_refuses(program, str(log), f"{log}:3: found something else, wanted")
            log.write_bytes(bytes(range(256)))
            for program in programs():
                self.assert_refuses(program, str(log), f"{log}:1: found something else, wanted")
                for other in (folder, folder + "/none"):
                    self.assert_refuses(program, other, f"{other}: found no readable file, wanted")

    def assert_refuses(self, program: list[str], log: str, message: str) -> None:
        done = subprocess.run([*program, log], capture_output=True, text=True, cwd=CONSUMER)
        with self.subTest(program=program, log=log):
            self.assertEqual(done.returncode, 1)
            self.assertTrue(done.stderr.startswith(message), done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertNotIn("frames:", done.stdout)

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

    def test_one_kind_of_text_at_a_time(self) -> None:
        for options in (["--markdown", "--c-header"], ["--python", "--c-header"],
                        ["--markdown", "--python"]):
            done = subprocess.run([os.environ["BEVLOC_DBC"], *options], capture_output=True,
                                  text=True)
            self.assertNotEqual(done.returncode, 0, options)
            self.assertIn("excludes", done.stderr)

    def test_the_header_is_c99(self) -> None:
        source = f'#include "{CONSUMER}/bevloc.h"\nint main(void) {{ return 0; }}\n'
        subprocess.run(
            ["cc", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror",
             "-fsyntax-only", "-x", "c", "-"], input=source, text=True, check=True)

    def test_the_header_refuses_a_double_that_is_too_short(self) -> None:
        done = subprocess.run(
            ["cc", "-U__DBL_MANT_DIG__", "-D__DBL_MANT_DIG__=24", "-fsyntax-only", "-x", "c", "-"],
            input=f'#include "{CONSUMER}/bevloc.h"\n', capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("bevloc.h needs a double of 64 bits", done.stderr)

    def test_the_c_example_knows_the_age_of_a_frame_that_it_reads_late(self) -> None:
        source = """
            #define main example_main
            #include "example.c"
            #undef main
            int main(void) {
              int ends[2];
              const int on = 1;
              const struct timespec late = {0, 50000000};
              struct canfd_frame frame = {0};
              uint64_t age_us;
              if (socketpair(AF_UNIX, SOCK_DGRAM, 0, ends) != 0 ||
                  setsockopt(ends[0], SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0 ||
                  write(ends[1], &frame, sizeof frame) < 0) {
                return 2;
              }
              nanosleep(&late, NULL);
              if (!receive(ends[0], &frame, &age_us)) return 3;
              printf("%llu\\n", (unsigned long long)age_us);
              return 0;
            }
        """
        with tempfile.TemporaryDirectory() as folder:
            program = str(Path(folder) / "late")
            subprocess.run(["cc", "-std=c99", f"-I{CONSUMER}", "-o", program, "-x", "c", "-"],
                           input=source, text=True, check=True)
            self.assertGreaterEqual(int(output_of(program)), 50_000)

    def test_the_receivers_need_no_other_folder(self) -> None:
        # The package bevloc-dev installs only this folder.
        with tempfile.TemporaryDirectory() as folder:
            for source in CONSUMER.iterdir():
                if source.suffix in (".h", ".hpp", ".c", ".cpp", ".py"):
                    shutil.copy(source, folder)
            for command in (["cc", "-fsyntax-only", "example.c"],
                            ["c++", "-std=c++20", "-fsyntax-only", "example.cpp"],
                            [sys.executable, "bevloc_reader.py", self.log]):
                with self.subTest(command=command):
                    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
