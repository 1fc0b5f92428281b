"""What came of a scenario."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Outcome:
    injected: str
    seen: str
    recovery_s: float | None  # by the guest's clock; None without a recovery
    passed: bool


def table(outcomes: dict[str, Outcome]) -> str:
    """As Markdown."""
    rows = ["| scenario | injected | seen | recovery | |", "|---|---|---|---|---|"]
    rows += [row(name, outcome) for name, outcome in outcomes.items()]
    return "\n".join(rows)


def row(name: str, outcome: Outcome) -> str:
    recovery = "-" if outcome.recovery_s is None else f"{outcome.recovery_s:.2f} s"
    verdict = "pass" if outcome.passed else "FAIL"
    return f"| {name} | {outcome.injected} | {outcome.seen} | {recovery} | {verdict} |"
