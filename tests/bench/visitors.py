"""Measures what the live page and its visitors cost the pose.

    tests/bench/visitors [--rounds N] [--duration S] [--config FILE]

Drives the demo in real time without the page, with a page that nobody visits, with a viewer, and
with hostile clients (slow, huge, malformed, silent and unread requests). The cases take turns in
each round. Prints medians of the rounds. Use an otherwise idle machine.
"""

from __future__ import annotations

import argparse
import contextlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from evaluation.live.drive import free_port
from tests.bench import clients
from tests.bench.contention import Drive, daemon_program, drive
from tests.bench.document import ROOT


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


def run(case: Case, daemon: Path, config: Path, duration_s: float) -> Drive:
    port = free_port()
    options = ("--live", str(port)) if case.served else ()
    visitor = clients.running(case.client, port) if case.client else contextlib.nullcontext()
    with visitor:
        return drive(daemon, config, duration_s, *options)


def ratios(drives: list[Drive], references: list[Drive]) -> list[float]:
    """The median latency of each drive, divided by that of the drive of the same round without a
    page."""
    pairs = zip(drives, references, strict=True)
    return [one.p50_ms / reference.p50_ms for one, reference in pairs]


def table_of(drives: dict[str, list[Drive]]) -> str:
    """One line per case. `ratio` is the median of the ratios, with the least and the largest."""
    lines = [
        "| | p50, ms | p99, ms | ratio of p50 | framesets skipped | frames missed |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    references = next(iter(drives.values()))
    for name, of_case in drives.items():
        ratio = ratios(of_case, references)
        lines.append(
            f"| {name} | {median(one.p50_ms for one in of_case):.1f} |"
            f" {median(one.p99_ms for one in of_case):.1f} |"
            f" {median(ratio):.3f} ({min(ratio):.3f} to {max(ratio):.3f}) |"
            f" {sum(one.frames['skipped'] for one in of_case) // 6} |"
            f" {sum(one.frames['missed'] for one in of_case)} |"
        )
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--duration", type=float, default=20.0, help="of each drive, s")
    parser.add_argument("--config", type=Path, default=ROOT / "config/demo.yaml")
    options = parser.parse_args()

    daemon = daemon_program()
    drives: dict[str, list[Drive]] = {case.name: [] for case in CASES}
    for _ in range(options.rounds):
        for case in CASES:
            drives[case.name].append(run(case, daemon, options.config, options.duration))
    print(table_of(drives))
    return 0


if __name__ == "__main__":
    sys.exit(main())
