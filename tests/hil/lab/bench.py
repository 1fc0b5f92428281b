"""One booted lab: its machine, cameras and folders, and the daemon under test."""

import dataclasses
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

from tests.hil.lab.agent import Agent, LabError
from tests.hil.lab.cameras import NAMES, Cameras
from tests.hil.lab.judge import BusLog
from tests.hil.lab.machine import Machine

UNIT = "bevlocd.service"
VEHICLE = "/lab/vehicle"  # folder of vehicle_can in the guest
# Writing pull-up or pull-down to this file drives the ignition line.
IGNITION_PULL = "/sys/devices/platform/gpio-sim.0/gpiochip*/sim_gpio3/pull"
# The two GPIO chips of tests/hil/guest/devices, by label.
_BANKS = {"bevloc": "bank0", "bench": "bank1"}
DRIVE_CONFIG = "tests/hil/config/drive.yaml"
CAMERA_PERIOD_S = 0.5  # as in DRIVE_CONFIG
USB_CONFIG = "tests/hil/config/usb.yaml"
# libcamera's id of the camera at a USB port of the guest.
LIBCAMERA_ID = "\\_SB_.PCI0.S80_-{port}:1.0-1209:0001"
_BUS_LOG = "/run/candump.log"
# Without cameras the daemon simulates the vehicle itself and needs an output folder.
_NO_CAMERAS = "/payload/tests/hil/config/no_cameras.yaml"
_NO_CAMERAS_DROP_IN = f"""[Service]
ExecStart=
ExecStart=/usr/libexec/bevloc-sim/bevlocd --config {_NO_CAMERAS} --out /run/bevloc/out
"""


@dataclasses.dataclass(frozen=True)
class Folders:
    source: pathlib.Path  # the repository
    build: pathlib.Path  # the CMake build folder
    image: pathlib.Path  # the guest system with the packages of bevloc, made by image/build
    pictures: pathlib.Path  # images, truth and map, made by drive_pictures
    results: pathlib.Path


class Bench:
    """Boots the guest on entry and stops it on exit. `driver` is v4l2, libcamera or none."""

    def __init__(self, folders: Folders, driver: str) -> None:
        self.folders = folders
        self.driver = driver

    def __enter__(self) -> "Bench":
        self._sockets = pathlib.Path(tempfile.mkdtemp(prefix="bevloc-lab-"))
        try:
            payload = self._stage_payload()
            self._install_vehicle()
            self.cameras = Cameras(
                self.folders.build / "bin/usb_cameras", self.folders.pictures, self._sockets
            )
            self.machine = Machine(
                self.folders.image, self._sockets, payload, self.folders.results, self.cameras
            )
            self.agent: Agent = self.machine.agent
            self._set_up_guest()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        for part in ("machine", "cameras"):
            if hasattr(self, part):
                getattr(self, part).close()
        shutil.rmtree(self._sockets)

    def _stage_payload(self) -> pathlib.Path:
        """Copies what the vehicle needs. Configurations use the paths of the tree."""
        payload = self.folders.results / "payload"
        shutil.rmtree(payload, ignore_errors=True)
        for folder in ("config", "models", "tests/hil/config"):
            shutil.copytree(self.folders.source / folder, payload / folder)
        shutil.copy2(self.folders.pictures / "map.bvm", payload / "tests/hil/config")
        (payload / "bevlocd.yaml").write_text(self._daemon_config(), encoding="utf-8")
        return payload

    def _install_vehicle(self) -> None:
        """Copies vehicle_can and its libraries from the host, because other Debians lack them."""
        program = self.folders.build / "bin/vehicle_can"
        folder = self.folders.image / f"root{VEHICLE}"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        needed = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
        libraries = re.findall(r"=> (/\S+)", needed)
        # The C library belongs to the guest, because its dynamic linker does.
        glibc = re.compile(r"lib(c|m|dl|rt|pthread)\.so\.\d+$")
        for file in [program, *(name for name in libraries if not glibc.search(name))]:
            shutil.copy2(file, folder)

    def _daemon_config(self) -> str:
        text = (self.folders.source / USB_CONFIG).read_text(encoding="utf-8")
        if self.driver != "libcamera":
            return text
        text = text.replace("driver: v4l2\n", "driver: libcamera\n")
        for port, name in enumerate(NAMES, start=1):
            text = text.replace(
                f"{name}: {name}\n", f"{name}: '{LIBCAMERA_ID.format(port=port)}'\n"
            )
        return text

    def _set_up_guest(self) -> None:
        self.agent.check("/lab/devices")
        if self.driver == "none":
            folder = f"/etc/systemd/system/{UNIT}.d"
            self.agent.check(
                f"mkdir -p {folder}\ncat >{folder}/lab.conf <<'E'\n{_NO_CAMERAS_DROP_IN}E"
            )
        else:
            self.agent.check(
                "install -D -m 644 /payload/bevlocd.yaml /etc/bevloc/bevlocd.yaml"
            )
            self._give_gpio_chips()
        self.agent.check("systemctl daemon-reload")

    def _give_gpio_chips(self) -> None:
        """Gives the daemon's user the GPIO chips of its configuration, as docs/bring-up.md says."""
        self.agent.check(
            """
            set -e
            rules=/etc/udev/rules.d/60-bevloc.rules
            bevloc udev-rules --config /etc/bevloc/bevlocd.yaml >$rules
            udevadm control --reload
            udevadm trigger --settle --subsystem-match=gpio
            """
        )


def chip_of(label: str) -> str:
    """Returns shell text that expands to the name of the GPIO chip with this label."""
    return f"$(cat /sys/kernel/config/gpio-sim/lab/{_BANKS[label]}/chip_name)"


@dataclasses.dataclass(frozen=True)
class DriveStart:
    """The start of the drive on two clocks of the guest."""

    wall_s: float
    monotonic_s: float


def drive_start_of(vehicle_log: str) -> DriveStart:
    """Reads the start of the drive from what vehicle_can has printed."""
    found = re.search(r"drive_start ([\d.]+) ([\d.]+)", vehicle_log)
    if not found:
        raise LabError(f"vehicle.log: found '{vehicle_log}', wanted drive_start")
    return DriveStart(float(found[1]), float(found[2]))


def last_match(pattern: re.Pattern[str], journal: str) -> re.Match[str] | None:
    """Finds what the last daemon of a scenario has logged. After a step of the clock the journal
    may also have lines of an earlier scenario."""
    matches = list(pattern.finditer(journal))
    return matches[-1] if matches else None


class Run:
    """One scenario: its bus log, daemon, vehicle and results."""

    def __init__(self, bench: Bench, name: str) -> None:
        self.bench = bench
        self.agent = bench.agent
        self.cameras = bench.cameras
        self.folder = bench.folders.results / name
        self.guest = f"/results/{name}"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)

    def __enter__(self) -> "Run":
        self.agent.check("ip link set vcan0 up")
        self._log_from_s = self.wall_s()
        self._sent_before = self._frames_sent_ever()
        # -D: survives an interface that goes down. The log is in memory, because a shared folder is
        # slow for the guest.
        self.agent.check(f"rm -f {_BUS_LOG}")
        self.background("candump", "candump -D -L vcan0", output=_BUS_LOG)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            self._end()
        except LabError:
            # Without a guest it cannot end. Then the failure of the scenario says why.
            if kind is None:
                raise

    def _end(self) -> None:
        self.cameras.command("heal all")
        self.cameras.command("plug all")
        self.agent.run(f"systemctl stop {UNIT} vehicle; systemctl reset-failed")
        self.stop_log()
        self.agent.run(f"{self._journal('short-unix')} >{self.guest}/journal.log")
        (self.folder / "cameras.json").write_text(self.cameras.command("counts") + "\n")

    def frames_sent(self) -> int:
        """Returns the number of frames that all cameras sent since the scenario began."""
        return self._frames_sent_ever() - self._sent_before

    def _frames_sent_ever(self) -> int:
        return sum(camera["sent"] for camera in self.cameras.counts()["cameras"].values())

    def journal(self) -> str:
        """Returns the daemon's journal since the scenario began."""
        return self.agent.check(self._journal("cat"))

    def _journal(self, style: str) -> str:
        return f"journalctl -u {UNIT} -o {style} --since @{self._log_from_s:.6f}"

    def background(self, unit: str, command: str, output: str | None = None) -> None:
        """Runs a command as a transient service; its output goes to `output`, or to UNIT.log."""
        self.agent.check(
            f"systemctl reset-failed {unit} 2>/dev/null; systemd-run --quiet --collect "
            f"--unit={unit} -p StandardOutput=append:{output or f'{self.guest}/{unit}.log'} "
            f"-p StandardError=append:{self.guest}/{unit}.err {command}"
        )

    def wall_s(self) -> float:
        """Returns the guest's wall clock time, which candump and the journal use."""
        return float(self.agent.check("date +%s.%N"))

    def start_daemon(self) -> float:
        """Starts bevlocd by its unit and returns the seconds until READY."""
        begin_s = self.wall_s()
        self.agent.check(f"systemctl start {UNIT}")
        return self.wall_s() - begin_s

    def start_vehicle(self) -> None:
        self.background(
            "vehicle",
            f"env LD_LIBRARY_PATH={VEHICLE} {VEHICLE}/vehicle_can --config /payload/{DRIVE_CONFIG} "
            "--beat /dev/virtio-ports/bevloc.beat",
        )

    def drive_start(self) -> DriveStart:
        log = self.folder / "vehicle.log"
        return drive_start_of(log.read_text() if log.exists() else "")

    def show(self, name: str) -> str:
        """Returns a property of the daemon's unit."""
        return self.agent.check(f"systemctl show {UNIT} --value -p {name}").strip()

    def wait_for(self, name: str, wanted: str, timeout_s: float) -> bool:
        """Waits until a property of the daemon's unit begins with `wanted`; False on timeout."""
        deadline = time.monotonic() + timeout_s
        while not self.show(name).startswith(wanted):
            if time.monotonic() > deadline:
                return False
            time.sleep(0.2)
        return True

    def wait_restarted(self, restarts: int, timeout_s: float) -> float:
        """Waits for one more restart and returns the wall time of its READY."""
        deadline = time.monotonic() + timeout_s
        while int(self.show("NRestarts")) <= restarts or self.show("ActiveState") != "active":
            if time.monotonic() > deadline:
                raise LabError(f"no restart within {timeout_s:.0f} s")
            time.sleep(0.2)
        monotonic_us = int(self.show("ActiveEnterTimestampMonotonic"))
        uptime_s = float(self.agent.check("cut -d' ' -f1 /proc/uptime"))
        return self.wall_s() - (uptime_s - 1e-6 * monotonic_us)

    def stop_log(self) -> None:
        """Stops logging the bus and copies the log to candump.log."""
        self.agent.run(f"systemctl stop candump; cp {_BUS_LOG} {self.guest}/candump.log")

    def finish_log(self) -> BusLog:
        """Stops logging and returns the bus log."""
        self.stop_log()
        return BusLog(self.folder / "candump.log", self.bench.folders.source / "can/bevloc.dbc")
