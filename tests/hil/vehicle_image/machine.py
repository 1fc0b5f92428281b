"""A machine with the vehicle's disk: it starts from its firmware, and its power can be cut."""

import dataclasses
import pathlib
import re
import shutil
import tempfile
import time

from tests.hil.lab.agent import Agent, LabError
from tests.hil.lab.cameras import Cameras
from tests.hil.lab.qemu import BOOT_TIMEOUT_S, Processes, channels, guest_command
from tests.hil.vehicle_image.disk import Disk

MEMORY_MB = 1024
OVMF = pathlib.Path("/usr/share/OVMF")
TRACKING_TIMEOUT_S = 600.0


@dataclasses.dataclass(frozen=True)
class Parts:
    """What the machine is made of."""

    disk: Disk
    cameras_program: pathlib.Path
    pictures: pathlib.Path
    results: pathlib.Path
    repositories: pathlib.Path  # shared with the guest, read-only


class Machine:
    """Power on at entry; power cut at exit, unless the machine has been switched off before."""

    def __init__(self, parts: Parts, name: str) -> None:
        self.parts = parts
        self.folder = parts.results / name
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self._processes = Processes()
        self._agent: Agent | None = None

    def __enter__(self) -> "Machine":
        self._sockets = pathlib.Path(tempfile.mkdtemp(prefix="bevloc-image-"))
        try:
            self.cameras = Cameras(
                self.parts.cameras_program, self.parts.pictures, self._sockets
            )
            self._power_on()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, kind: type | None = None, *_: object) -> None:
        if kind is LabError and self._agent is not None:
            self._save_journal(self._agent)
        self.cut_power()
        if hasattr(self, "cameras"):
            self.cameras.close()
        shutil.rmtree(self._sockets)

    def _power_on(self) -> None:
        variables = self.folder / "uefi-variables.fd"
        shutil.copy(OVMF / "OVMF_VARS_4M.fd", variables)
        nbd = self._sockets / "disk"
        address = self.parts.disk.serve(self._processes, nbd, self.folder / "nbdkit.log")
        command = guest_command(MEMORY_MB, self.folder / "console.log")
        flash = "if=pflash,format=raw"
        command += ["-drive", f"{flash},readonly=on,file={OVMF / 'OVMF_CODE_4M.fd'}"]
        command += ["-drive", f"{flash},file={variables}"]
        command += ["-drive", f"if=none,id=disk,format=raw,cache=writeback,file={address}"]
        command += ["-device", "virtio-blk-pci,drive=disk"]
        command += ["-device", "i6300esb", "-action", "watchdog=reset"]
        share = f"local,id=share,path={self.parts.repositories},security_model=none,readonly=on"
        command += ["-fsdev", share, "-device", "virtio-9p-pci,fsdev=share,mount_tag=repositories"]
        command += channels(self._sockets, self.cameras)
        self.powered_s = time.monotonic()
        self._process = self._processes.start(command, self.folder / "qemu.log")

    def cut_power(self) -> None:
        self._processes.kill()
        self._forget_agent()

    def _save_journal(self, agent: Agent) -> None:
        try:
            journal = agent.run("journalctl -b --no-pager", timeout_s=60).output
            (self.folder / "journal.log").write_text(journal, encoding="utf-8")
        except LabError as error:
            print(f"lab: the journal cannot be read: {error}", flush=True)

    @property
    def agent(self) -> Agent:
        """The agent in the guest; waits until the guest has started it."""
        if self._agent is None:
            self._agent = Agent(str(self._sockets / "agent"), BOOT_TIMEOUT_S)
        return self._agent

    def restart(self) -> None:
        """Restarts the guest; its agent will say again that it is ready."""
        self.agent.check("systemctl --no-block reboot")
        self._forget_agent()

    def _forget_agent(self) -> None:
        if self._agent is not None:
            self._agent.close()
        self._agent = None

    def run_until(self, after_s: float) -> None:
        """Lets the machine run until this time after power on, on the host's clock."""
        time.sleep(max(0.0, self.powered_s + after_s - time.monotonic()))
        if self._process.poll() is not None:
            raise LabError(f"QEMU ended; see {self.folder / 'qemu.log'}")

    def wait_for_tracking(self) -> float:
        """Waits for TRACKING and returns the time since power on, on the host's clock."""
        deadline = time.monotonic() + TRACKING_TIMEOUT_S
        status = ""
        while not status.startswith("TRACKING"):
            if time.monotonic() > deadline:
                raise LabError(f"no TRACKING, the daemon's status is '{status}'; see {self.folder}")
            time.sleep(0.5)
            status = self.agent.check("systemctl show bevlocd --value -p StatusText").strip()
        return time.monotonic() - self.powered_s

    def started_root(self) -> str:
        """The root that runs: a or b."""
        options = self.agent.check("cat /proc/cmdline")
        found = re.search(r"root=PARTLABEL=bevloc-([ab])\b", options)
        if not found:
            raise LabError(f"/proc/cmdline: found '{options}', wanted root=PARTLABEL=bevloc-a")
        return found[1]
