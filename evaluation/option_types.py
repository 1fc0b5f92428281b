"""Types of command line options. argparse prints their messages."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError
from pathlib import Path


def positive(text: str) -> int:
    """A whole number of at least 1."""
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"found '{text}', wanted a whole number of at least 1")
    return int(text)


def writable(text: str) -> Path:
    """A file that can be written, so that a long run does not end without its result."""
    path = Path(text)
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise ArgumentTypeError(f"found '{text}', wanted a file in a folder that can be written")
    return path
