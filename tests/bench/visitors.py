"""Measures what the live page and its visitors cost the pose.

    tests/bench/visitors [--rounds N] [--duration S] [--config FILE]

Drives the demo in real time without the page, with a page that nobody visits, with a viewer, and
with hostile clients (slow, huge, malformed, silent and unread requests). The cases take turns in
each round. Prints for each frameset how long the threads of the pose path were busy and how long
they waited for a processor, and the latency from exposure to CAN. Use an otherwise idle machine.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from evaluation.live.drive import free_port
from tests.bench import clients
from tests.bench.contention import Drive, daemon_program, drive
from tests.bench.document import ROOT
from tooling.markdown import table


# The threads that a pose passes through, from the cameras' frames to the bus.
_POSE_PATH = ("vision", "can-in", "can-out")


@dataclass(frozen=True)
class Run:
    """A drive, and the time of the threads of the pose path for each frameset: on a processor, and
    ready but waiting for one."""

    drive: Drive
    busy_ms: float
    waiting_ms: float


class PosePath:
    """Reads the times of the pose path's threads from /proc until their process ends."""

    def __init__(self) -> None:
        self._times_ns: dict[str, tuple[int, int]] = {}

    def watch(self, pid: int) -> None:
        """The last times that are read miss less than 0.1 s of a drive."""
        while not os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            self.read(pid)
            time.sleep(0.1)

    def read(self, pid: int) -> None:
        for thread in Path(f"/proc/{pid}/task").glob("*"):
            with contextlib.suppress(OSError):
                name = (thread / "comm").read_text().strip()
                if name in _POSE_PATH:
                    busy_ns, waiting_ns, _ = (thread / "schedstat").read_text().split()
                    self._times_ns[name] = int(busy_ns), int(waiting_ns)

    def run_of(self, of_drive: Drive) -> Run:
        framesets = of_drive.frames["used"] / 6
        busy_ns, waiting_ns = (sum(times) for times in zip(*self._times_ns.values(), strict=True))
        return Run(of_drive, 1e-6 * busy_ns / framesets, 1e-6 * waiting_ns / framesets)


@dataclass(frozen=True)
class Case:
    """One way in which the page is used."""

    name: str
    served: bool
    client: Callable[[int], None] | None = None


CASES = (
    Case("no page", served=False),
    Case("page, nobody looks", served=True),
    Case("one viewer", served=True, client=clients.view),
    Case("hostile clients", served=True, client=clients.attack),
)


def run(case: Case, daemon: Path, config: Path, duration_s: float) -> Run:
    port = free_port()
    options = ("--live", str(port)) if case.served else ()
    visitor = clients.running(case.client, port) if case.client else contextlib.nullcontext()
    pose_path = PosePath()
    with visitor:
        of_drive = drive(daemon, config, duration_s, *options, watch=pose_path.watch)
    return pose_path.run_of(of_drive)


def ratios(runs: list[Run], references: list[Run]) -> list[float]:
    """The processor time of each run, divided by that of the same round without a page."""
    pairs = zip(runs, references, strict=True)
    return [one.busy_ms / reference.busy_ms for one, reference in pairs]


def table_of(runs: dict[str, list[Run]]) -> str:
    """One line per case, with medians of the rounds. The ratio is given with the least and the
    largest; framesets and frames are sums."""
    header = ("", "busy, ms", "ratio", "waiting, ms", "p50, ms", "p99, ms", "skipped", "missed")
    rows = []
    references = next(iter(runs.values()))
    for name, of_case in runs.items():
        ratio = ratios(of_case, references)
        drives = [one.drive for one in of_case]
        rows.append([
            name,
            f"{median(one.busy_ms for one in of_case):.2f}",
            f"{median(ratio):.3f} ({min(ratio):.3f} to {max(ratio):.3f})",
            f"{median(one.waiting_ms for one in of_case):.2f}",
            f"{median(one.p50_ms for one in drives):.1f}",
            f"{median(one.p99_ms for one in drives):.1f}",
            str(sum(one.frames["skipped"] for one in drives) // 6),
            str(sum(one.frames["missed"] for one in drives)),
        ])
    return table(header, rows)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--duration", type=float, default=20.0, help="of each drive, s")
    parser.add_argument("--config", type=Path, default=ROOT / "config/demo.yaml")
    options = parser.parse_args()

    daemon = daemon_program()
    runs: dict[str, list[Run]] = {case.name: [] for case in CASES}
    for _ in range(options.rounds):
        for case in CASES:
            runs[case.name].append(run(case, daemon, options.config, options.duration))
    print(table_of(runs), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
