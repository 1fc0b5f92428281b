"""Writes the tables of docs/performance.md."""

from __future__ import annotations

from pathlib import Path

from tooling.markdown import write_between_marks

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT / "docs/performance.md"


def write_table(name: str, table: str, document: Path = DOCUMENT) -> None:
    """Replaces the text between the marks of a table. MarksError if the marks are missing."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    write_between_marks(document, begin, end, table)
