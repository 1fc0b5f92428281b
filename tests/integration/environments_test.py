"""Drives with bevlocd under another locale and time zone, and long after the machine's start."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Sequence

ROOT = Path(__file__).resolve().parents[2]
BEVLOCD = os.environ["BEVLOCD"]
LOCALE = "de_DE.UTF-8"  # has a decimal comma, and points between thousands
TIME_ZONE = "Pacific/Chatham"  # 12:45 hours ahead of UTC
UPTIME_S = 400 * 86400  # a counter of 32 bits overflows after 50 days of milliseconds
# Runs a command that sees CLOCK_MONOTONIC and CLOCK_BOOTTIME as they are after this uptime.
LONG_AFTER_START = ["unshare", "--time", f"--monotonic={UPTIME_S}", f"--boottime={UPTIME_S}"]


def drive(
    folder: Path, options: list[str], variables: dict[str, str], prefix: Sequence[str] = ()
) -> None:
    """Leaves can.log, poses.csv and result.json in the folder."""
    command = [*prefix, BEVLOCD, "--config", "config/demo.yaml", "--seed", "7"]
    command += ["--out", str(folder), "--json", str(folder / "result.json"), *options]
    environment = {**os.environ, **variables}
    subprocess.run(command, check=True, cwd=ROOT, env=environment, capture_output=True)


def in_time_namespace() -> bool:
    command = [*LONG_AFTER_START, "cat", "/proc/uptime"]
    seen = subprocess.run(command, capture_output=True, text=True)
    return seen.returncode == 0 and float(seen.stdout.split()[0]) >= UPTIME_S


class EnvironmentsTest(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def make_locale(self) -> dict[str, str]:
        """The variables that choose LOCALE, which programs find in a folder of this test."""
        command = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(self.folder / LOCALE)]
        subprocess.run(command, check=True)
        variables = {"LOCPATH": str(self.folder), "LC_ALL": LOCALE}
        command = ["bash", "-c", "printf %.1f 1,5"]
        printed = subprocess.run(
            command, check=True, capture_output=True, text=True, env={**os.environ, **variables}
        )
        self.assertEqual(printed.stdout, "1,5")
        return variables

    @unittest.skipUnless(
        Path("/usr/share/i18n/locales/de_DE").exists(), "no locales here (script/packages.txt)"
    )
    def test_locale_and_time_zone_change_no_result(self) -> None:
        here, elsewhere = self.folder / "here", self.folder / "elsewhere"
        for folder in (here, elsewhere):
            folder.mkdir()
        options = ["--fast", "--duration", "8"]
        drive(here, options, {"LC_ALL": "C", "TZ": "UTC"})
        variables = {"TZ": TIME_ZONE, **self.make_locale()}
        start = datetime.now(timezone.utc).replace(microsecond=0)
        options += ["--record", str(self.folder / "recordings")]
        drive(elsewhere, options, variables)
        self.assertGreater(len((here / "poses.csv").read_text().splitlines()), 10)
        for name in ("can.log", "poses.csv", "result.json"):
            self.assertEqual((here / name).read_bytes(), (elsewhere / name).read_bytes(), name)
        self.check_name_of_recording(start)

    def check_name_of_recording(self, start: datetime) -> None:
        """The name has the time in UTC, in every time zone."""
        (recording,) = (self.folder / "recordings").glob("*.mcap")
        found = re.fullmatch(r"bevloc-(\d{8}T\d{6})Z-\d{4}\.mcap", recording.name)
        self.assertIsNotNone(found, recording.name)
        assert found
        named = datetime.strptime(found[1], "%Y%m%dT%H%M%S").replace(tzinfo=timezone.utc)
        self.assertLessEqual(start, named)
        self.assertLess(named - start, timedelta(hours=1))

    @unittest.skipUnless(
        shutil.which("unshare") and in_time_namespace(), "the kernel gives no time namespace here"
    )
    def test_drives_400_days_after_the_start_of_the_machine(self) -> None:
        drive(self.folder, ["--duration", "12"], {}, LONG_AFTER_START)
        result = json.loads((self.folder / "result.json").read_text())
        self.assertGreater(result["frames"]["used"], 0)
        self.assertIsNotNone(result["first_fix_s"])
        self.assertGreater(result["valid_share"], 0.0)
        # Time stamps of the log count from the start of the drive.
        last = (self.folder / "can.log").read_text().splitlines()[-1]
        self.assertLess(float(last[1 : last.index(")")]), 60.0)


if __name__ == "__main__":
    unittest.main()
