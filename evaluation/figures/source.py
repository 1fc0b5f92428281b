"""Reads the files of which figures are drawn."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


class SourceError(ValueError):
    """A file without the data that a figure needs."""


def read(file: Path) -> Any:
    """The JSON of a file. SourceError if there is none."""
    try:
        return json.loads(file.read_bytes())
    except (OSError, ValueError) as error:
        raise SourceError(f"{file}: found no JSON ({error}), wanted some") from error
