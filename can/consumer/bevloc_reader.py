#!/usr/bin/python3
"""Reads bevloc's pose from the CAN bus and says whether a function may use it.

As a module, with any source of frames:

    receiver = Receiver(AlertLimits(lateral_m=0.57, longitudinal_m=1.40, yaw_deg=1.50))
    receiver.receive(identifier, data, arrival_s)
    if receiver.answer(time_s) == "usable":
        use(receiver.pose)

As a program: prints each change of the answer, and a pose a second. A live bus needs python3-can.

    can/consumer/bevloc_reader.py can.log
    can/consumer/bevloc_reader.py --interface socketcan --channel vcan0

docs/vehicle-bus.md describes the checks. The name of this folder's parent is that of python3-can,
so import this module from its own folder.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field

from bevloc_messages import LOCALIZER_BASE, MESSAGES, VALUE_NAMES, Message, Signal
from frame_sources import BusError, Frame, LogError, frames_of_bus, frames_of_log

PARTS = (
    "LOC_Time",
    "LOC_Latitude",
    "LOC_Longitude",
    "LOC_PosLocal",
    "LOC_Attitude",
    "LOC_Velocity",
    "LOC_StdDev",
    "LOC_Integrity",
)
"""The messages that make one pose, in the order of sending."""

VALUES = {
    "age_ms": ("LOC_Time", "CaptureAge"),
    "capture_us": ("LOC_Time", "CaptureTime"),
    "latitude_deg": ("LOC_Latitude", "Latitude"),
    "longitude_deg": ("LOC_Longitude", "Longitude"),
    "east_m": ("LOC_PosLocal", "LocalEast"),
    "north_m": ("LOC_PosLocal", "LocalNorth"),
    "heading_deg": ("LOC_Attitude", "Heading"),
    "speed_mps": ("LOC_Velocity", "VelocityX"),
    "lateral_m": ("LOC_Integrity", "ProtectionLateral"),
    "longitudinal_m": ("LOC_Integrity", "ProtectionLongitudinal"),
    "yaw_deg": ("LOC_Integrity", "ProtectionYaw"),
    "risk_exponent": ("LOC_Integrity", "IntegrityRiskExponent"),
    "foreign_sender": ("LOC_Integrity", "Why_ForeignSender"),
}
"""The values of a pose. heading_deg is from true north, not from the map's (docs/can.md, Axes)."""

LEVELS = ("lateral_m", "longitudinal_m", "yaw_deg")
"""The values that are protection levels. AlertLimits has a limit of the same name for each."""

EPOCH_LIMIT_S = 0.039999
CYCLES_TO_TIMEOUT = 3
HALF_MICROSECOND_S = 5e-7
"""Times are whole microseconds, so this is enough for rounding."""


@dataclass
class AlertLimits:
    """The largest errors with which the function is still safe. 0: it does not need the axis."""

    lateral_m: float = 0.0
    longitudinal_m: float = 0.0
    yaw_deg: float = 0.0
    risk_exponent: int = 5


@dataclass
class Counters:
    ok: int = 0
    lost: int = 0
    repeated: int = 0
    wrong_crc: int = 0
    wrong_length: int = 0
    incomplete: int = 0


def crc8_h2f(data: bytes) -> int:
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1) ^ 0x2F if crc & 0x80 else crc << 1
            crc &= 0xFF
    return crc ^ 0xFF


def crc16_ccitt_false(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1
            crc &= 0xFFFF
    return crc


def has_right_crc(message: Message, data: bytes) -> bool:
    if message.is_fd:
        data_id = message.data_id.to_bytes(2, "little")
        return crc16_ccitt_false(data[2:] + data_id) == int.from_bytes(data[:2], "little")
    return crc8_h2f(data[1:] + bytes([message.data_id])) == data[0]


def decode(data: bytes, signal: Signal) -> float | None:
    """None if the signal is not available."""
    raw = int.from_bytes(data, "little") >> signal.start_bit & ((1 << signal.length_bits) - 1)
    sna = (1 << signal.length_bits) - 1
    if signal.is_signed:
        sna = -(1 << (signal.length_bits - 1))
        if raw >> (signal.length_bits - 1):
            raw -= 1 << signal.length_bits
    if signal.has_sna and raw == sna:
        return None
    value = raw * signal.scale + signal.offset
    within = signal.min - 0.5 * signal.scale <= value <= signal.max + 0.5 * signal.scale
    return value if within else None


def is_fresh(time_s: float, stamp_s: float, limit_s: float, name: str) -> bool:
    """Whether at most limit_s passed since a stamp. Stamps may be out of order by one cycle of
    their message. If a stamp lies further ahead, the clock was set back, and its age is not
    known."""
    cycle_s = 1e-3 * MESSAGES[name].cycle_ms
    return -cycle_s - HALF_MICROSECOND_S <= time_s - stamp_s <= limit_s + HALF_MICROSECOND_S


def is_in_time(time_s: float, stamp_s: float, name: str) -> bool:
    """Whether at most three cycles of the message passed since a stamp."""
    return is_fresh(time_s, stamp_s, 1e-3 * CYCLES_TO_TIMEOUT * MESSAGES[name].cycle_ms, name)


def reasons_in(name: str, data: bytes) -> set[str]:
    """The reasons in a frame, such as "GnssMissing" for Why_GnssMissing."""
    return {signal.removeprefix("Why_") for signal, layout in MESSAGES[name].signals.items()
            if signal.startswith("Why_") and decode(data, layout)}


@dataclass
class Receiver:
    """Checks every frame, puts the frames of one EPOCH together, and judges the pose."""

    limits: AlertLimits = field(default_factory=AlertLimits)
    base_id: int = LOCALIZER_BASE
    counters: Counters = field(default_factory=Counters)
    state: str | None = None
    time_source: str | None = None
    map_id: int | None = None
    pose: dict[str, float | None] | None = None
    pose_time_s: float = 0.0
    pose_follows_silence: bool = True
    pose_reasons: set[str] = field(default_factory=set)
    status_reasons: set[str] = field(default_factory=set)
    status_time_s: float = 0.0
    utc_offset_us: int | None = None
    utc_error_ms: float | None = None
    clock_time_s: float = 0.0

    def __post_init__(self) -> None:
        self._names = {message.id_offset: name for name, message in MESSAGES.items()}
        self._last_counter: dict[str, int] = {}
        self._epoch: int | None = None
        self._epoch_time_s = 0.0
        self._frames: dict[str, bytes] = {}

    def receive(self, identifier: int, data: bytes, time_s: float) -> bool:
        """Takes any frame of the bus. `time_s` says when it arrived, not when you read it. True
        when it completes a pose."""
        name = self._names.get(identifier - self.base_id)
        known = ("LOC_Status", "LOC_Clock", "LOC_Solution", *PARTS)
        if name not in known or not self._check(name, data):
            return False
        if name == "LOC_Clock":
            self._take_clock(data, time_s)
            return False
        if name == "LOC_Status":
            self._take_status(data, time_s)
            return False
        if name == "LOC_Solution":
            return self._take_solution(data, time_s)
        return self._take_part(name, data, time_s)

    def answer(self, time_s: float) -> str:
        """Whether the latest pose may be used now ("usable"), and if not, why. "no_pose" means
        that there is no complete pose or no LOC_Status yet."""
        if self.pose is None or self.state is None:
            return "no_pose"
        in_time = is_in_time(time_s, self.pose_time_s, "LOC_Time") and not self.pose_follows_silence
        if not in_time or not is_in_time(time_s, self.status_time_s, "LOC_Status"):
            return "timeout"
        if self.state not in ("TRACKING", "DEGRADED"):
            return "not_valid"
        if self.pose["foreign_sender"]:
            return "foreign_sender"
        if self._lacks_value():
            return "not_available"
        return "beyond_limit" if self._is_beyond_limit() else "usable"

    def why(self) -> set[str]:
        """The reasons why the state is not better, such as "GnssMissing"."""
        return self.status_reasons | self.pose_reasons

    def capture_utc_us(self, time_s: float) -> int | None:
        """When the images behind the latest pose were taken, UTC modulo 2^32 us. None without
        images or a fresh LOC_Clock, or while the localizer's computer does not know UTC."""
        if self.utc_error_ms is None or not is_in_time(time_s, self.clock_time_s, "LOC_Clock"):
            return None
        if self.pose is None or self.pose["age_ms"] is None or self.utc_offset_us is None:
            return None
        return (int(self.pose["capture_us"] or 0) + self.utc_offset_us) % 2**32

    def _lacks_value(self) -> bool:
        """Whether a value is missing, except protection levels of axes without an alert limit."""
        assert self.pose is not None
        return any(value is None for name, value in self.pose.items()
                   if name not in LEVELS or getattr(self.limits, name) != 0)

    def _is_beyond_limit(self) -> bool:
        """No level is beyond a limit of 0; each is beyond one that is negative or not a number."""
        assert self.pose is not None
        for name in LEVELS:
            limit, level = getattr(self.limits, name), self.pose[name]
            if limit != 0 and not (level is not None and level <= limit):
                return True
        exponent = self.pose["risk_exponent"]
        return exponent is None or exponent < self.limits.risk_exponent

    def _check(self, name: str, data: bytes) -> bool:
        message = MESSAGES[name]
        if len(data) != message.length:
            self.counters.wrong_length += 1
            return False
        if not has_right_crc(message, data):
            self.counters.wrong_crc += 1
            return False
        counter = data[2] if message.is_fd else data[1] & 0x0F
        last = self._last_counter.get(name)
        if counter == last:
            self.counters.repeated += 1
            return False
        if last is not None:
            self.counters.lost += (counter - last - 1) % (256 if message.is_fd else 16)
        self._last_counter[name] = counter
        self.counters.ok += 1
        return True

    def _take_status(self, data: bytes, time_s: float) -> None:
        def name_of(signal: str, unknown: str) -> str:
            value = decode(data, MESSAGES["LOC_Status"].signals[signal])
            names = VALUE_NAMES[f"LOC_Status.{signal}"]
            return unknown if value is None else names.get(int(value), unknown)

        self.state = name_of("State", "FAULT")
        self.time_source = name_of("TimeSource", "FREE_RUNNING")
        map_id = decode(data, MESSAGES["LOC_Status"].signals["MapId"])
        self.map_id = None if map_id is None else int(map_id)
        self.status_reasons = reasons_in("LOC_Status", data)
        self.status_time_s = time_s

    def _take_clock(self, data: bytes, time_s: float) -> None:
        signals = MESSAGES["LOC_Clock"].signals
        offset_us = decode(data, signals["UtcOffset"])
        self.utc_offset_us = None if offset_us is None else int(offset_us)
        self.utc_error_ms = decode(data, signals["UtcError"])
        self.clock_time_s = time_s

    def _take_part(self, name: str, data: bytes, time_s: float) -> bool:
        epoch = data[1] >> 4
        in_time = is_fresh(time_s, self._epoch_time_s, EPOCH_LIMIT_S, "LOC_Time")
        if epoch != self._epoch or not in_time or name in self._frames:
            self.counters.incomplete += 1 if self._frames else 0
            self._frames = {}
            self._epoch = epoch
            self._epoch_time_s = time_s
        self._frames[name] = data
        if len(self._frames) < len(PARTS):
            return False
        self._take_pose(time_s)
        self._frames = {}
        return True

    def _take_solution(self, data: bytes, time_s: float) -> bool:
        """Takes LOC_Solution apart into the contents of the classic messages."""
        def part(name: str) -> bytes:
            message = MESSAGES[name]
            first = message.fd_first_byte
            return bytes(2) + data[first : first + message.length - 2]

        self._take_status(part("LOC_Status"), time_s)
        self._frames = {name: part(name) for name in PARTS}
        self._take_pose(time_s)
        self._frames = {}
        return True

    def _take_pose(self, time_s: float) -> None:
        # When the bus returns after a failure, the first pose may be an old one that waited in the
        # sender's controller. At most one can wait.
        in_time = is_in_time(time_s, self.pose_time_s, "LOC_Time")
        self.pose_follows_silence = self.pose is None or not in_time
        self.pose = {
            value: decode(self._frames[name], MESSAGES[name].signals[signal])
            for value, (name, signal) in VALUES.items()
        }
        self.pose_reasons = reasons_in("LOC_Integrity", self._frames["LOC_Integrity"])
        self.pose_time_s = time_s


class Printer:
    """Prints each change of the answer, and a pose a second."""

    def __init__(self, receiver: Receiver) -> None:
        self.receiver = receiver
        self.first_s: float | None = None
        self.answer: str | None = None
        self.next_s = 0.0

    def take(self, frame: Frame) -> None:
        if self.answer is not None:
            self.look(frame.now_s)
        self.receiver.receive(frame.identifier, frame.data, frame.arrival_s)
        self.look(frame.now_s)

    def look(self, time_s: float) -> None:
        if self.first_s is None:
            self.first_s = time_s
        answer = self.receiver.answer(time_s)
        is_due = answer == "usable" and time_s >= self.next_s - HALF_MICROSECOND_S
        if answer == self.answer and not is_due:
            return
        line = f"{time_s - self.first_s:.3f} {answer}"
        if answer == "usable" and self.receiver.pose is not None:
            pose = self.receiver.pose
            values = {name.rsplit("_", 1)[0]: pose[name] for name in (
                "east_m", "north_m", "heading_deg", "lateral_m", "longitudinal_m", "yaw_deg")}
            line += "".join(f" {name} {value:.2f}" for name, value in values.items())
        print(line)
        self.answer = answer
        self.next_s = time_s + 1.0

    def print_counters(self) -> None:
        counters = self.receiver.counters
        print(f"frames: {counters.ok} ok, {counters.lost} lost, {counters.repeated} repeated, "
              f"{counters.wrong_crc} wrong CRC, {counters.wrong_length} wrong length; "
              f"{counters.incomplete} incomplete poses")


def show(printer: Printer, frames: Iterator[Frame | float]) -> int:
    """Prints until the frames end. Returns the exit status."""
    try:
        for frame in frames:
            if isinstance(frame, float):
                printer.look(frame)
            else:
                printer.take(frame)
    except KeyboardInterrupt:
        pass
    except BusError as error:
        printer.print_counters()
        print(error, file=sys.stderr)
        return 2
    except LogError as error:
        print(error, file=sys.stderr)
        return 1
    printer.print_counters()
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(description="Prints bevloc's pose and whether it may be used.")
    parser.add_argument("log", nargs="?", help="a candump log")
    parser.add_argument("--interface", default="socketcan", help="interface of python-can")
    parser.add_argument("--channel", help="channel of the interface, such as can0")
    arguments = parser.parse_args()
    if (arguments.log is None) == (arguments.channel is None):
        parser.error("found no source or two, wanted a log or --channel")
    sys.stdout.reconfigure(line_buffering=True)
    freeway = AlertLimits(lateral_m=0.57, longitudinal_m=1.40, yaw_deg=1.50)
    frames = (frames_of_log(arguments.log) if arguments.log is not None
              else frames_of_bus(arguments.interface, arguments.channel))
    try:
        return show(Printer(Receiver(freeway)), frames)
    except BrokenPipeError:
        print("standard output: found a closed pipe, wanted a reader", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what is left
        return 2


if __name__ == "__main__":
    sys.exit(main())
