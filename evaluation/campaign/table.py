"""One table of docs/integrity.md: one line per mode, with its worst seed."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from statistics import median
from typing import Optional, TypedDict

from tooling import markdown

HEADER = (
    "mode",
    "what goes wrong",
    "detected by",
    "after, s",
    "valid beyond the alert limits, s",
    "worst error, m / m / deg",
    "recovered after, s",
    "valid",
    "",
)


class Row(TypedDict):
    """What the table shows of one run (evaluation/campaign/campaign_report.cpp)."""

    mode: str
    what: str
    seed: int
    detected_by: Optional[str]
    detection_s: Optional[float]
    valid_beyond_alert_s: float
    limit_s: float
    worst: list[float]
    fault_ends: bool
    recovery_s: Optional[float]
    valid_share: float


def in_seconds(values: list[Optional[float]], runs: int) -> str:
    """The median and the largest value; if some runs have none, also how many runs have one."""
    known = sorted(value for value in values if value is not None)
    if not known:
        return "-"
    text = f"{median(known):.2f}"
    if len(known) > 1:
        text += f" to {known[-1]:.2f}"
    return text if len(known) == runs else f"{text} in {len(known)} of {runs}"


def most_common(names: list[Optional[str]]) -> str:
    counts = Counter(name for name in names if name)
    return ", ".join(name for name, _ in counts.most_common(2)) or "-"


def cells_of(rows: list[Row]) -> list[str]:
    """The row of one mode."""
    runs = len(rows)
    beyond = max(row["valid_beyond_alert_s"] for row in rows)
    worst = [max(row["worst"][axis] for row in rows) for axis in range(3)]
    valid = 100 * sum(row["valid_share"] for row in rows) / runs
    ends = rows[0]["fault_ends"]
    has_fault = rows[0]["mode"] != "none"
    return [
        f"`{rows[0]['mode']}`",
        rows[0]["what"],
        most_common([row["detected_by"] for row in rows]),
        in_seconds([row["detection_s"] for row in rows], runs) if has_fault else "",
        f"{beyond:.2f}",
        " / ".join(f"{value:.2f}" for value in worst),
        in_seconds([row["recovery_s"] for row in rows], runs) if ends else "",
        f"{valid:.1f} %",
        "" if beyond <= rows[0]["limit_s"] else f"**fails** ({rows[0]['limit_s']:g} s allowed)",
    ]


def text_of(rows: list[Row]) -> str:
    """The whole table."""
    by_mode: dict[str, list[Row]] = {}
    for row in rows:
        by_mode.setdefault(row["mode"], []).append(row)
    return markdown.table(HEADER, map(cells_of, by_mode.values()), text_columns=3)


def marks(level: str) -> tuple[str, str]:
    return f"<!-- campaign {level} -->\n", f"<!-- end of campaign {level} -->\n"


def write(page: Path, level: str, command: str, text: str) -> None:
    """Replaces what lies between the marks of the level. MarksError if the marks are missing."""
    begin, end = marks(level)
    markdown.write_between_marks(page, begin, end, f"\n    {command}\n\n{text}\n")


def command_line(
    level: str,
    seeds: int,
    first_seed: int,
    duration_s: float,
    modes: Optional[list[str]],
    maps: list[Path],
) -> str:
    words = [f"script/campaign --level {level} --seeds {seeds} --first-seed {first_seed}"]
    words.append(f"--duration {duration_s:g} --update")
    if maps:
        words.append("--map " + " ".join(path.name for path in maps))
    if modes:
        words.append("--modes " + " ".join(modes))
    return " ".join(words)
