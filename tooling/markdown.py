"""Writes Markdown tables, and the generated part of a document, which lies between two marks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from tooling.errors import MarksError


def row(cells: Iterable[str]) -> str:
    """One line of a table, without its end."""
    return f"| {' | '.join(cells)} |"


def table(header: Sequence[str], rows: Iterable[Iterable[str]], text_columns: int = 1) -> str:
    """The first `text_columns` columns are aligned to the left, the others to the right. Every line
    ends with a newline."""
    rule = ["---"] * text_columns + ["---:"] * (len(header) - text_columns)
    return "".join(f"{row(cells)}\n" for cells in (header, rule, *rows))


def write_between_marks(document: Path, begin: str, end: str, text: str) -> None:
    """Replaces the text between the first `begin` and the next `end`. MarksError if one is
    missing."""
    head, found_begin, rest = document.read_text().partition(begin)
    _, found_end, tail = rest.partition(end)
    if not (found_begin and found_end):
        raise MarksError(f"{document}: wanted the marks '{begin.strip()}' and '{end.strip()}'")
    document.write_text(head + begin + text + end + tail)
