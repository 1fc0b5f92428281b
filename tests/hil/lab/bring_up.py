"""Scenario that follows docs/bring-up.md as a new user: from the packages to poses on the bus."""

import pathlib
import re

import yaml

from tests.hil.lab.agent import LabError
from tests.hil.lab.bench import USB_CONFIG, Run
from tests.hil.lab.drives import TRACKING_TIMEOUT_S, errors_of, judge_poses
from tests.hil.lab.outcome import Outcome

PAGE = "docs/bring-up.md"
MOST_COMMANDS = 15
_CONFIG = "/etc/bevloc/bevlocd.yaml"
# What the page leaves to the reader, and what the lab's machine has in its place.
_IN_THE_LAB = {
    "can0": "vcan0",
    "FRONT_LEFT FRONT FRONT_RIGHT BACK_LEFT BACK BACK_RIGHT": (
        "front_left front front_right back_left back back_right"
    ),
}
# A virtual CAN interface has no bit rate and is up already.
_NOT_IN_THE_LAB = "ip link set can0"
# The scenario continues for so long after TRACKING.
_TRACKING_S = 5
# The emulated machine is slow.
_SLOW = ("rate_hz", "tolerance_ms", "wait_ms", "formats")


def commands_of(page: pathlib.Path) -> list[str]:
    """Returns the commands of the section `In short`."""
    section = re.search(r"^## In short\n(.*?)^## ", page.read_text("utf-8"), re.M | re.S)
    if not section:
        raise LabError(f"{page}: found no section 'In short', wanted the commands in it")
    return [line.strip() for line in section[1].splitlines() if line.startswith("    ")]


def bring_up(run: Run) -> Outcome:
    """Purges the installed packages, which must leave nothing, then types what the page says."""
    commands = commands_of(run.bench.folders.source / PAGE)
    run.agent.check(
        """
        set -e
        apt-get purge -y -qq 'bevloc*'
        test ! -e /usr/bin/bevlocd
        test ! -e /etc/bevloc
        test ! -e /var/lib/bevloc
        mkdir -p /root/new_user
        cp /packages/*.deb /root/new_user/
        cp /payload/config/rig_demo.yaml /root/new_user/my_rig.yaml
        cp /payload/tests/hil/config/map.bvm /root/new_user/my_map.bvm
        """
    )
    for command in commands:
        if command.startswith(_NOT_IN_THE_LAB):
            continue
        if command.startswith("systemctl enable"):
            _slow_down(run)
        for name, found in _IN_THE_LAB.items():
            command = command.replace(name, found)
        run.agent.check(f"cd /root/new_user && {command}")
    run.start_vehicle()
    tracking = run.wait_for("StatusText", "TRACKING", TRACKING_TIMEOUT_S)
    run.agent.check(f"sleep {_TRACKING_S}")
    log = run.finish_log()
    passed, judged = judge_poses(errors_of(run, log), _TRACKING_S)
    return Outcome(
        injected=f"the {len(commands)} commands of {PAGE}",
        seen=f"{' -> '.join(log.states())}; {judged}",
        recovery_s=None,
        passed=passed and tracking and len(commands) <= MOST_COMMANDS,
    )


def _slow_down(run: Run) -> None:
    lab = yaml.safe_load((run.bench.folders.source / USB_CONFIG).read_text(encoding="utf-8"))
    config = yaml.safe_load(run.agent.check(f"cat {_CONFIG}"))
    config["cameras"] |= {key: lab["cameras"][key] for key in _SLOW}
    config["health"] = lab["health"]
    run.agent.check(f"cat >{_CONFIG} <<'E'\n{yaml.safe_dump(config)}E")
