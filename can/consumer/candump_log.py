"""Reads candump logs, for bevloc_reader.py: "(1.000000) can0 500#0011" or, of CAN FD,
"(1.000000) can0 509##1001122"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple


class Frame(NamedTuple):
    """A data frame with an 11-bit identifier."""

    identifier: int
    data: bytes
    time_s: float


class LogError(Exception):
    """What is wrong with a log, in one sentence."""


LINE = re.compile(
    r"\((?P<time>\d{1,13}\.\d{6})(?:\d{3})?\) [^ ]+ (?:"
    r"(?P<id>[0-7][0-9A-Fa-f]{2})#(?:#[0-9A-Fa-f](?P<fd>(?:[0-9A-Fa-f]{2}){0,64})"
    r"|(?P<classic>(?:[0-9A-Fa-f]{2}){0,8})(?:_[0-9A-Fa-f])?)(?: .*)?"
    r"|[0-9A-Fa-f]{3}#R.*|[0-9A-Fa-f]{8}#.*)", re.ASCII)
"""A data frame, whose raw length code such as "_F" is not used, or any other frame."""


def frames_of_log(path: str) -> Iterator[Frame]:
    """The frames of a candump log. Raises LogError where it is none."""
    try:
        with open(path, encoding="utf-8", errors="replace", newline="\n") as log:
            for number, line in enumerate(log, start=1):
                text = line.rstrip("\r\n")
                found = LINE.fullmatch(text)
                if text and not found:
                    raise LogError(
                        f"{path}:{number}: found something else, wanted a line of candump -l, "
                        "such as '(1436509052.249713) can0 044#2A366C2BBA'")
                if found and found["id"]:
                    data = bytes.fromhex(found["fd"] or found["classic"] or "")
                    yield Frame(int(found["id"], 16), data, float(found["time"]))
    except OSError:
        raise LogError(f"{path}: found no readable file, wanted a candump log") from None
