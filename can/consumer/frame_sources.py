"""Reads frames for bevloc_reader.py, from a candump log or from a bus with python3-can.

A line of a log is "(1.000000) can0 500#0011" or, of CAN FD, "(1.000000) can0 509##1001122".
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Iterator
from typing import NamedTuple


class Frame(NamedTuple):
    """A data frame with an 11-bit identifier."""

    identifier: int
    data: bytes
    arrival_s: float
    now_s: float  # the time of reading


class LogError(Exception):
    """What is wrong with a log, in one sentence."""


class BusError(Exception):
    """Why a bus cannot be read, in one sentence."""


LINE = re.compile(
    r"\((?P<time>\d{1,13}\.\d{6})(?:\d{3})?\) +(?P<interface>[^ ]+) (?:"
    r"(?P<id>[0-7][0-9A-Fa-f]{2})#(?:#[0-9A-Fa-f](?P<fd>(?:[0-9A-Fa-f]{2}){0,64})"
    r"|(?P<classic>(?:[0-9A-Fa-f]{2}){0,8})(?:_[0-9A-Fa-f])?)(?: .*)?"
    r"|[0-9A-Fa-f]{3}#R.*|[0-9A-Fa-f]{8}#.*)", re.ASCII)
"""A data frame, whose raw length code such as "_F" is not used, or any other frame. Blanks may
precede the interface, because candump aligns the names."""

DROPPED = "DROPCOUNT: "
"""Begins a line that says how many frames candump has lost (candump -d)."""


def data_frames_of(path: str) -> Iterator[tuple[int, re.Match[str]]]:
    """The data frames of a candump log, with the numbers of their lines."""
    try:
        with open(path, encoding="utf-8", errors="replace", newline="\n") as log:
            for number, line in enumerate(log, start=1):
                text = line.rstrip("\r\n")
                found = LINE.fullmatch(text)
                if text and not found and not text.startswith(DROPPED):
                    raise LogError(
                        f"{path}:{number}: found something else, wanted a line of candump -l, "
                        "such as '(1436509052.249713) can0 044#2A366C2BBA'")
                if found and found["id"]:
                    yield number, found
    except OSError:
        raise LogError(f"{path}: found no readable file, wanted a candump log") from None


def frames_of_log(path: str) -> Iterator[Frame]:
    """The frames of the first interface of a candump log. Each interface is a bus of its own, so do
    not mix their frames. Says once on standard error that there are others. Raises LogError if the
    file is not a candump log."""
    first: str | None = None
    has_others = False
    for number, found in data_frames_of(path):
        interface = found["interface"]
        first = first or interface
        if interface == first:
            data = bytes.fromhex(found["fd"] or found["classic"] or "")
            time_s = float(found["time"])
            yield Frame(int(found["id"], 16), data, time_s, time_s)
        elif not has_others:
            has_others = True
            print(f"{path}:{number}: found interface {interface} after {first}, wanted one; "
                  f"all but {first} are skipped", file=sys.stderr)


def frames_of_bus(interface: str, channel: str) -> Iterator[Frame | float]:
    """The frames with the time of their arrival, and the time alone after 10 ms without one: only
    then is a silence noticed. A program that was held up reads old frames. SocketCAN stamps them by
    the clock of time.time(), which may be set; so only their age is used. Other interfaces have
    clocks of their own: there the time of reading counts as arrival. Raises BusError."""
    try:
        import can  # python3-can
    except ImportError as error:
        raise BusError(
            f"found no python3-can ({error}), wanted it for a live bus: install it") from None
    try:
        with can.interface.Bus(interface=interface, channel=channel, fd=True) as bus:
            while True:
                message = bus.recv(timeout=0.01)
                time_s = time.monotonic()
                if message is None or (message.is_extended_id or message.is_remote_frame
                                       or message.is_error_frame):
                    yield time_s
                else:
                    age_s = time.time() - message.timestamp if interface == "socketcan" else 0.0
                    yield Frame(message.arbitration_id, bytes(message.data),
                                time_s - max(age_s, 0.0), time_s)
    except (can.CanError, OSError) as error:
        raise BusError(f"{channel}: found no frames ({error}), wanted a bus that is up") from None
