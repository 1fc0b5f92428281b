"""Measures what a busy core costs: the same drive in real time, alone and beside a busy process.

    tests/bench/contention [--duration S] [--cpu N] [--config FILE]

Prints latency, frames and memory of both drives. Exit status 1: a frame is not accounted for, or
p99 grew by more than --max-ratio. The busy process runs at the same priority as bevlocd. Use an
otherwise idle machine: the mock cameras render on the same cores, and images that are not rendered
in time count as missed.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.bench.document import ROOT

_CAMERAS = 6
# Cameras may start this much later than the drive, and be this far behind at its end.
_SLACK_S = 1.0
# Frames that may wait in the queue or for the rest of their frameset.
_FRAMES_UNDER_WAY = 2 * _CAMERAS


@dataclass(frozen=True)
class Drive:
    """Results of one drive (bevlocd --json) and the peak resident memory."""

    p50_ms: float
    p99_ms: float
    frames: dict[str, int]
    realtime_refusals: int
    resident_mib: float

    @staticmethod
    def of(result: dict, resident_kib: int) -> Drive:
        return Drive(
            p50_ms=result["latency_ms"]["p50"],
            p99_ms=result["latency_ms"]["p99"],
            frames=result["frames"],
            realtime_refusals=result["realtime_refusals"],
            resident_mib=resident_kib / 1024,
        )

    def unaccounted(self, exposures: float) -> int:
        """The number of exposed frames that were neither captured nor counted as missed, plus
        captured frames without a known outcome."""
        known = self.frames["captured"] + self.frames["missed"]
        lost = max(0, math.ceil(exposures) - known)
        return lost + max(0, self.frames["under_way"] - _FRAMES_UNDER_WAY)


def daemon_program() -> Path:
    """$BEVLOCD, or the bevlocd of the release build."""
    program = Path(os.environ.get("BEVLOCD", ROOT / "build/release/bin/bevlocd"))
    if not program.is_file():
        raise SystemExit(f"{program}: no such program; build it with script/build or set BEVLOCD")
    return program


def exposures_of(config: str, duration_s: float) -> float:
    """The least number of exposures of all mock cameras of a configuration in one drive."""
    rate = re.search(r"^\s+rate_hz:\s*([\d.]+)", config, re.MULTILINE)
    if rate is None:
        raise SystemExit("the configuration has no rate_hz; use one with mock cameras")
    return _CAMERAS * float(rate[1]) * (duration_s - _SLACK_S)


def p99_ratio(alone: Drive, busy: Drive) -> float:
    """The ratio of the 99th percentiles. It is infinite if a drive localized nothing."""
    if busy.p99_ms == 0.0 or alone.p99_ms == 0.0:
        return float("inf")
    return busy.p99_ms / alone.p99_ms


def table_of(alone: Drive, busy: Drive) -> str:
    """A table with both drives side by side."""
    rows = [
        ("exposure to CAN, p50, ms", f"{alone.p50_ms:.1f}", f"{busy.p50_ms:.1f}"),
        ("exposure to CAN, p99, ms", f"{alone.p99_ms:.1f}", f"{busy.p99_ms:.1f}"),
        ("ratio of p99", "", f"{p99_ratio(alone, busy):.2f}"),
    ]
    names = {
        "captured": "frames captured (six are a frameset)",
        "used": "  used",
        "displaced": "  dropped for newer ones in the queue",
        "mismatched": "  dropped without a frameset",
        "skipped": "  in skipped framesets",
        "under_way": "  under way at the end",
        "missed": "frames missed by the cameras",
    }
    rows += [(text, str(alone.frames[key]), str(busy.frames[key])) for key, text in names.items()]
    rows += [
        ("realtime settings refused", str(alone.realtime_refusals), str(busy.realtime_refusals)),
        ("resident with simulator, MiB", f"{alone.resident_mib:.0f}", f"{busy.resident_mib:.0f}"),
    ]
    lines = [f"{'':<38}{'alone':>10}{'busy core':>12}"]
    lines += [f"{name:<38}{first:>10}{second:>12}" for name, first, second in rows]
    return "\n".join(lines)


@contextlib.contextmanager
def busy_core(cpu: int) -> Iterator[None]:
    """Runs a busy loop on that CPU."""
    process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        os.sched_setaffinity(process.pid, {cpu})
        yield
    finally:
        process.kill()
        process.wait()


def drive(
    daemon: Path,
    config: Path,
    duration_s: float,
    *further: str,
    watch: Callable[[int], None] = lambda pid: None,
) -> Drive:
    """Drives in real time; `further` are options of bevlocd. `watch` is called with the process
    id, and must return when the process has ended."""
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.json"
        command: list[str | Path] = [daemon, "--config", config, "--out", folder]
        command += ["--duration", str(duration_s), *further]
        process = subprocess.Popen([*command, "--json", result], stdout=subprocess.DEVNULL)
        watch(process.pid)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise SystemExit(f"{daemon} ended with {process.returncode}")
        return Drive.of(json.loads(result.read_text()), usage.ru_maxrss)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    last_cpu = max(os.sched_getaffinity(0))
    parser.add_argument("--duration", type=float, default=600.0, help="of each drive, s")
    parser.add_argument("--cpu", type=int, default=last_cpu, help="that the busy process takes")
    parser.add_argument("--config", type=Path, default=ROOT / "config/demo.yaml")
    parser.add_argument("--max-ratio", type=float, default=2.5, help="that p99 may grow by")
    options = parser.parse_args()

    daemon = daemon_program()
    exposures = exposures_of(options.config.read_text(), options.duration)
    alone = drive(daemon, options.config, options.duration)
    with busy_core(options.cpu):
        busy = drive(daemon, options.config, options.duration)
    print(table_of(alone, busy))

    unaccounted = {"alone": alone.unaccounted(exposures), "busy core": busy.unaccounted(exposures)}
    for name, count in unaccounted.items():
        if count > 0:
            print(f"{name}: {count} of {exposures:.0f} frames are not accounted for")
    too_slow = p99_ratio(alone, busy) > options.max_ratio
    if too_slow:
        print(f"p99 grew by more than {options.max_ratio}")
    return int(too_slow or any(unaccounted.values()))


if __name__ == "__main__":
    sys.exit(main())
