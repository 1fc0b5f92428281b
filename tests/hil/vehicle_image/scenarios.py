"""Scenarios with the vehicle's disk: its start, power cuts, updates, and a kernel panic."""

import pathlib
import random
import statistics
from collections.abc import Callable

from tests.hil.lab.agent import GuestRestarted, LabError
from tests.hil.lab.bench import drive_start_of
from tests.hil.lab.drives import judge_poses
from tests.hil.lab.judge import BusLog, Truth
from tests.hil.lab.outcome import Outcome
from tests.hil.vehicle_image.machine import Machine, Parts
from tests.hil.vehicle_image.repository import Repositories
from tests.hil.vehicle_image.stored import Stored, check_nothing_lost, read_stored

DBC = pathlib.Path("can/bevloc.dbc")
STARTS = 5
# Prints the processor's counter and the wall clock of the same moment. The counter is 0 at power on
# and grows by 10^9 in one second of the guest's clock.
_CLOCKS = """
    cd /sys/kernel/tracing
    echo x86-tsc >trace_clock
    echo now >trace_marker
    echo $(sed -n 's/.* \\([0-9]*\\): tracing_mark_write: now/\\1/p' trace) $(date +%s.%N)
"""
_TICKS_PER_S = 1e9
_DRIVE_TIMEOUT_S = 900.0
_DRIVE_ENDED = "[ $(systemctl show lab-vehicle --value -p ActiveState) = inactive ]"
# Files that were there before this start.
_SETTLED = """
    started=$(sed -n 's/^btime //p' /proc/stat)
    cd /var/lib/bevloc && find . -type f ! -newermt @$started -printf '%s %P\\n'
"""


def start(parts: Parts, _: int, __: int) -> Outcome:
    """Power on until the first valid pose, five times; the poses of a whole drive are judged."""
    times_s = []
    passed, judged = True, ""
    for index in range(STARTS):
        with Machine(parts, f"start-{index}") as machine:
            machine.wait_for_tracking()
            if index == 0:
                passed, judged = _judge_drive(machine)
            times_s.append(_first_valid_pose_s(machine))
        print(f"lab: first valid pose {times_s[-1]:.1f} s after power on", flush=True)
    return Outcome(
        injected=f"power on, {STARTS} times",
        seen=f"first valid pose after {min(times_s):.1f} to {max(times_s):.1f} s; {judged}",
        recovery_s=statistics.median(times_s),
        passed=passed,
    )


def power_cuts(parts: Parts, cuts: int, seed: int) -> Outcome:
    """Cuts the power at random moments. The next start must reach TRACKING, with nothing lost."""
    random_moment = random.Random(seed)
    with Machine(parts, "first") as machine:
        usual_s = machine.wait_for_tracking()
        # The daemon stores what it has learned when it ends.
        machine.agent.check("systemctl restart bevlocd")
    before = read_stored(parts.disk)
    if not before.learned:
        raise LabError("calibration.yaml: found none, wanted what the daemon has learned")
    settled: dict[str, int] = {}
    starts_s = []
    for index in range(cuts):
        cut_s = random_moment.uniform(0.0, 1.3 * usual_s)
        with Machine(parts, f"cut-{index}") as machine:
            machine.run_until(cut_s)
        _check(parts, before, settled)
        with Machine(parts, f"after-{index}") as machine:
            starts_s.append(machine.wait_for_tracking())
            settled = _sizes(machine.agent.check(_SETTLED))
            machine.run_until(starts_s[-1] + random_moment.uniform(0.0, 10.0))
        _check(parts, before, settled)
        usual_s = statistics.median(starts_s)
        print(
            f"lab: cut {index + 1} of {cuts} after {cut_s:.1f} s, then TRACKING after "
            f"{starts_s[-1]:.1f} s of the host, {len(settled)} files kept",
            flush=True,
        )
    return Outcome(
        injected=f"{cuts} power cuts at random moments of a start, and {cuts} while TRACKING",
        seen=f"TRACKING after each of {cuts}; root, configuration and stored files unchanged",
        recovery_s=None,
        passed=True,
    )


def update(parts: Parts, _: int, __: int) -> Outcome:
    """A good version is kept; a version whose daemon does not run is replaced by the one before."""
    seen = []
    with Machine(parts, "update") as machine:
        machine.wait_for_tracking()
        _mount_repositories(machine)
        for name in (Repositories.GOOD, Repositories.BAD):
            print(machine.agent.check(f"bevloc-update file:/run/repositories/{name}"), flush=True)
            _refuse(machine, name, "waits for a restart")
            machine.restart()
            trials = _await_verdict(machine)
            machine.wait_for_tracking()
            root, version = machine.started_root(), _version(machine)
            seen.append(f"{name}: root {root} with {version} after {trials} starts")
            print(f"lab: {seen[-1]}", flush=True)
            if root != "b" or version != Repositories.GOOD_VERSION:
                raise LabError(f"{seen[-1]}, wanted root b with {Repositories.GOOD_VERSION}")
            _mount_repositories(machine)
            _refuse(machine, "none", "found no apt repository")
            _refuse(machine, Repositories.GOOD, "found no packages that are newer")
        _refuse(machine, Repositories.BAD, f"{Repositories.BAD_VERSION} failed its trial")
    return Outcome(
        injected="updates: a good one, it again, an unreadable one, one whose daemon does not run, "
        "it again",
        seen="; ".join(seen),
        recovery_s=None,
        passed=True,
    )


def panic(parts: Parts, _: int, __: int) -> Outcome:
    """A kernel panic restarts the machine; systemd feeds the machine's watchdog."""
    with Machine(parts, "panic") as machine:
        machine.wait_for_tracking()
        engaged = machine.agent.check("systemctl show --value -p RuntimeWatchdogUSec").strip()
        restarted = False
        try:
            machine.agent.run("echo c >/proc/sysrq-trigger")
        except GuestRestarted:
            restarted = True
        machine.wait_for_tracking()
    return Outcome(
        injected="a kernel panic",
        seen=f"TRACKING again; systemd feeds the watchdog of the machine ({engaged})",
        recovery_s=None,
        passed=engaged == "30s" and restarted,
    )


SCENARIOS: dict[str, Callable[[Parts, int, int], Outcome]] = {
    "start": start,
    "power-cuts": power_cuts,
    "update": update,
    "panic": panic,
}


def _first_valid_pose_s(machine: Machine) -> float:
    """Returns the time from power on to the first valid pose, on the guest's clock."""
    ticks, wall_s = map(float, machine.agent.check(_CLOCKS).split())
    powered_wall_s = wall_s - ticks / _TICKS_PER_S
    return _bus_log(machine).valid_poses()[0].time_s - powered_wall_s


def _bus_log(machine: Machine) -> BusLog:
    file = machine.folder / "candump.log"
    file.write_text(machine.agent.check("cat /run/candump.log"), encoding="ascii")
    return BusLog(file, DBC)


def _judge_drive(machine: Machine) -> tuple[bool, str]:
    machine.agent.check(f"until {_DRIVE_ENDED}; do sleep 1; done", timeout_s=_DRIVE_TIMEOUT_S)
    drive_start = drive_start_of(machine.agent.check("cat /run/vehicle.log"))
    truth = Truth(machine.parts.pictures / "truth.csv")
    return judge_poses(truth.errors_of(_bus_log(machine).valid_poses(), drive_start.wall_s))


def _check(parts: Parts, before: Stored, settled: dict[str, int]) -> None:
    check_nothing_lost(before, read_stored(parts.disk), settled)


def _sizes(listing: str) -> dict[str, int]:
    lines = (line.split(maxsplit=1) for line in listing.splitlines())
    return {name: int(size) for size, name in lines}


def _refuse(machine: Machine, repository: str, reason: str) -> None:
    """An update that must not be made is refused for this reason, and leaves all as it is."""
    entries = "ls /efi/loader/entries"
    before = machine.agent.check(entries)
    reply = machine.agent.run(f"bevloc-update file:/run/repositories/{repository}")
    if reply.status == 0 or reason not in reply.output:
        raise LabError(f"bevloc-update {repository}: found '{reply.output}', wanted '{reason}'")
    if (after := machine.agent.check(entries)) != before:
        raise LabError(f"/efi/loader/entries: found {after} after a failure, wanted {before}")


def _mount_repositories(machine: Machine) -> None:
    machine.agent.check(
        """
        modprobe -a 9pnet_virtio 9p
        mkdir -p /run/repositories
        mountpoint -q /run/repositories ||
          mount -t 9p -o trans=virtio,version=9p2000.L,ro repositories /run/repositories
        """
    )


def _version(machine: Machine) -> str:
    return machine.agent.check("dpkg-query -W -f '${Version}' bevloc")


def _await_verdict(machine: Machine) -> int:
    """Waits until no version is on trial, and returns the number of starts that it took."""
    starts = 1
    while True:
        try:
            machine.agent.check(
                "until systemctl is-active --quiet bevloc-healthy; do sleep 1; done; "
                "while ls /efi/loader/entries/*+[1-9]*.conf 2>/dev/null; do sleep 1; done"
            )
            return starts
        except GuestRestarted:
            starts += 1
