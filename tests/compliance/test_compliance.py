"""Runs bevloc-compliance with options that it must refuse, and with devices that are not there."""

from __future__ import annotations

import os
import subprocess
import unittest


def run(*options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([os.environ["COMPLIANCE"], *options], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=60)


class ComplianceTest(unittest.TestCase):
    def test_fails_with_the_reason_if_a_named_device_cannot_be_tested(self) -> None:
        for options in (["--can", "no_such_bus", "--gtest_filter=Buses/*/SocketCan"],
                        ["--gpio", "no_such_chip", "--gtest_filter=Gpios/*/Libgpiod"]):
            with self.subTest(options=options):
                done = run(*options)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertRegex(done.stdout, rf"(?m)^{options[1]}.*: found ")
                self.assertNotIn("SKIPPED", done.stdout)

    def test_skips_a_device_that_nobody_named(self) -> None:
        done = run("--gtest_filter=Gpios/*/Libgpiod")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("SKIPPED", done.stdout)

    def test_refuses_options_that_it_does_not_know(self) -> None:
        for option in ("can0", "--cna=can0", "--gtest_fliter=Buses/*"):
            with self.subTest(option=option):
                done = run(option)
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertIn(f"bevloc-compliance: found {option}, wanted ", done.stdout)

    def test_refuses_a_control_without_a_number(self) -> None:
        for control in ("gain", "gain=", "gain=high", "gain=1x", "gain=nan", "=3"):
            with self.subTest(control=control):
                done = run("--control", control)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(f"--control: found {control}, wanted NAME=NUMBER", done.stdout)
