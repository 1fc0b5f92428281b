"""What the programs of the lab share: playing a scenario, the table, and the exit status."""

import pathlib
import sys
from collections.abc import Callable

from tests.hil.lab.agent import LabError
from tests.hil.lab.outcome import Outcome, row, table


def play(name: str, scenario: Callable[[], Outcome]) -> Outcome:
    """Plays a scenario and prints its row. A failure of the lab is a failed outcome."""
    try:
        outcome = scenario()
    except LabError as error:
        outcome = Outcome("-", str(error).strip().replace("\n", " / "), None, False)
    print(f"lab: {row(name, outcome)}", flush=True)
    return outcome


def report(outcomes: dict[str, Outcome], results: pathlib.Path) -> int:
    """Prints the table, writes it to table.md, and returns the exit status."""
    text = table(outcomes)
    (results / "table.md").write_text(text, encoding="utf-8")
    print(text, end="")
    return 0 if all(outcome.passed for outcome in outcomes.values()) else 1


def run(main: Callable[[], int]) -> None:
    """Runs a program and ends with its status; a failure of the lab is a message and status 1."""
    try:
        sys.exit(main())
    except LabError as error:
        print(f"lab: {error}", file=sys.stderr)
        sys.exit(1)
