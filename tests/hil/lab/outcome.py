"""The outcome of a scenario, as a row of a table."""

import dataclasses

from tooling import markdown

HEADER = ("scenario", "injected", "seen", "recovery", "")


@dataclasses.dataclass(frozen=True)
class Outcome:
    injected: str
    seen: str
    recovery_s: float | None  # on the guest's clock; None if nothing had to recover
    passed: bool


def table(outcomes: dict[str, Outcome]) -> str:
    """Returns the outcomes as a Markdown table."""
    rows = [cells_of(name, outcome) for name, outcome in outcomes.items()]
    return markdown.table(HEADER, rows, text_columns=len(HEADER))


def row(name: str, outcome: Outcome) -> str:
    return markdown.row(cells_of(name, outcome))


def cells_of(name: str, outcome: Outcome) -> list[str]:
    recovery = "-" if outcome.recovery_s is None else f"{outcome.recovery_s:.2f} s"
    verdict = "pass" if outcome.passed else "FAIL"
    return [name, outcome.injected, outcome.seen, recovery, verdict]
