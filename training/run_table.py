"""The CSV files to which a run appends its losses and errors."""

from __future__ import annotations

import csv
from pathlib import Path

# Of the losses and of the errors of validations. Both have a column `samples`: how many the run had
# used.
CURVES, VALIDATION = "curves.csv", "validation.csv"
TABLES = (CURVES, VALIDATION)
_UNKNOWN = "nan"


def append_row(path: Path, row: dict[str, float]) -> None:
    """Appends a row and creates the table if necessary. If the table lacks a column because an
    older version of the program created it, the column is added with "nan" in the earlier rows."""
    columns, rows = _read(path)
    if missing := [name for name in row if name not in columns]:
        columns = [*columns, *missing]
        _write(path, columns, rows)
    with path.open("a", newline="") as file:
        csv.DictWriter(file, columns, restval=_UNKNOWN).writerow(row)


def drop_rows_after(run: Path, samples: int) -> None:
    """Removes the rows of more than `samples` samples from both tables of a run. A run that is
    continued from an older checkpoint writes them again."""
    for path in (run / name for name in TABLES):
        columns, rows = _read(path)
        kept = [row for row in rows if float(row["samples"]) <= samples]
        if len(kept) < len(rows):
            _write(path, columns, kept)


def _read(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    if not path.exists():
        return [], []
    with path.open(newline="") as file:
        reader = csv.DictReader(file)
        return list(reader.fieldnames or []), list(reader)


def _write(path: Path, columns: list[str], rows: list[dict[str, str]]) -> None:
    partial = path.with_suffix(".partial")
    with partial.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval=_UNKNOWN)
        writer.writeheader()
        writer.writerows(rows)
    partial.replace(path)
