"""Reads JSON files record by record, with type-checked access to their fields.

The tables of all nuScenes drives are over 1 GB of text each, and most of it is not needed.
Therefore a table is never held in memory as a whole.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

from training.nuscenes.errors import MissingFileError, UnreadableJsonError, WrongTypeError

_CHUNK_CHARACTERS = 2**20
_LONGEST_RECORD_CHARACTERS = 2**22
_SPACE = " \t\r\n"


class Record:
    """A JSON object and its place (file and record). Every accessor raises WrongTypeError if the
    field is missing or of another type."""

    __slots__ = ("values", "place")

    def __init__(self, values: Any, place: str) -> None:
        if not isinstance(values, dict):
            raise WrongTypeError(f"{place}: found {_shown(values)}, wanted an object")
        self.values = values
        self.place = place

    def _get(self, key: str, wanted: str) -> Any:
        if key not in self.values:
            raise WrongTypeError(f"{self.place}: found no '{key}', wanted {wanted}")
        return self.values[key]

    def _refuse(self, key: str, wanted: str) -> WrongTypeError:
        return WrongTypeError(
            f"{self.place}: '{key}' is {_shown(self.values[key])}, wanted {wanted}"
        )

    def text(self, key: str) -> str:
        value = self._get(key, wanted := "a text")
        if not isinstance(value, str):
            raise self._refuse(key, wanted)
        return value

    def flag(self, key: str) -> bool:
        value = self._get(key, wanted := "true or false")
        if not isinstance(value, bool):
            raise self._refuse(key, wanted)
        return value

    def whole(self, key: str) -> int:
        value = self._get(key, wanted := "a whole number")
        if not isinstance(value, int) or isinstance(value, bool):
            raise self._refuse(key, wanted)
        return value

    def number(self, key: str) -> float:
        value = self._get(key, wanted := "a number")
        if not _is_number(value):
            raise self._refuse(key, wanted)
        return float(value)

    def numbers(self, key: str, count: int) -> tuple[float, ...]:
        value = self._get(key, wanted := f"{count} numbers")
        if not _is_list_of_numbers(value, count):
            raise self._refuse(key, wanted)
        return tuple(map(float, value))

    def unit_quaternion(self, key: str) -> tuple[float, ...]:
        """w, x, y, z. A norm within 0.001 of 1 is accepted and normalised to 1."""
        values = self.numbers(key, 4)
        norm = math.hypot(*values)
        if abs(norm - 1.0) > 1e-3:
            raise self._refuse(key, f"a unit quaternion (its norm is {norm:.5g})")
        return tuple(value / norm for value in values)

    def matrix3(self, key: str) -> tuple[tuple[float, ...], ...]:
        value = self._get(key, wanted := "3 rows of 3 numbers")
        if not isinstance(value, list) or len(value) != 3:
            raise self._refuse(key, wanted)
        if not all(_is_list_of_numbers(row, 3) for row in value):
            raise self._refuse(key, wanted)
        return tuple(tuple(map(float, row)) for row in value)

    def texts(self, key: str) -> list[str]:
        value = self._get(key, wanted := "a list of texts")
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self._refuse(key, wanted)
        return value

    def records(self, key: str) -> Iterator[Record]:
        """The objects of a list."""
        value = self._get(key, wanted := "a list of objects")
        if not isinstance(value, list):
            raise self._refuse(key, wanted)
        for number, item in enumerate(value):
            yield Record(item, f"{self.place}: {key} {number}")


def _is_number(value: Any) -> bool:
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return False
    return math.isfinite(value)


def _is_list_of_numbers(value: Any, count: int) -> bool:
    return isinstance(value, list) and len(value) == count and all(map(_is_number, value))


def _shown(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."


def open_text(path: Path) -> TextIO:
    try:
        return path.open(encoding="utf-8")
    except OSError as error:
        raise MissingFileError(f"{path}: cannot be opened ({error.strerror})") from None


def read_object(path: Path) -> Record:
    """Reads a file that holds one JSON object."""
    with open_text(path) as file:
        try:
            return Record(json.load(file), str(path))
        except json.JSONDecodeError as error:
            place = f"{path}: line {error.lineno}, column {error.colno}"
            raise UnreadableJsonError(f"{place}: invalid JSON ({error.msg})") from None
        except UnicodeDecodeError as error:
            raise UnreadableJsonError(f"{path}: byte {error.start}: invalid UTF-8") from None


def read_array(path: Path) -> Iterator[Record]:
    """Yields the objects of a file that holds one JSON array."""
    with open_text(path) as file:
        try:
            yield from _ArrayReader(path, file).records()
        except UnicodeDecodeError:
            raise UnreadableJsonError(f"{path}: invalid UTF-8") from None


class _ArrayReader:
    """Parses a JSON array while reading it; keeps about one chunk of text in memory."""

    def __init__(self, path: Path, file: TextIO) -> None:
        self._path = path
        self._file = file
        self._decoder = json.JSONDecoder()
        self._text = ""
        self._next = 0  # index into _text
        self._lines_before = 0  # line ends before _text
        self._columns_before = 0  # characters between the last of them and _text

    def records(self) -> Iterator[Record]:
        if self._peek() != "[":
            raise self._error(self._next, "wanted '['")
        self._next += 1
        number = 0
        while self._peek() != "]":
            if number > 0:
                if self._peek() != ",":
                    raise self._error(self._next, "wanted ',' or ']'")
                self._next += 1
                self._peek()
            yield Record(self._decode(), f"{self._path}: record {number}")
            number += 1
        self._next += 1
        if self._peek():
            raise self._error(self._next, "wanted the end of the file after ']'")

    def _peek(self) -> str:
        """The next non-space character, without consuming it; empty at the end of the file."""
        while True:
            while self._next < len(self._text) and self._text[self._next] in _SPACE:
                self._next += 1
            if self._next < len(self._text):
                return self._text[self._next]
            if not self._read_on():
                return ""

    def _decode(self) -> Any:
        while True:
            try:
                value, self._next = self._decoder.raw_decode(self._text, self._next)
                return value
            except json.JSONDecodeError as error:
                # The text is either invalid or ends in the middle of a record.
                too_long = len(self._text) - self._next > _LONGEST_RECORD_CHARACTERS
                before = self._next
                if too_long or not self._read_on():
                    raise self._error(error.pos - before + self._next, error.msg) from None

    def _read_on(self) -> bool:
        """Drops the consumed text and appends a chunk; False at the end of the file."""
        done, self._text = self._text[: self._next], self._text[self._next :]
        self._next = 0
        self._lines_before += done.count("\n")
        last_end = done.rfind("\n")
        self._columns_before = (
            self._columns_before + len(done) if last_end < 0 else len(done) - last_end - 1
        )
        chunk = self._file.read(_CHUNK_CHARACTERS)
        self._text += chunk
        return bool(chunk)

    def _error(self, at: int, wanted: str) -> UnreadableJsonError:
        before = self._text[:at]
        line = 1 + self._lines_before + before.count("\n")
        last_end = before.rfind("\n")
        column = at - last_end if last_end >= 0 else self._columns_before + at + 1
        return UnreadableJsonError(
            f"{self._path}: line {line}, column {column}: invalid JSON ({wanted})"
        )
