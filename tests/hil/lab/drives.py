"""Scenarios with a drive, so that the judge can compare poses with the truth."""

import dataclasses
import math
import re

from tests.hil.lab.agent import LabError
from tests.hil.lab.bench import CAMERA_PERIOD_S, Run, last_match
from tests.hil.lab.cameras import BROKEN_CAMERA, NAMES
from tests.hil.lab.judge import BusLog, PoseError, Truth, quantile
from tests.hil.lab.outcome import Outcome

DRIVE_TIMEOUT_S = 900.0
TRACKING_TIMEOUT_S = 300.0
SETTLED_AFTER_S = 10.0
MAX_MISSED_FRAMESETS = 3
# Three repetitions until the camera counts as frozen; one frameset may be under way at the fault.
MAX_FROZEN_FRAMESETS = 4
ALL_BACK_WITHIN_S = 2.0
MAX_RESIDENT_MIB = 120
# The first valid pose comes by then. After it this share is valid, as in
# tests/integration/drive_test.cpp.
FIRST_VALID_S = 5.0
MIN_VALID_SHARE = 0.9
POSE_RATE_HZ = 100
DRIVE_S = 30.0  # as in DRIVE_CONFIG
# Limits of the mean absolute errors, as in tests/integration/drive_test.cpp.
MAX_LONGITUDINAL_M, MAX_LATERAL_M, MAX_YAW_DEG = 0.5, 0.25, 0.6
# Alert limits of a freeway (Reid et al. 2019). No valid pose may exceed them.
ALERT = PoseError(1.40, 0.57, 1.50)
# The daemon's frame counts at its end, without the frames under way.
_ACCOUNT = re.compile(
    r"(\d+) frames captured, (\d+) used, \d+ dropped \((\d+) displaced by newer frames, "
    r"(\d+) without a frameset, (\d+) in skipped framesets, \d+ under way\), "
    r"(\d+) missed by the cameras"
)
BROKEN_SIGNAL = "CameraOk_" + NAMES[BROKEN_CAMERA].title().replace("_", "")


def drive(run: Run) -> Outcome:
    run.start_daemon()
    run.start_vehicle()
    if not _vehicle_ended(run):
        raise LabError("vehicle_can: the drive did not end in time; see vehicle.log")
    resident_mib = _resident_mib(run)
    run.agent.check("systemctl stop bevlocd")
    log = run.finish_log()
    passed, judged = judge_poses(errors_of(run, log), DRIVE_S - FIRST_VALID_S)
    tracking = "TRACKING" in log.states()
    balanced, frames = _frames_balance(run)
    return Outcome(
        injected="nothing: a drive with six USB cameras",
        seen=f"{' -> '.join(log.states())}; {judged}; {frames}; {resident_mib:.0f} MiB resident",
        recovery_s=None,
        passed=passed and tracking and balanced and resident_mib <= MAX_RESIDENT_MIB,
    )


def camera_garbage(run: Run) -> Outcome:
    """Garbage from one of six cameras must not lead to a wrong valid pose."""
    _start_tracking(run)
    pid = run.show("MainPID")
    fault = _break_camera(run, "garbage", "heal", duration_s=8, settle_s=4)
    same_daemon = run.show("MainPID") == pid
    log = run.finish_log()
    passed, judged = judge_poses(errors_of(run, log), fault.valid_s)
    why = log.reasons(fault.begin_s, fault.end_s)
    # One good frame may have been under way when the garbage began.
    arrived = fault.frames > 1 and "Why_CameraMissing" in why
    return Outcome(
        injected=f"noise and half frames from {NAMES[BROKEN_CAMERA]} for 8 s ({fault.frames} sent)",
        seen=f"{', '.join(dict.fromkeys(log.states()))}; "
        f"why bits {', '.join(why) or 'none'}; "
        f"{judged}; {'same' if same_daemon else 'new'} daemon",
        recovery_s=None,
        passed=passed and arrived and same_daemon,
    )


def no_cameras_at_start(run: Run) -> Outcome:
    """The daemon starts without cameras, reports them, and tracks once they are plugged in."""
    run.cameras.command("unplug all")
    run.agent.check("sleep 2")
    run.start_daemon()
    run.start_vehicle()
    run.agent.check("sleep 5")
    plugged_s = run.wall_s()
    run.cameras.command("plug all")
    tracking = run.wait_for("StatusText", "TRACKING", TRACKING_TIMEOUT_S)
    log = run.finish_log()
    without = [frame.values for frame in log.named("LOC_Status") if frame.time_s < plugged_s]
    reported = any(
        values["Why_CameraMissing"] == "YES" and values["State"] in ("INIT", "ACQUIRING")
        for values in without
    )
    # Every start reports missing cameras in its first status. Here none may be there meanwhile.
    cameras = _camera_signals(log)
    seen = sorted({name for values in without for name in cameras if values[name] == "OK"})
    all_ok = {name: "OK" for name in cameras}
    back_s = log.first_status(plugged_s, **all_ok)
    return Outcome(
        injected="no camera at the start, all plugged in later",
        seen=f"missing cameras {'reported' if reported else 'NOT reported'}, "
        + (f"but {', '.join(seen)} before they were plugged in, " if seen else "")
        + f"then {'TRACKING' if tracking else 'no tracking'}",
        recovery_s=back_s - plugged_s if back_s else None,
        passed=bool(reported and not seen and back_s and tracking),
    )


def unplug_camera(run: Run) -> Outcome:
    return _lose_camera(run, "unplug", "plug", MAX_MISSED_FRAMESETS)


def freeze_camera(run: Run) -> Outcome:
    """A camera that repeats one image while the vehicle drives counts as missing."""
    outcome = _lose_camera(run, "freeze", "heal", MAX_FROZEN_FRAMESETS)
    camera = f"camera {NAMES[BROKEN_CAMERA]}: "
    journal = run.journal()
    named = f"{camera}frozen" in journal and f"{camera}no longer frozen" in journal
    return dataclasses.replace(
        outcome,
        seen=f"{outcome.seen}; the log {'names' if named else 'does NOT name'} it",
        passed=outcome.passed and named,
    )


@dataclasses.dataclass(frozen=True)
class Fault:
    """A fault of one camera."""

    begin_s: float  # wall time
    end_s: float
    frames: int  # sent by that camera meanwhile
    valid_s: float  # the time from FIRST_VALID_S to the end of the scenario


def _break_camera(run: Run, fault: str, cure: str, duration_s: int, settle_s: int) -> Fault:
    """Injects a fault into one camera for a while."""
    begin_s = run.wall_s()
    run.cameras.command(f"{fault} {BROKEN_CAMERA}")
    sent = run.cameras.sent_by(NAMES[BROKEN_CAMERA])
    run.agent.check(f"sleep {duration_s}")
    frames = run.cameras.sent_by(NAMES[BROKEN_CAMERA]) - sent
    end_s = run.wall_s()
    run.cameras.command(f"{cure} {BROKEN_CAMERA}")
    run.agent.check(f"sleep {settle_s}")
    return Fault(begin_s, end_s, frames, SETTLED_AFTER_S + duration_s + settle_s - FIRST_VALID_S)


def _lose_camera(run: Run, fault: str, cure: str, max_framesets: int) -> Outcome:
    """The daemon must report the missing camera, continue without it, and use it again."""
    _start_tracking(run)
    broken = _break_camera(run, fault, cure, duration_s=5, settle_s=8)
    log = run.finish_log()
    noticed_s = log.first_status(broken.begin_s, **{BROKEN_SIGNAL: "MISSING"}, State="DEGRADED")
    all_ok = {name: "OK" for name in _camera_signals(log)}
    back_s = log.first_status(broken.end_s, **all_ok)
    tracking = log.first_status(broken.end_s, **all_ok, State="TRACKING") is not None
    passed, judged = judge_poses(errors_of(run, log), broken.valid_s)
    framesets = _framesets_between(run, broken.begin_s, noticed_s) if noticed_s else None
    noticed = (
        f"DEGRADED after {framesets} framesets, {noticed_s - broken.begin_s:.2f} s"
        if noticed_s
        else "not noticed"
    )
    return Outcome(
        injected=f"{NAMES[BROKEN_CAMERA]}: {fault}, 5 s later {cure}",
        seen=f"{noticed}, then {'TRACKING' if tracking else 'no tracking'}; {judged}",
        recovery_s=back_s - broken.end_s if back_s else None,
        passed=passed
        and tracking
        and framesets is not None
        and framesets <= max_framesets
        and back_s is not None
        and back_s - broken.end_s < ALL_BACK_WITHIN_S,
    )


def _framesets_between(run: Run, begin_s: float, end_s: float) -> int:
    """Returns the number of framesets that were exposed in this time."""
    start_s = run.drive_start().wall_s
    first, last = (math.floor((t - start_s) / CAMERA_PERIOD_S) for t in (begin_s, end_s))
    return last - first


def _start_tracking(run: Run) -> None:
    """Starts daemon and vehicle, and waits for TRACKING after the unsettled first seconds."""
    run.start_daemon()
    run.start_vehicle()
    run.agent.check(f"sleep {SETTLED_AFTER_S}")
    if not run.wait_for("StatusText", "TRACKING", TRACKING_TIMEOUT_S):
        raise LabError(f"daemon: found status '{run.show('StatusText')}', wanted TRACKING")


def _vehicle_ended(run: Run) -> bool:
    script = "systemctl is-active --quiet vehicle || exit 0; sleep 1"
    ended = run.agent.run(f"for try in $(seq 900); do {script}; done; exit 1", DRIVE_TIMEOUT_S)
    return ended.status == 0


def _resident_mib(run: Run) -> float:
    """Returns the daemon's peak resident memory, including the used pages of libraries."""
    status = run.agent.check(f"grep VmHWM /proc/{run.show('MainPID')}/status")
    found = re.search(r"(\d+) kB", status)
    if not found:
        raise LabError(f"/proc/PID/status: found '{status}', wanted VmHWM in kB")
    return int(found[1]) / 1024


def errors_of(run: Run, log: BusLog) -> list[PoseError]:
    """Returns the errors of all valid poses of the drive."""
    truth = Truth(run.bench.folders.pictures / "truth.csv")
    return truth.errors_of(log.valid_poses(), run.drive_start().wall_s)


def judge_poses(errors: list[PoseError], valid_s: float) -> tuple[bool, str]:
    """Returns whether the errors are within the limits, and says what they are.

    `valid_s`: for so long the poses should have been valid.
    """
    if not errors:
        return False, "no valid pose"
    longitudinal = [error.longitudinal_m for error in errors]
    lateral = [error.lateral_m for error in errors]
    yaw = [error.yaw_deg for error in errors]
    means = [
        sum(abs(value) for value in values) / len(values)
        for values in (longitudinal, lateral, yaw)
    ]
    worst = [quantile(values, 1.0) for values in (longitudinal, lateral, yaw)]
    limits = (ALERT.longitudinal_m, ALERT.lateral_m, ALERT.yaw_deg)
    passed = all(m < b for m, b in zip(means, (MAX_LONGITUDINAL_M, MAX_LATERAL_M, MAX_YAW_DEG)))
    safe = all(w < limit for w, limit in zip(worst, limits))
    wanted = round(MIN_VALID_SHARE * POSE_RATE_HZ * valid_s)
    enough = len(errors) >= wanted
    text = (
        f"{len(errors)} valid poses{'' if enough else f' (wanted {wanted})'}, "
        f"mean error {means[0]:.2f} m along, {means[1]:.2f} m across, "
        f"{means[2]:.2f} deg, worst {worst[0]:.2f}, {worst[1]:.2f}, {worst[2]:.2f}"
    )
    return passed and safe and enough, text


def _frames_balance(run: Run) -> tuple[bool, str]:
    """Checks that every frame that the cameras sent was used, or dropped and counted."""
    sent = run.frames_sent()
    found = last_match(_ACCOUNT, run.journal())
    if not found:
        return False, "the daemon's log has no frame counts"
    captured, used, *dropped, missed = map(int, found.groups())
    text = f"{sent} frames sent, {used} used, {sum(dropped)} dropped, {missed} missed"
    return sent == captured + missed and captured == used + sum(dropped), text


def _camera_signals(log: BusLog) -> list[str]:
    statuses = log.named("LOC_Status")
    return [name for name in statuses[0].values if name.startswith("CameraOk_")] if statuses else []
