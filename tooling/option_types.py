"""Types of command line options. argparse prints their messages."""

from __future__ import annotations

import math
import os
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path


def whole_number(least: int) -> Callable[[str], int]:
    """The type of whole numbers of at least `least`."""

    def parsed(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise ArgumentTypeError(f"found '{text}', wanted a whole number of at least {least}")
        return int(text)

    return parsed


positive = whole_number(1)


def above_zero(text: str) -> float:
    """A finite number of more than 0."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0.0 < number < math.inf:
        raise ArgumentTypeError(f"found '{text}', wanted a number of more than 0")
    return number


def writable(text: str) -> Path:
    """A file that can be written, so that a long run does not end without its result."""
    path = Path(text)
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise ArgumentTypeError(f"found '{text}', wanted a file in a folder that can be written")
    return path
