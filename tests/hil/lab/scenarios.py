"""The scenarios: what the lab does to the daemon, and what it must see."""

import dataclasses
import math
from collections.abc import Callable

from tests.hil.lab import bring_up, conformance, devices, drives, tools
from tests.hil.lab.bench import IGNITION_PULL, Run
from tests.hil.lab.outcome import Outcome

# Requirement: time from a hang to the next READY. After a crash it is shorter by WatchdogSec.
READY_AFTER_HANG_S = 5.0
READY_AFTER_CRASH_S = 3.0
# Requirement: time until a running daemon sends again after the bus has returned.
BACK_ON_BUS_S = 1.0
SETTLE_S = 4.0


def sigstop(run: Run) -> Outcome:
    return _restart(run, "SIGSTOP", READY_AFTER_HANG_S)


def kill(run: Run) -> Outcome:
    return _restart(run, "SIGKILL", READY_AFTER_CRASH_S)


def _restart(run: Run, signal: str, limit_s: float) -> Outcome:
    """systemd must restart the daemon, which must send again."""
    start_s = run.start_daemon()
    run.agent.check(f"sleep {SETTLE_S}")
    restarts, pid = int(run.show("NRestarts")), run.show("MainPID")
    injected_s = run.wall_s()
    run.agent.check(f"kill -{signal[3:]} {pid}")
    ready_s = run.wait_restarted(restarts, timeout_s=600) - injected_s
    run.agent.check(f"sleep {SETTLE_S}")
    end_s = run.wall_s()
    log = run.finish_log()
    sends_again = log.localizer_after(injected_s + ready_s) is not None
    silence_s = log.longest_silence_s(injected_s, end_s) if sends_again else math.inf
    return Outcome(
        injected=f"{signal} to the daemon (a start takes {start_s:.1f} s here)",
        seen=f"READY again after {ready_s:.2f} s, bus silent for {silence_s:.2f} s",
        recovery_s=silence_s,
        passed=max(ready_s, silence_s) < limit_s,
    )


def _start_settled(run: Run) -> str:
    """Starts the daemon, waits a little and returns its process id."""
    run.start_daemon()
    run.agent.check(f"sleep {SETTLE_S}")
    return run.show("MainPID")


def can_down(run: Run) -> Outcome:
    pid = _start_settled(run)
    down_s = float(run.agent.check("set -e; ip link set vcan0 down; date +%s.%N; sleep 3"))
    up_s = run.wall_s()
    run.agent.check(f"ip link set vcan0 up; sleep {SETTLE_S}")
    same_daemon = run.show("MainPID") == pid
    log = run.finish_log()
    back_s = log.localizer_after(up_s)
    recovery_s = back_s - up_s if back_s else None
    silent = log.localizer_after(down_s) == back_s
    return Outcome(
        injected="vcan0 down for 3 s",
        seen=("the same daemon sends again" if same_daemon else "another daemon sends")
        + ("" if silent else ", but it also sent MEANWHILE"),
        recovery_s=recovery_s,
        passed=same_daemon and silent and recovery_s is not None and recovery_s < BACK_ON_BUS_S,
    )


def can_flood(run: Run) -> Outcome:
    """Random frames with a foreign identifier, and forged ones with the vehicle's identifiers."""
    pid = _start_settled(run)
    begin_s = run.wall_s()
    run.agent.run(
        "timeout 5 cangen vcan0 -g 0.2 -I 7A0 -L 8 -D r -i & "
        "timeout 5 cangen vcan0 -g 2 -I 400 -L 6 -D r -i & wait"
    )
    end_s = run.wall_s()
    run.agent.check(f"sleep {SETTLE_S}")
    same_daemon = run.show("MainPID") == pid
    log = run.finish_log()
    during = [f for f in log.named("LOC_Status") if begin_s < f.time_s < end_s]
    after_s = log.localizer_after(end_s)
    return Outcome(
        injected=f"5 s of foreign and forged frames ({log.damaged} forged ones seen)",
        seen=f"{len(during)} status frames meanwhile, {'same' if same_daemon else 'new'} daemon",
        recovery_s=after_s - end_s if after_s else None,
        passed=log.longest_silence_s(begin_s, end_s) < BACK_ON_BUS_S
        and same_daemon
        and after_s is not None
        and log.damaged > 0,
    )


def clock_step(run: Run) -> Outcome:
    """The system clock jumps one hour ahead. The daemon must not notice."""
    pid, step_s = _start_settled(run), 3600
    before_s = run.wall_s()
    run.agent.check(f"date -s '+{step_s} seconds'; sleep {SETTLE_S}; date -s '-{step_s} seconds'")
    run.agent.check(f"sleep {SETTLE_S}")
    same_daemon = run.show("MainPID") == pid
    log = run.finish_log()
    stepped = [f for f in log.named("LOC_Status") if f.time_s > before_s + step_s - 1.0]
    return Outcome(
        injected="system clock one hour ahead, and back",
        seen=f"{len(stepped)} status frames in that hour, "
        f"{'same' if same_daemon else 'new'} daemon",
        recovery_s=None,
        passed=same_daemon and len(stepped) > 2,
    )


def ignition_off(run: Run) -> Outcome:
    """The daemon must wait in standby, and localize again when the ignition returns."""
    pid = _start_settled(run)
    off_s = run.wall_s()
    run.agent.check(f"echo pull-down >{IGNITION_PULL}")
    standby = run.wait_for("StatusText", "standby: ignition off", timeout_s=60)
    standby_s = run.wall_s() - off_s
    run.agent.check(f"sleep {SETTLE_S}; echo pull-up >{IGNITION_PULL}")
    on_s = run.wall_s()
    run.agent.check(f"sleep {3 * SETTLE_S}")
    same_daemon = run.show("MainPID") == pid and run.show("ActiveState") == "active"
    back_s = run.finish_log().localizer_after(on_s)
    return Outcome(
        injected="ignition line low, and high again",
        seen=f"{'standby' if standby else 'NO standby'} after {standby_s:.2f} s, then "
        f"{'the same' if same_daemon else 'ANOTHER'} daemon",
        recovery_s=back_s - on_s if back_s else None,
        passed=standby and same_daemon and back_s is not None,
    )


def upgrade(run: Run) -> Outcome:
    """An upgrade by apt must start a running daemon again, and a removal must stop it."""
    pid = _start_settled(run)
    run.agent.check("apt-get install -y -qq --reinstall /packages/bevloc_*.deb")
    run.agent.check(f"sleep {SETTLE_S}")
    started_again = run.show("ActiveState") == "active" and run.show("MainPID") != pid
    run.agent.check("apt-get remove -y -qq bevloc")
    stopped = run.show("ActiveState") != "active"
    run.agent.check("apt-get install -y -qq /packages/*.deb")
    return Outcome(
        injected="the package installed again, then removed",
        seen=f"{'another' if started_again else 'NO other'} daemon, then "
        f"{'none' if stopped else 'STILL one'}",
        recovery_s=None,
        passed=started_again and stopped,
    )


@dataclasses.dataclass(frozen=True)
class Scenario:
    play: Callable[[Run], Outcome]
    needs_usb: bool  # the daemon must use the emulated cameras


SCENARIOS = {
    "devices": Scenario(devices.devices, needs_usb=False),
    "conformance": Scenario(conformance.conformance, needs_usb=False),
    "tools": Scenario(tools.tools, needs_usb=True),
    "bring-up": Scenario(bring_up.bring_up, needs_usb=True),
    "drive": Scenario(drives.drive, needs_usb=True),
    "unplug-camera": Scenario(drives.unplug_camera, needs_usb=True),
    "freeze-camera": Scenario(drives.freeze_camera, needs_usb=True),
    "camera-garbage": Scenario(drives.camera_garbage, needs_usb=True),
    "no-cameras-at-start": Scenario(drives.no_cameras_at_start, needs_usb=True),
    "can-down": Scenario(can_down, needs_usb=False),
    "can-flood": Scenario(can_flood, needs_usb=False),
    "sigstop": Scenario(sigstop, needs_usb=False),
    "kill": Scenario(kill, needs_usb=False),
    "clock-step": Scenario(clock_step, needs_usb=False),
    "ignition-off": Scenario(ignition_off, needs_usb=True),
    "upgrade": Scenario(upgrade, needs_usb=True),
}
