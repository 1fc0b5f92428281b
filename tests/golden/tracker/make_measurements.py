#!/usr/bin/python3
"""Writes measurements.csv, the input of the tracker replay: run it from this folder.

A vehicle drives 40 s along a winding road. Odometry comes at 20 Hz, GNSS at 5 Hz, corrections at
5 Hz and 0.15 s late. Some measurements are wrong on purpose: GNSS jumps by 8 m for 2 s, corrections
are off by a lane for 1 s, odometry is missing for 1 s, single values are NaN, absurd or out of
order.
"""

from __future__ import annotations

import csv
import math
import random
from dataclasses import dataclass

DURATION_S = 40.0
STEP_S = 0.05
LATE_S = 0.15
HEAD = [
    *("kind", "time_s", "speed_mps", "yaw_rate_radps"),
    *("x_m", "y_m", "yaw_rad", "sigma_m", "yaw_sigma_rad"),
]


@dataclass
class Pose:
    x_m: float = 100.0
    y_m: float = -50.0
    yaw_rad: float = 0.4


def speed_mps(time_s: float) -> float:
    return 12.0 + 4.0 * math.sin(0.2 * time_s)


def yaw_rate_radps(time_s: float) -> float:
    return 0.15 * math.sin(0.31 * time_s)


def drive() -> list[Pose]:
    """The pose at every step, integrated in steps of 1 ms."""
    pose = Pose()
    poses = [Pose(pose.x_m, pose.y_m, pose.yaw_rad)]
    fine = 50
    for step in range(round(DURATION_S / STEP_S)):
        for k in range(fine):
            time_s = (step + (k + 0.5) / fine) * STEP_S
            pose.yaw_rad += yaw_rate_radps(time_s) * STEP_S / fine
            pose.x_m += speed_mps(time_s) * math.cos(pose.yaw_rad) * STEP_S / fine
            pose.y_m += speed_mps(time_s) * math.sin(pose.yaw_rad) * STEP_S / fine
        poses.append(Pose(pose.x_m, pose.y_m, pose.yaw_rad))
    return poses


def row(kind: str, time_s: float, *values: float) -> list[str]:
    motion = [f"{value:.6f}" for value in values] if kind == "odometry" else ["", ""]
    pose = [f"{value:.6f}" for value in values] if kind != "odometry" else [""] * 5
    return [kind, f"{time_s:.3f}", *motion, *pose]


def measured(
    pose: Pose, noise: random.Random, sigma_m: float, yaw_sigma_rad: float, off_m: float
) -> list[float]:
    """A noisy reading of the pose, moved to its left by `off_m`."""
    x_m = pose.x_m - math.sin(pose.yaw_rad) * off_m + noise.gauss(0.0, sigma_m)
    y_m = pose.y_m + math.cos(pose.yaw_rad) * off_m + noise.gauss(0.0, sigma_m)
    return [x_m, y_m, pose.yaw_rad + noise.gauss(0.0, yaw_sigma_rad), sigma_m, yaw_sigma_rad]


def measurements() -> list[list[str]]:
    noise = random.Random(7)
    poses = drive()
    rows = []
    for step in range(len(poses)):
        time_s = step * STEP_S
        if not 25.0 <= time_s < 26.0:
            yaw_rate = yaw_rate_radps(time_s) + 0.004 + noise.gauss(0.0, 0.005)
            rows.append(row("odometry", time_s, speed_mps(time_s) / 1.015, yaw_rate))
        if step % 4 == 0:
            jump_m = 8.0 if 15.0 <= time_s < 17.0 else 0.0
            rows.append(row("gnss", time_s, *measured(poses[step], noise, 1.0, 0.02, jump_m)))
        late = step - round(LATE_S / STEP_S)
        if late >= 0 and late % 4 == 2:
            lane_m = 3.5 if 20.0 <= time_s < 21.0 else 0.0
            reading = measured(poses[late], noise, 0.1, 0.004, lane_m)
            rows.append(row("correction", late * STEP_S, *reading))
        if step == 600:
            rows.append(row("odometry", time_s, math.nan, 0.0))
            rows.append(row("odometry", time_s + 0.01, 300.0, 0.0))
            rows.append(row("odometry", time_s - 1.0, 10.0, 0.0))
            rows.append(row("gnss", time_s, math.nan, 0.0, 0.0, 1.0, 0.02))
            old = measured(poses[400], noise, 0.1, 0.004, 0.0)
            rows.append(row("correction", time_s - 10.0, *old))
    return rows


def main() -> None:
    with open("measurements.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEAD)
        writer.writerows(measurements())


if __name__ == "__main__":
    main()
