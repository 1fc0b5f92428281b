"""Errors that end a program with a one-line message to the user."""

from __future__ import annotations

import sys
from collections.abc import Callable


class UserError(Exception):
    """Wrong input: the program cannot continue. The message is one line."""


class MarksError(UserError, ValueError):
    """A document lacks the marks between which a program writes."""


def run_program(main: Callable[[], None]) -> None:
    """Runs `main`. On a UserError, or if the system refuses a file, prints a message of one line
    without a traceback and exits with 1."""
    try:
        main()
    except UserError as error:
        sys.exit(str(error))
    except OSError as error:
        if error.filename is None:  # not a file that the user named
            raise
        sys.exit(
            f"{error.filename}: found no way to use it ({error.strerror}), wanted a usable file or "
            "folder"
        )
