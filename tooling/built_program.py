"""Runs programs that script/build makes."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from tooling.errors import UserError


def run_built(
    command: Sequence[str | Path], folder: Path | None = None, quiet: bool = True
) -> subprocess.CompletedProcess[str]:
    """Runs `command`, whose first word is the program, in `folder`. Without `quiet`, the program
    prints to the terminal itself. UserError if there is no such program that runs."""
    try:
        return subprocess.run(command, cwd=folder, capture_output=quiet, text=True, check=False)
    except OSError as error:
        raise UserError(
            f"{command[0]}: found no program that runs ({error.strerror}), wanted that of "
            "script/build"
        ) from error
