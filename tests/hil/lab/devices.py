"""Scenario that tests the lab: cameras, CAN and GPIO with Debian's tools, without the daemon."""

import pathlib
import re

from tests.hil.lab.bench import CAMERA_PERIOD_S, IGNITION_PULL, Run, chip_of
from tests.hil.lab.cameras import BROKEN_CAMERA, NAMES
from tests.hil.lab.outcome import Outcome

FRAMES = 6
FRAME_BYTES = 640 * 360 * 2


def devices(run: Run) -> Outcome:
    latencies_ms: list[float] = []
    replug_s: float | None = None
    replug_problems: list[str] = []
    problems = _formats(run) + _streams(run, latencies_ms)
    if not problems:
        replug_s, replug_problems = _replug(run)
    problems += replug_problems + _can(run) + _gpio(run)
    seen = "; ".join(problems) or (
        "every byte in order, frames timestamped "
        f"{min(latencies_ms):.0f} to {max(latencies_ms):.0f} ms after their exposure"
    )
    return Outcome(
        injected=f"{FRAMES} frames of six cameras, a camera unplugged, a CAN frame, GPIO edges",
        seen=seen,
        recovery_s=replug_s,
        passed=not problems,
    )


def device_of(name: str) -> str:
    """Returns the persistent path that udev makes from the camera's serial number."""
    return f"/dev/v4l/by-id/usb-bevloc_lab_camera_{name}_{name}-video-index0"


def _formats(run: Run) -> list[str]:
    run.agent.check(
        f"for try in $(seq 60); do test -e {device_of(NAMES[-1])} && break; sleep 1; done; "
        f"udevadm settle; v4l2-ctl --list-devices >{run.guest}/list-devices.txt; ls /dev/v4l/by-id "
        f">{run.guest}/by-id.txt"
    )
    output = run.agent.check(f"v4l2-ctl -d {device_of('front')} --list-formats-ext")
    (run.folder / "formats.txt").write_text(output)
    wanted = ["'YUYV'", "'MJPG'", "640x360", "1.000 fps", "2.000 fps", "5.000 fps", "10.000 fps"]
    return [f"formats: no {text}" for text in wanted if text not in output]


def _streams(run: Run, latencies_ms: list[float]) -> list[str]:
    """Streams from six cameras at once, on the vehicle's beat. The frames must show the images in
    order. Appends the delay from each exposure to its timestamp to `latencies_ms`."""
    captures = " ".join(
        f"timeout 120 v4l2-ctl -d {device_of(name)} --stream-mmap=4 --stream-count={FRAMES} "
        f"--stream-to=/tmp/{name}.yuyv --verbose >{run.guest}/{name}.txt 2>&1 &"
        for name in NAMES
    )
    run.start_vehicle()
    run.agent.check(f"{captures} wait; cp /tmp/*.yuyv {run.guest}/")
    run.agent.check("systemctl stop vehicle")
    start_s = run.drive_start().monotonic_s
    problems = []
    for name in NAMES:
        text = (run.folder / f"{name}.txt").read_text()
        stamps = [float(stamp) for stamp in re.findall(r"cap dqbuf.* ts: ([\d.]+)", text)]
        indices = _pictures_shown(run.folder / f"{name}.yuyv", run.bench.folders.pictures / name)
        steps = {b - a for a, b in zip(indices, indices[1:])}
        if len(stamps) != FRAMES or len(indices) != FRAMES or steps != {1}:
            problems.append(f"{name}: {len(stamps)} frames, images {indices}")
        latencies_ms += [
            1e3 * (stamp - start_s - index * CAMERA_PERIOD_S)
            for stamp, index in zip(stamps, indices)
        ]
    return problems


def _replug(run: Run) -> tuple[float | None, list[str]]:
    """Unplugs a camera and plugs it in again: the device must disappear and return by its name."""
    path = device_of(NAMES[BROKEN_CAMERA])
    run.cameras.command(f"unplug {BROKEN_CAMERA}")
    waits = "for try in $(seq 200); do {} && exit 0; sleep 0.05; done; exit 1"
    if run.agent.run(waits.format(f"test ! -e {path}")).status != 0:
        return None, ["replug: the device is still there after unplug"]
    begin_s = run.wall_s()
    run.cameras.command(f"plug {BROKEN_CAMERA}")
    if run.agent.run(waits.format(f"test -e {path}")).status != 0:
        return None, ["replug: no device after plug"]
    return run.wall_s() - begin_s, []


def _pictures_shown(capture: pathlib.Path, pictures: pathlib.Path) -> list[int]:
    """Returns the number of the image that each frame equals byte for byte; -1 for none."""
    known = {file.read_bytes(): int(file.stem) for file in pictures.glob("*.yuyv")}
    data = capture.read_bytes()
    starts = range(0, len(data), FRAME_BYTES)
    return [known.get(data[start : start + FRAME_BYTES], -1) for start in starts]


def _can(run: Run) -> list[str]:
    run.agent.check("cansend vcan0 123#DEADBEEF; sleep 1")
    run.stop_log()
    text = (run.folder / "candump.log").read_text()
    return [] if "123#DEADBEEF" in text else ["CAN: found no frame 123#DEADBEEF in the log"]


def _gpio(run: Run) -> list[str]:
    """Makes four edges on the ignition line, as a switch would."""
    output = run.agent.check(
        f"pull=$(echo {IGNITION_PULL}); "
        f"timeout 60 /lab/edges {chip_of('bevloc')} 3 --num-events=4 & sleep 2; "
        "for level in down up down up; do echo pull-$level >$pull; sleep 0.2; done; wait; "
        "gpioinfo"
    )
    (run.folder / "gpio.txt").write_text(output)
    rising = [kind == "1" for kind in re.findall(r"^(\d) \d+ \d+$", output, re.M)]
    wanted = [False, True] * 2
    problems = [] if rising == wanted else [f"GPIO: rising: found {rising}, wanted {wanted}"]
    names = ("trigger", "status", "fault", "ignition")
    return problems + [f"GPIO: no line {name}" for name in names if f'"{name}"' not in output]
