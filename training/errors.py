"""What ends a program on purpose. The message is one sentence for whoever started it."""

from __future__ import annotations

import sys
from collections.abc import Callable


class TrainingError(Exception):
    """Something from outside the program that it cannot go on with."""


class CheckpointError(TrainingError):
    """A checkpoint that cannot be read, or is of another network or run."""


class NotFiniteError(TrainingError):
    """A loss, a gradient or a weight that is infinite or no number."""


class MarksError(TrainingError, ValueError):
    """A document without the marks between which a program writes."""


def run_program(main: Callable[[], None]) -> None:
    """Ends with the message alone where `main` raises a TrainingError."""
    try:
        main()
    except TrainingError as error:
        sys.exit(str(error))
