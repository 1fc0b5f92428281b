"""The guest: QEMU, and virtiofsd, which shares the root file system with it."""

import pathlib
import time

from tests.hil.lab.agent import Agent
from tests.hil.lab.cameras import Cameras
from tests.hil.lab.qemu import BOOT_TIMEOUT_S, KERNEL_OPTIONS, Processes, channels, guest_command

VIRTIOFSD = "/usr/lib/qemu/virtiofsd"
MEMORY_MB = 2048


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
        self._processes = Processes()
        try:
            self._share_root(image / "root", results / "virtiofsd.log")
            self._boot(image, payload, results, cameras)
            self.agent = Agent(str(sockets / "agent"), BOOT_TIMEOUT_S)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._processes.terminate()

    def _share_root(self, root: pathlib.Path, log: pathlib.Path) -> None:
        options = ["-o", f"source={root}", "-o", "cache=always", "-o", "sandbox=chroot"]
        path = self._sockets / "root"
        command = [VIRTIOFSD, f"--socket-path={path}", "--thread-pool-size=2", *options]
        server = self._processes.start(command, log)
        while not path.exists() and server.poll() is None:
            time.sleep(0.05)

    def _boot(
        self, image: pathlib.Path, payload: pathlib.Path, results: pathlib.Path, cameras: Cameras
    ) -> None:
        command = guest_command(MEMORY_MB, results / "console.log")
        command += ["-no-reboot"]
        command += ["-kernel", str(image / "vmlinux"), "-initrd", str(image / "initrd.gz")]
        options = f"console=ttyS0 quiet panic=-1 systemd.unit=lab.target {KERNEL_OPTIONS}"
        command += ["-append", options]
        # The guest's memory must be shared, because virtiofsd accesses it.
        memory = f"memory-backend-memfd,id=memory,size={MEMORY_MB}M,share=on"
        command += ["-object", memory, "-numa", "node,memdev=memory"]
        command += ["-chardev", f"socket,id=root,path={self._sockets / 'root'}"]
        command += ["-device", "vhost-user-fs-pci,chardev=root,tag=root"]
        for tag, folder, access in (("payload", payload, ",readonly=on"), ("results", results, "")):
            command += ["-fsdev", f"local,id={tag},path={folder},security_model=none{access}"]
            command += ["-device", f"virtio-9p-pci,fsdev={tag},mount_tag={tag}"]
        command += channels(self._sockets, cameras)
        self._processes.start(command, results / "qemu.log")
