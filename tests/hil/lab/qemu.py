"""What every guest of the lab has: its clock, its cameras and the channels to the host."""

import pathlib
import subprocess

from tests.hil.lab.cameras import NAMES, Cameras

# Emulation is slow, and slower on a busy host. So the guest's clock counts its instructions, one
# per nanosecond: the guest sees a machine of constant speed, and its deadlines keep their meaning.
# While the guest is idle, its clock follows the host's.
GUEST_CLOCK = "shift=0,sleep=on"
# Emulation on a busy host can take minutes to boot.
BOOT_TIMEOUT_S = 480.0
# On a busy host the kernel's timer check panics because ticks are missing. Calibrating the local
# APIC timer takes seconds, because each pause leaves the emulation. The HPET needs no calibration.
KERNEL_OPTIONS = "no_timer_check noapictimer cryptomgr.notests"


class Processes:
    """The processes of one guest, which end together."""

    def __init__(self) -> None:
        self._processes: list[subprocess.Popen] = []

    def start(self, command: list[str], log: pathlib.Path) -> subprocess.Popen:
        with open(log, "w", encoding="utf-8") as output:
            process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
            )
        self._processes.append(process)
        return process

    def terminate(self) -> None:
        """Ends them in reverse order and lets them finish their work."""
        for process in reversed(self._processes):
            process.terminate()
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self._processes.clear()

    def kill(self) -> None:
        """Ends them at once."""
        for process in reversed(self._processes):
            process.kill()
        for process in self._processes:
            process.wait()
        self._processes.clear()


def guest_command(memory_mb: int, console: pathlib.Path) -> list[str]:
    """The emulated machine without disks and channels."""
    command = ["qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=single"]
    command += ["-icount", GUEST_CLOCK]
    command += ["-cpu", "max", "-m", str(memory_mb)]
    command += ["-nodefaults", "-no-user-config", "-display", "none"]
    command += ["-serial", f"file:{console}"]
    return command


def channels(sockets: pathlib.Path, cameras: Cameras) -> list[str]:
    """The agent's channel, the beat of the cameras, and the six cameras."""
    command = ["-device", "virtio-serial-pci"]
    agent = f"socket,id=agent,path={sockets / 'agent'},server=on,wait=off"
    command += ["-chardev", agent, "-device", "virtserialport,chardev=agent,name=bevloc.agent"]
    command += ["-chardev", f"socket,id=beat,path={cameras.control_path}"]
    command += ["-device", "virtserialport,chardev=beat,name=bevloc.beat"]
    # The slot is fixed, because it is part of libcamera's ids of USB cameras.
    command += ["-device", "qemu-xhci,id=usb,p2=8,p3=8,addr=0x10"]
    for camera in range(len(NAMES)):
        path = f"{cameras.sockets}{camera}"
        command += ["-chardev", f"socket,id=usb{camera},path={path},server=on,wait=off"]
        command += ["-device", f"usb-redir,chardev=usb{camera},bus=usb.0,port={camera + 1}"]
    return command
