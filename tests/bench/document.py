"""Writes the tables of docs/performance.md and finds the program that measures them."""

from __future__ import annotations

import os
from pathlib import Path

from training.marks import write_between_marks

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT / "docs/performance.md"


def bevloc_program() -> Path:
    """$BEVLOC, or the bevloc of the release build."""
    program = Path(os.environ.get("BEVLOC", ROOT / "build/release/bin/bevloc"))
    if not program.is_file():
        raise SystemExit(f"{program}: no such program; build it with script/build or set BEVLOC")
    return program


def write_table(name: str, table: str, document: Path = DOCUMENT) -> None:
    """Replaces the text between the marks of a table. MarksError if the marks are missing."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    write_between_marks(document, begin, end, table)
