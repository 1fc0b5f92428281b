"""Finds the bevloc program."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def bevloc_program() -> Path:
    """$BEVLOC, or the bevloc of the release build."""
    program = Path(os.environ.get("BEVLOC", ROOT / "build/release/bin/bevloc"))
    if not program.is_file():
        raise SystemExit(f"{program}: no such program; build it with script/build or set BEVLOC")
    return program
