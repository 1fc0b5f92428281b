"""The outcome of a scenario, as a row of a table."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Outcome:
    injected: str
    seen: str
    recovery_s: float | None  # on the guest's clock; None if nothing had to recover
    passed: bool


def table(outcomes: dict[str, Outcome]) -> str:
    """Returns the outcomes as a Markdown table."""
    rows = ["| scenario | injected | seen | recovery | |", "|---|---|---|---|---|"]
    rows += [row(name, outcome) for name, outcome in outcomes.items()]
    return "\n".join(rows)


def row(name: str, outcome: Outcome) -> str:
    recovery = "-" if outcome.recovery_s is None else f"{outcome.recovery_s:.2f} s"
    verdict = "pass" if outcome.passed else "FAIL"
    return f"| {name} | {outcome.injected} | {outcome.seen} | {recovery} | {verdict} |"
