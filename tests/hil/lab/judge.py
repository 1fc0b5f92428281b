"""Judges the localizer from the bus log alone: its states, and the errors of its poses."""

import bisect
import csv
import dataclasses
import math
import pathlib
import re

from tests.hil.lab import dbc

VALID_STATES = ("TRACKING", "DEGRADED")
_LINE = re.compile(r"\((\d+\.\d+)\) \S+ ([0-9A-F]{3})#([0-9A-F]*)$")


@dataclasses.dataclass(frozen=True)
class Frame:
    time_s: float  # on candump's clock
    name: str
    values: dict[str, float | str | None]


@dataclasses.dataclass(frozen=True)
class Pose:
    time_s: float
    east_m: float
    north_m: float
    yaw_rad: float


@dataclasses.dataclass(frozen=True)
class PoseError:
    longitudinal_m: float
    lateral_m: float
    yaw_deg: float


class BusLog:
    """The intact frames of a candump log (`candump -L`) whose identifiers are in the DBC file."""

    def __init__(self, log: pathlib.Path, dbc_file: pathlib.Path) -> None:
        messages = dbc.read(dbc_file)
        self.frames: list[Frame] = []
        self.damaged = 0
        for line in log.read_text(encoding="ascii").splitlines():
            found = _LINE.match(line)
            message = messages.get(int(found[2], 16)) if found else None
            if not found or not message:
                continue
            data = bytes.fromhex(found[3])
            if message.is_intact(data):
                self.frames.append(Frame(float(found[1]), message.name, message.decode(data)))
            else:
                self.damaged += 1

    def named(self, name: str) -> list[Frame]:
        return [frame for frame in self.frames if frame.name == name]

    def localizer_after(self, time_s: float) -> float | None:
        """Returns the time of the localizer's first frame after `time_s`."""
        times = (f.time_s for f in self.frames if f.name.startswith("LOC_") and f.time_s > time_s)
        return next(times, None)

    def longest_silence_s(self, after_s: float, end_s: float) -> float:
        """Returns the longest silence of the localizer that ends after `after_s`.

        A silence may last until `end_s`, the end of the log. Without a frame before `after_s`, its
        begin is unknown, and it counts as infinite.
        """
        times = [f.time_s for f in self.frames if f.name.startswith("LOC_")]
        if not times or times[0] > after_s:
            return math.inf
        gaps = (b - a for a, b in zip(times, [*times[1:], end_s]) if b > after_s)
        return max(gaps, default=math.inf)

    def first_status(self, after_s: float, **wanted: str) -> float | None:
        """Returns the time of the first LOC_Status after `after_s` with these values."""
        for frame in self.named("LOC_Status"):
            if frame.time_s > after_s and wanted.items() <= frame.values.items():
                return frame.time_s
        return None

    def states(self) -> list[str]:
        """Returns the sequence of states, without repetitions."""
        states = [str(frame.values["State"]) for frame in self.named("LOC_Status")]
        return [state for i, state in enumerate(states) if i == 0 or states[i - 1] != state]

    def reasons(self, begin_s: float, end_s: float) -> list[str]:
        """Returns the Why_ signals that were set at any time between two times."""
        frames = self.named("LOC_Status") + self.named("LOC_Integrity")
        sent = (f.values for f in frames if begin_s < f.time_s < end_s)
        return sorted({name for values in sent for name, v in values.items() if v == "YES"})

    def valid_poses(self) -> list[Pose]:
        """Returns the poses of valid states: position and heading of the same epoch."""
        poses = []
        state, position = None, None
        for frame in self.frames:
            if frame.name == "LOC_Status":
                state = frame.values["State"]
            elif frame.name == "LOC_PosLocal":
                position = frame.values
            elif frame.name == "LOC_Attitude" and position and state in VALID_STATES:
                found = position["LocalEast"], position["LocalNorth"], frame.values["Heading"]
                available = [value for value in found if isinstance(value, float)]
                same = position["EPOCH"] == frame.values["EPOCH"]
                if same and len(available) == len(found):
                    east, north, heading = available
                    yaw_rad = math.radians(90.0 - heading)
                    poses.append(Pose(frame.time_s, east, north, yaw_rad))
        return poses


class Truth:
    """The true pose of the vehicle over the time of the drive."""

    def __init__(self, file: pathlib.Path) -> None:
        with open(file, newline="", encoding="ascii") as rows:
            self._rows = [tuple(map(float, row)) for row in list(csv.reader(rows))[1:]]
        self._times = [row[0] for row in self._rows]

    def error_of(self, pose: Pose, drive_start_s: float) -> PoseError | None:
        """Returns the error of a pose; None before the drive's start and after its end."""
        time_s = pose.time_s - drive_start_s
        after = bisect.bisect_right(self._times, time_s)
        if after == 0 or after == len(self._times):
            return None
        before, next_row = self._rows[after - 1], self._rows[after]
        share = (time_s - before[0]) / (next_row[0] - before[0])
        east_m, north_m = (before[i] + share * (next_row[i] - before[i]) for i in (1, 2))
        yaw_rad = before[3] + share * _wrapped(next_row[3] - before[3])
        d_east, d_north = pose.east_m - east_m, pose.north_m - north_m
        return PoseError(
            math.cos(yaw_rad) * d_east + math.sin(yaw_rad) * d_north,
            -math.sin(yaw_rad) * d_east + math.cos(yaw_rad) * d_north,
            math.degrees(_wrapped(pose.yaw_rad - yaw_rad)),
        )

    def errors_of(self, poses: list[Pose], drive_start_s: float) -> list[PoseError]:
        """Returns the errors of the poses during the drive."""
        errors = (self.error_of(pose, drive_start_s) for pose in poses)
        return [error for error in errors if error]


def quantile(values: list[float], share: float) -> float:
    """Quantile of the absolute values."""
    ordered = sorted(abs(value) for value in values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def _wrapped(angle_rad: float) -> float:
    return math.remainder(angle_rad, math.tau)
