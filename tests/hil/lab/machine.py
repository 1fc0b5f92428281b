"""The guest: QEMU, and virtiofsd, which shares the root file system with it."""

import pathlib
import subprocess
import time

from tests.hil.lab.agent import Agent
from tests.hil.lab.cameras import NAMES, Cameras

VIRTIOFSD = "/usr/lib/qemu/virtiofsd"
MEMORY_MB = 2048
# Emulation is slow, and slower on a busy host. So the guest's clock counts its instructions, one
# per nanosecond: the guest sees a machine of constant speed, and its deadlines keep their meaning.
# While the guest is idle, its clock follows the host's.
GUEST_CLOCK = "shift=0,sleep=on"
KERNEL_OPTIONS = " ".join(
    (
        "console=ttyS0 quiet panic=-1 systemd.unit=lab.target",
        # On a busy host the kernel's timer check panics because ticks are missing.
        "no_timer_check",
        # Calibrating the local APIC timer takes seconds, because each pause leaves the emulation.
        # The HPET needs no calibration.
        "noapictimer",
        "cryptomgr.notests",
    )
)
# Emulation on a busy host can take minutes to boot.
BOOT_TIMEOUT_S = 480.0


class Machine:
    """A running guest. It reads the folder `payload` and writes to the folder `results`."""

    def __init__(
        self,
        image: pathlib.Path,
        sockets: pathlib.Path,
        payload: pathlib.Path,
        results: pathlib.Path,
        cameras: Cameras,
    ) -> None:
        self._sockets = sockets
        self._processes: list[subprocess.Popen] = []
        try:
            self._share_root(image / "root", results / "virtiofsd.log")
            self._boot(image, payload, results, cameras)
            self.agent = Agent(str(sockets / "agent"), BOOT_TIMEOUT_S)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        for process in reversed(self._processes):
            process.terminate()
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self._processes.clear()

    def _start(self, command: list[str], log: pathlib.Path) -> None:
        with open(log, "w", encoding="utf-8") as output:
            self._processes.append(
                subprocess.Popen(
                    command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
                )
            )

    def _share_root(self, root: pathlib.Path, log: pathlib.Path) -> None:
        options = ["-o", f"source={root}", "-o", "cache=always", "-o", "sandbox=chroot"]
        path = self._sockets / "root"
        self._start([VIRTIOFSD, f"--socket-path={path}", "--thread-pool-size=2", *options], log)
        while not path.exists() and self._processes[-1].poll() is None:
            time.sleep(0.05)

    def _boot(
        self, image: pathlib.Path, payload: pathlib.Path, results: pathlib.Path, cameras: Cameras
    ) -> None:
        command = ["qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=single"]
        command += ["-icount", GUEST_CLOCK]
        command += ["-cpu", "max", "-m", str(MEMORY_MB)]
        command += ["-nodefaults", "-no-user-config", "-display", "none", "-no-reboot"]
        command += ["-kernel", str(image / "vmlinux"), "-initrd", str(image / "initrd.gz")]
        command += ["-append", KERNEL_OPTIONS]
        command += ["-serial", f"file:{results / 'console.log'}"]
        # The guest's memory must be shared, because virtiofsd accesses it.
        memory = f"memory-backend-memfd,id=memory,size={MEMORY_MB}M,share=on"
        command += ["-object", memory, "-numa", "node,memdev=memory"]
        command += ["-chardev", f"socket,id=root,path={self._sockets / 'root'}"]
        command += ["-device", "vhost-user-fs-pci,chardev=root,tag=root"]
        for tag, folder, access in (("payload", payload, ",readonly=on"), ("results", results, "")):
            command += ["-fsdev", f"local,id={tag},path={folder},security_model=none{access}"]
            command += ["-device", f"virtio-9p-pci,fsdev={tag},mount_tag={tag}"]
        command += ["-device", "virtio-serial-pci"]
        agent = f"socket,id=agent,path={self._sockets / 'agent'},server=on,wait=off"
        command += ["-chardev", agent, "-device", "virtserialport,chardev=agent,name=bevloc.agent"]
        command += ["-chardev", f"socket,id=beat,path={cameras.control_path}"]
        command += ["-device", "virtserialport,chardev=beat,name=bevloc.beat"]
        # A fixed slot, because it is part of libcamera's ids of USB cameras.
        command += ["-device", "qemu-xhci,id=usb,p2=8,p3=8,addr=0x10"]
        for camera in range(len(NAMES)):
            path = f"{cameras.sockets}{camera}"
            command += ["-chardev", f"socket,id=usb{camera},path={path},server=on,wait=off"]
            command += ["-device", f"usb-redir,chardev=usb{camera},bus=usb.0,port={camera + 1}"]
        self._start(command, results / "qemu.log")
