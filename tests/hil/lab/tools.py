"""Scenario that compares the daemon's counts with what Debian's tools in the guest measure."""

import re
import statistics

import yaml

from tests.hil.lab import dbc
from tests.hil.lab.bench import USB_CONFIG, Run, chip_of, last_match
from tests.hil.lab.cameras import NAMES
from tests.hil.lab.devices import device_of
from tests.hil.lab.outcome import Outcome

RUN_S = 12
# Relative difference between the configured value and the measured median.
TOLERANCE = 0.02
# tests/hil/guest/wire enables this trace event.
_TRACE = "/sys/kernel/tracing/events/gpio/gpio_value/enable"
# Ends of the names of messages that are sent only if the configuration asks for them.
_NOT_CONFIGURED = ("Authentication", "Freshness", "Clock")
_FOURCC = {"yuyv": "YUYV"}
_PULSES = re.compile(r"trigger: (\d+) pulses")
_CAN_SENT = re.compile(r"CAN: (\d+) sent")
_CAN_RECEIVED = re.compile(r"CAN: (\d+) received")


def tools(run: Run) -> Outcome:
    source = run.bench.folders.source
    config = yaml.safe_load((source / USB_CONFIG).read_text(encoding="utf-8"))
    run.background("wire", "/lab/wire")
    run.agent.check(f"until grep -q 1 {_TRACE}; do sleep 0.1; done", timeout_s=60)
    run.background("gpiomon", f"/lab/edges {chip_of('bench')} 0")
    run.start_daemon()
    run.start_vehicle()
    run.agent.check(f"sleep {RUN_S}")
    formats, problems = _formats(run, config)
    # The daemon must receive the vehicle's last frames before it ends.
    run.agent.check("systemctl stop vehicle; sleep 0.2; systemctl stop bevlocd; sleep 1")
    run.agent.check("systemctl stop gpiomon wire")
    run.stop_log()
    journal = run.journal()
    bus, bus_problems = _bus(run, journal)
    trigger, trigger_problems = _trigger(run, journal, config["gpio"]["trigger"]["rate_hz"])
    problems += bus_problems + trigger_problems
    return Outcome(
        injected="nothing; v4l2-ctl, candump and gpiomon measure",
        seen="; ".join(problems or [formats, bus, trigger]),
        recovery_s=None,
        passed=not problems,
    )


def _formats(run: Run, config: dict) -> tuple[str, list[str]]:
    """Checks size, pixel format and rate of each camera while the daemon streams."""
    cameras = config["cameras"]
    rig = run.bench.folders.results / config["calibration"]["rig"].lstrip("/")
    sizes = yaml.safe_load(rig.read_text(encoding="utf-8"))["cameras"]
    fourcc, rate_hz = _FOURCC[cameras["formats"][0]], cameras["rate_hz"]
    problems = []
    for name in NAMES:
        output = run.agent.check(f"v4l2-ctl -d {device_of(name)} --get-fmt-video --get-parm")
        (run.folder / f"{name}.txt").write_text(output)
        width, height = sizes[name]["image_size_px"]
        for wanted in (f"{width}/{height}", f"'{fourcc}'", f"{rate_hz:.3f} ("):
            if wanted not in output:
                problems.append(f"v4l2-ctl: {name}: wanted {wanted}")
    return f"v4l2-ctl: six cameras {width}x{height} {fourcc} at {rate_hz} Hz", problems


def _bus(run: Run, journal: str) -> tuple[str, list[str]]:
    """Compares identifiers and cycles with the DBC file, counts with the daemon's log."""
    messages = dbc.read(run.bench.folders.source / "can/bevloc.dbc")
    times: dict[int, list[float]] = {}
    for line in (run.folder / "candump.log").read_text(encoding="ascii").splitlines():
        stamp, _, frame = line.split()
        times.setdefault(int(frame.split("#")[0], 16), []).append(float(stamp.strip("()")))
    # The bus is classic, so the CAN FD message is left out.
    classic = {
        i
        for i, message in messages.items()
        if message.length <= 8 and not message.name.endswith(_NOT_CONFIGURED)
    }
    problems = [f"candump: found {i:X}, not in the DBC file" for i in times.keys() - classic]
    problems += [f"candump: no {messages[i].name}" for i in classic - times.keys()]
    for i in classic & times.keys():
        message, stamps = messages[i], times[i]
        cycle_ms = 1e3 * statistics.median(b - a for a, b in zip(stamps, stamps[1:]))
        if abs(cycle_ms / message.cycle_ms - 1.0) > TOLERANCE:
            problems.append(
                f"candump: {message.name} every {cycle_ms:.2f} ms, wanted {message.cycle_ms} ms"
            )
    sent, received = (
        sum(len(times[i]) for i in classic & times.keys() if messages[i].name.startswith(who))
        for who in ("LOC_", "VEH_")
    )
    for who, pattern, seen in (("sent", _CAN_SENT, sent), ("received", _CAN_RECEIVED, received)):
        said = last_match(pattern, journal)
        if not said or int(said[1]) != seen:
            problems.append(f"candump: {seen} frames {who}, the daemon reports {said and said[1]}")
    counts = f"{sent} sent, {received} received"
    return f"candump: {len(classic)} identifiers on their cycles, {counts}", problems


def _trigger(run: Run, journal: str, rate_hz: float) -> tuple[str, list[str]]:
    """Compares the edges of the line `probe`, which follows the trigger, with the daemon's log."""
    edges = [line.split() for line in (run.folder / "gpiomon.log").read_text().splitlines()]
    rising = [int(s) + 1e-9 * int(ns) for kind, s, ns in edges if kind == "1"]
    said = last_match(_PULSES, journal)
    problems = []
    # The counts must be equal: the wire runs before the daemon starts, and the daemon stops the
    # trigger before it logs the count.
    if not said or int(said[1]) != len(rising) or len(edges) != 2 * len(rising):
        problems.append(
            f"gpiomon: {len(rising)} pulses in {len(edges)} edges, "
            f"the daemon reports {said and said[1]}"
        )
    if len(rising) < 2:
        return "", [*problems, "gpiomon: no pulses"]
    seen_hz = (len(rising) - 1) / (rising[-1] - rising[0])
    if abs(seen_hz / rate_hz - 1.0) > TOLERANCE:
        problems.append(f"gpiomon: {seen_hz:.3f} Hz, wanted {rate_hz}")
    return f"gpiomon: {len(rising)} pulses at {seen_hz:.3f} Hz", problems
