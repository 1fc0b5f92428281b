"""Scenarios with the vehicle's disk: its start, power cuts, updates, and a kernel panic."""

import pathlib
import random
import statistics
import urllib.parse
from collections.abc import Callable

from tests.hil.lab.agent import GuestRestarted, LabError
from tests.hil.lab.bench import drive_start_of
from tests.hil.lab.drives import judge_poses
from tests.hil.lab.judge import BusLog, Truth
from tests.hil.lab.outcome import Outcome
from tests.hil.vehicle_image.machine import Machine, Parts
from tests.hil.vehicle_image.repository import Repositories
from tests.hil.vehicle_image.stored import Stored, StoredFile, check_nothing_lost, read_stored

DBC = pathlib.Path("can/bevloc.dbc")
STARTS = 5
# For so long the poses of the drive should be valid. While the system starts, the first is late.
VALID_S = 20.0
# As many as the bad starts that end a trial.
SHORT_STARTS = 3
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
# A minute in the guest can take ten on a busy host.
_UPDATE_TIMEOUT_S = 1800.0
_DRIVE_ENDED = "[ $(systemctl show lab-vehicle --value -p ActiveState) = inactive ]"
# Names of files that were there before this start.
_SETTLED = """
    started=$(sed -n 's/^btime //p' /proc/stat)
    cd /var/lib/bevloc && find . -type f ! -newermt @$started -printf '%P\\n'
"""
# What an update changes: the entries of the boot loader, and the file system of each root.
_STATE = """
    ls /efi/loader/entries
    for root in a b; do blkid -p -s UUID -o value /dev/disk/by-partlabel/bevloc-$root || true; done
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
    settled: dict[str, StoredFile] = {}
    starts_s = []
    for index in range(cuts):
        cut_s = random_moment.uniform(0.0, 1.3 * usual_s)
        with Machine(parts, f"cut-{index}") as machine:
            machine.run_until(cut_s)
        stored = _check(parts, before, settled)
        with Machine(parts, f"after-{index}") as machine:
            starts_s.append(machine.wait_for_tracking())
            names = machine.agent.check(_SETTLED).splitlines()
            settled = {name: stored.files[name] for name in names if name in stored.files}
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
    """A good version is kept, although the first starts of its trial end before the verdict.

    A version whose daemon does not run is replaced by the one before.
    """
    with Machine(parts, "update") as machine:
        machine.wait_for_tracking()
        _refuse_unreadable(machine)
        machine.agent.check("date -s '-1 hour'")  # the repositories are then of the future
        _install(machine, Repositories.GOOD)
    for index in range(SHORT_STARTS):
        with Machine(parts, f"short-{index}") as machine:
            _expect_trial(machine)
    with Machine(parts, "verdicts") as machine:
        seen = [_judge_trial(machine, Repositories.GOOD)]
        _install(machine, Repositories.BAD)
        machine.restart()
        seen.append(_judge_trial(machine, Repositories.BAD))
        _refuse(machine, Repositories.BAD, f"{Repositories.BAD_VERSION} failed its trial")
    return Outcome(
        injected="updates: unreadable ones, a good one with "
        f"{SHORT_STARTS} short starts, one whose daemon does not run, and each again",
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
    poses = _bus_log(machine).valid_poses()
    return judge_poses(truth.errors_of(poses, drive_start.wall_s), VALID_S)


def _check(parts: Parts, before: Stored, settled: dict[str, StoredFile]) -> Stored:
    after = read_stored(parts.disk)
    check_nothing_lost(before, after, settled)
    return after


def _uri(repository: str) -> str:
    return f"file:/run/repositories/{urllib.parse.quote(repository)}"


def _install(machine: Machine, repository: str) -> None:
    _mount_repositories(machine)
    print(machine.agent.check(f"bevloc-update {_uri(repository)}", _UPDATE_TIMEOUT_S), flush=True)
    _refuse(machine, repository, "waits for a restart")


def _expect_trial(machine: Machine) -> None:
    """The new version has started, and nothing has been found about it yet."""
    entries = machine.agent.check("ls /efi/loader/entries")
    if (root := machine.started_root()) != "b" or "bevloc-b+" not in entries:
        raise LabError(f"a short start: found root {root} and {entries}, wanted a trial of root b")


def _judge_trial(machine: Machine, repository: str) -> str:
    """After the trial of any version, the good one must run. Returns what was seen."""
    trials = _await_verdict(machine)
    machine.wait_for_tracking()
    root, version = machine.started_root(), _version(machine)
    seen = f"{repository}: root {root} with {version} after {trials} starts"
    print(f"lab: {seen}", flush=True)
    if root != "b" or version != Repositories.GOOD_VERSION:
        raise LabError(f"{seen}, wanted root b with {Repositories.GOOD_VERSION}")
    _refuse_unreadable(machine)
    _refuse(machine, Repositories.GOOD, "found no packages that are newer")
    return seen


def _refuse_unreadable(machine: Machine) -> None:
    _mount_repositories(machine)
    _refuse(machine, "none", "found no apt repository")
    _refuse(machine, Repositories.INCOMPLETE, "found packages that cannot be fetched")


def _refuse(machine: Machine, repository: str, reason: str) -> None:
    """An update that must not be made is refused for this reason, and leaves all as it is."""
    before = machine.agent.check(_STATE)
    reply = machine.agent.run(f"bevloc-update {_uri(repository)}", _UPDATE_TIMEOUT_S)
    if reply.status == 0 or reason not in reply.output:
        raise LabError(f"bevloc-update {repository}: found '{reply.output}', wanted '{reason}'")
    if (after := machine.agent.check(_STATE)) != before:
        raise LabError(f"bevloc-update {repository}: found {after} afterwards, wanted {before}")


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
                "while ls /efi/loader/entries/*+[1-9]*.conf 2>/dev/null; do sleep 1; done",
                _UPDATE_TIMEOUT_S,
            )
            return starts
        except GuestRestarted:
            starts += 1
