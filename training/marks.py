"""Updates the generated part of a document, which lies between two marks."""

from __future__ import annotations

from pathlib import Path

from training.errors import MarksError


def write_between_marks(document: Path, begin: str, end: str, text: str) -> None:
    """Replaces the text between the first `begin` and the next `end`. MarksError if one is
    missing."""
    head, found_begin, rest = document.read_text().partition(begin)
    _, found_end, tail = rest.partition(end)
    if not (found_begin and found_end):
        raise MarksError(f"{document}: wanted the marks '{begin.strip()}' and '{end.strip()}'")
    document.write_text(head + begin + text + end + tail)
