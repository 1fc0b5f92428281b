"""Errors that end a program with a one-line message to the user."""

from __future__ import annotations

import sys
from collections.abc import Callable


class TrainingError(Exception):
    """Wrong input: the program cannot continue."""


class CheckpointError(TrainingError):
    """A checkpoint is unreadable or belongs to another network or run."""


class NotFiniteError(TrainingError):
    """A loss, gradient or weight is infinite or NaN."""


class MarksError(TrainingError, ValueError):
    """A document lacks the marks between which a program writes."""


def run_program(main: Callable[[], None]) -> None:
    """Runs `main`; on a TrainingError, prints its message without a traceback and exits with 1."""
    try:
        main()
    except TrainingError as error:
        sys.exit(str(error))
