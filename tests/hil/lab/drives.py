"""Scenarios with the emulated cameras: what they show is a drive, whose truth the judge knows."""

import dataclasses
import math
import re

from tests.hil.lab.agent import LabError
from tests.hil.lab.bench import CAMERA_PERIOD_S, Run
from tests.hil.lab.cameras import BROKEN_CAMERA, NAMES
from tests.hil.lab.judge import BusLog, PoseError, Truth, quantile
from tests.hil.lab.outcome import Outcome

DRIVE_TIMEOUT_S = 900.0
TRACKING_TIMEOUT_S = 300.0
SETTLED_AFTER_S = 10.0
MAX_MISSED_SETS = 3
# Three repetitions (FrozenPictures), and one set may be under way when the fault begins.
MAX_FROZEN_SETS = 4
ALL_BACK_WITHIN_S = 2.0
MAX_RESIDENT_MIB = 120
# Mean absolute errors that the mock drive is held to (tests/integration/drive_test.cpp).
MAX_LONGITUDINAL_M, MAX_LATERAL_M, MAX_YAW_DEG = 0.5, 0.25, 0.6
# What no valid pose may be off by: alert limits of a freeway (Reid et al. 2019).
ALERT = PoseError(1.40, 0.57, 1.50)
# The daemon's last words; frames under way count as nothing.
_ACCOUNT = re.compile(
    r"(\d+) frames captured, (\d+) used, \d+ dropped \((\d+) for newer ones, "
    r"(\d+) without a set, (\d+) in skipped sets, \d+ under way\); (\d+) more missed"
)
BROKEN_SIGNAL = "CameraOk_" + NAMES[BROKEN_CAMERA].title().replace("_", "")


def drive(run: Run) -> Outcome:
    run.start_daemon()
    run.start_vehicle()
    if not _vehicle_ended(run):
        raise LabError("the drive did not end")
    resident_mib = _resident_mib(run)
    run.agent.check("systemctl stop bevlocd")
    log = run.finish_log()
    errors = _errors(run, log)
    passed, judged = _judge(errors)
    balanced, frames = _frames_balance(run)
    return Outcome(
        injected="nothing: a drive with six USB cameras",
        seen=f"{' -> '.join(log.states())}; {judged}; {frames}; {resident_mib:.0f} MiB resident",
        recovery_s=None,
        passed=passed and balanced and resident_mib <= MAX_RESIDENT_MIB,
    )


def camera_garbage(run: Run) -> Outcome:
    """Garbage in one of six cameras must not become a wrong pose sent as valid."""
    _start_tracking(run)
    pid = run.show("MainPID")
    broken_s = run.wall_s()
    run.cameras.command(f"garbage {BROKEN_CAMERA}")
    run.agent.check("sleep 8")
    healed_s = run.wall_s()
    run.cameras.command(f"heal {BROKEN_CAMERA}")
    run.agent.check("sleep 4")
    same_daemon = run.show("MainPID") == pid
    log = run.finish_log()
    passed, judged = _judge(_errors(run, log))
    why = log.reasons(broken_s, healed_s)
    return Outcome(
        injected=f"noise and half frames from {NAMES[BROKEN_CAMERA]} for 8 s",
        seen=f"{', '.join(dict.fromkeys(log.states()))}; "
        f"the daemon said {', '.join(why) or 'nothing'}; "
        f"{judged}; {'same' if same_daemon else 'new'} daemon",
        recovery_s=None,
        passed=passed and same_daemon,
    )


def no_cameras_at_start(run: Run) -> Outcome:
    """Without cameras the daemon waits and says so; with them it works."""
    run.cameras.command("unplug all")
    run.agent.check("sleep 2")
    run.start_daemon()
    run.start_vehicle()
    run.agent.check("sleep 5")
    plugged_s = run.wall_s()
    run.cameras.command("plug all")
    tracking = run.wait_for("StatusText", "TRACKING", TRACKING_TIMEOUT_S)
    log = run.finish_log()
    missing_s = log.first_status(0.0, Why_CameraMissing="YES", State="INIT") or log.first_status(
        0.0, Why_CameraMissing="YES", State="ACQUIRING"
    )
    all_ok = {name: "OK" for name in _camera_signals(log)}
    back_s = log.first_status(plugged_s, **all_ok)
    return Outcome(
        injected="no camera at the start, all plugged in later",
        seen=f"missing cameras {'named' if missing_s else 'NOT named'}, then "
        f"{'TRACKING' if tracking else 'no tracking'}",
        recovery_s=back_s - plugged_s if back_s else None,
        passed=bool(missing_s and back_s and tracking),
    )


def unplug_camera(run: Run) -> Outcome:
    return _lose_camera(run, "unplug", "plug", MAX_MISSED_SETS)


def freeze_camera(run: Run) -> Outcome:
    """A camera that repeats one picture while the vehicle drives is as good as none."""
    outcome = _lose_camera(run, "freeze", "heal", MAX_FROZEN_SETS)
    says = f"camera {NAMES[BROKEN_CAMERA]}: its picture "
    journal = run.journal()
    named = f"{says}stands still" in journal and f"{says}changes again" in journal
    return dataclasses.replace(
        outcome,
        seen=f"{outcome.seen}; the log {'names' if named else 'does NOT name'} it",
        passed=outcome.passed and named,
    )


def _lose_camera(run: Run, fault: str, cure: str, max_sets: int) -> Outcome:
    """The daemon says which camera it has lost, goes on without it, and uses it again."""
    _start_tracking(run)
    broken_s = run.wall_s()
    run.cameras.command(f"{fault} {BROKEN_CAMERA}")
    run.agent.check("sleep 5")
    mended_s = run.wall_s()
    run.cameras.command(f"{cure} {BROKEN_CAMERA}")
    run.agent.check("sleep 8")
    log = run.finish_log()
    noticed_s = log.first_status(broken_s, **{BROKEN_SIGNAL: "MISSING"}, State="DEGRADED")
    all_ok = {name: "OK" for name in _camera_signals(log)}
    back_s = log.first_status(mended_s, **all_ok)
    tracking = log.first_status(mended_s, **all_ok, State="TRACKING") is not None
    passed, judged = _judge(_errors(run, log))
    sets = _sets_between(run, broken_s, noticed_s) if noticed_s else None
    noticed = (
        f"DEGRADED after {sets} sets, {noticed_s - broken_s:.2f} s" if noticed_s else "not noticed"
    )
    return Outcome(
        injected=f"{NAMES[BROKEN_CAMERA]}: {fault}, 5 s later {cure}",
        seen=f"{noticed}, then {'TRACKING' if tracking else 'no tracking'}; {judged}",
        recovery_s=back_s - mended_s if back_s else None,
        passed=passed
        and tracking
        and sets is not None
        and sets <= max_sets
        and back_s is not None
        and back_s - mended_s < ALL_BACK_WITHIN_S,
    )


def _sets_between(run: Run, begin_s: float, end_s: float) -> int:
    """How many sets were exposed in this time."""
    start_s = run.drive_start().wall_s
    first, last = (math.floor((t - start_s) / CAMERA_PERIOD_S) for t in (begin_s, end_s))
    return last - first


def _start_tracking(run: Run) -> None:
    """Until the pose is settled: with two sets a second the first seconds go back and forth."""
    run.start_daemon()
    run.start_vehicle()
    run.agent.check(f"sleep {SETTLED_AFTER_S}")
    if not run.wait_for("StatusText", "TRACKING", TRACKING_TIMEOUT_S):
        raise LabError(f"no tracking, the daemon says '{run.show('StatusText')}'")


def _vehicle_ended(run: Run) -> bool:
    script = "systemctl is-active --quiet vehicle || exit 0; sleep 1"
    ended = run.agent.run(f"for try in $(seq 900); do {script}; done; exit 1", DRIVE_TIMEOUT_S)
    return ended.status == 0


def _resident_mib(run: Run) -> float:
    """The most that the daemon has had in memory: its own, and what it has touched of libraries."""
    status = run.agent.check(f"grep VmHWM /proc/{run.show('MainPID')}/status")
    return int(re.search(r"(\d+) kB", status).group(1)) / 1024


def _errors(run: Run, log: BusLog) -> list[PoseError]:
    truth = Truth(run.bench.folders.pictures / "truth.csv")
    start_s = run.drive_start().wall_s
    errors = (truth.error_of(pose, start_s) for pose in log.valid_poses())
    return [error for error in errors if error]


def _judge(errors: list[PoseError]) -> tuple[bool, str]:
    if not errors:
        return False, "no valid pose"
    longitudinal = [error.longitudinal_m for error in errors]
    lateral = [error.lateral_m for error in errors]
    yaw = [error.yaw_deg for error in errors]
    means = [sum(map(abs, values)) / len(values) for values in (longitudinal, lateral, yaw)]
    worst = [quantile(values, 1.0) for values in (longitudinal, lateral, yaw)]
    limits = (ALERT.longitudinal_m, ALERT.lateral_m, ALERT.yaw_deg)
    passed = all(m < b for m, b in zip(means, (MAX_LONGITUDINAL_M, MAX_LATERAL_M, MAX_YAW_DEG)))
    safe = all(w < limit for w, limit in zip(worst, limits))
    text = (
        f"{len(errors)} valid poses, mean error {means[0]:.2f} m along, {means[1]:.2f} m across, "
        f"{means[2]:.2f} deg, worst {worst[0]:.2f}, {worst[1]:.2f}, {worst[2]:.2f}"
    )
    return passed and safe, text


def _frames_balance(run: Run) -> tuple[bool, str]:
    """Every frame that the cameras sent was used, or dropped and counted where that was done."""
    sent = run.frames_sent()
    found = _ACCOUNT.search(run.journal())
    if not found:
        return False, "the daemon gave no account of its frames"
    captured, used, *dropped, missed = map(int, found.groups())
    text = f"{sent} frames sent, {used} used, {sum(dropped)} dropped, {missed} missed"
    return sent == captured + missed and captured == used + sum(dropped), text


def _camera_signals(log: BusLog) -> list[str]:
    statuses = log.named("LOC_Status")
    return [name for name in statuses[0].values if name.startswith("CameraOk_")] if statuses else []
