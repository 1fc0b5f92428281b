"""Runs every driver's conformance suite on the guest's interfaces, with bevloc-compliance."""

import dataclasses
import re

from tests.hil.lab.bench import LIBCAMERA_ID, Run, chip_of
from tests.hil.lab.cameras import NAMES
from tests.hil.lab.outcome import Outcome

CAMERA = NAMES.index("front")
# The cameras' highest rate, because most of the time is spent waiting for frames.
BEAT_S = 0.1
TIMEOUT_S = 1800.0
# The beat script forwards commands from this pipe, because the channel takes only one writer.
_CABLE = "/run/cable"
_BEAT = f"""#!/bin/bash
exec 3<>{_CABLE} 4>/dev/virtio-ports/bevloc.beat
for ((k = 0; ; k++)); do
  if read -r -t {BEAT_S} -u 3 command; then echo "$command" >&4; fi
  echo "expose $((k % 50))" >&4
done
"""


@dataclasses.dataclass(frozen=True)
class Suite:
    name: str
    options: str
    filter: str  # GoogleTest's


def _suites() -> list[Suite]:
    name = NAMES[CAMERA]
    cable = (
        f"--unplug-command 'echo unplug {CAMERA} >{_CABLE}' "
        f"--replug-command 'echo plug {CAMERA} >{_CABLE}' --formats yuyv"
    )
    rate = f"--rate {1 / BEAT_S:.0f}"
    chip = chip_of("bevloc")
    libcamera = LIBCAMERA_ID.format(port=CAMERA + 1)
    return [
        Suite("V4L2 mmap", f"--v4l2 {name} {rate} {cable}", "Cameras/*/v4l2_*"),
        Suite("V4L2 dmabuf", f"--v4l2-dmabuf {name} {rate} {cable}", "Cameras/*/v4l2_dmabuf_*"),
        Suite("libcamera", f"--libcamera '{libcamera}' {cable}", "Cameras/*/libcamera_*"),
        Suite("SocketCAN vcan0", "--can vcan0", "SocketCan*:Buses/*/SocketCan"),
        Suite("libgpiod gpio-sim", f"--gpio {chip}", "Gpios/*/Libgpiod"),
    ]


def conformance(run: Run) -> Outcome:
    # The suite floods its interface, so the bus is not logged.
    run.stop_log()
    run.agent.check(f"mkfifo {_CABLE}; cat >/run/beat <<'E'\n{_BEAT}E\nchmod +x /run/beat")
    run.background("beat", "/run/beat")
    results = {suite.name: _play(run, suite) for suite in _suites()}
    run.agent.check("systemctl stop beat")
    return Outcome(
        injected="a camera unplugged, an interface down, floods of frames and edges",
        seen="; ".join(f"{name} {text}" for name, (text, _) in results.items()),
        recovery_s=None,
        passed=all(passed for _, passed in results.values()),
    )


def _play(run: Run, suite: Suite) -> tuple[str, bool]:
    """Runs a suite and counts its passed cases. A skipped case does not count as passed."""
    log = suite.name.replace(" ", "-") + ".log"
    reply = run.agent.run(
        f"/usr/bin/bevloc-compliance {suite.options} --gtest_filter='{suite.filter}' "
        f">{run.guest}/{log} 2>&1",
        TIMEOUT_S,
    )
    text = (run.folder / log).read_text(errors="replace")
    ran = re.search(r"\[=+\] (\d+) tests? from .* ran", text)
    passed = re.search(r"\[  PASSED  \] (\d+) test", text)
    missing = sorted(set(re.findall(r"\[  (?:FAILED|SKIPPED) +\] (\w\S*\.[^\s,]+)", text)))
    total, good = (int(found[1]) if found else 0 for found in (ran, passed))
    counts = f"{good}/{total}" + (f" (not {', '.join(missing)})" if missing else "")
    return counts, reply.status == 0 and total > 0 and good == total
