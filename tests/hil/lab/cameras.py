"""The emulated USB cameras (tests/hil/usb_cameras), their pictures and their faults."""

import json
import pathlib
import subprocess

from tests.hil.lab.agent import LabError, connect_unix

NAMES = ("front_left", "front", "front_right", "back_left", "back", "back_right")
# The one that scenarios break.
BROKEN_CAMERA = 2


class Cameras:
    """Six cameras that wait for QEMU to listen at SOCKETS0 to SOCKETS5."""

    def __init__(self, program: pathlib.Path, pictures: pathlib.Path, folder: pathlib.Path) -> None:
        self.control_path = str(folder / "control")
        self.sockets = str(folder / "usb")
        self._process = subprocess.Popen(
            [program, "--pictures", pictures, "--sockets", self.sockets]
            + ["--control", self.control_path],
            stdout=subprocess.DEVNULL,
        )
        self._socket = connect_unix(self.control_path)
        self._answers = self._socket.makefile("r")

    def command(self, line: str) -> str:
        """Faults by camera number, as camera_bench.h lists them: `unplug 2`, `heal all`."""
        self._socket.sendall(f"{line}\n".encode())
        answer = self._answers.readline().strip()
        if answer.startswith("error"):
            raise LabError(f"cameras: {answer}")
        return answer

    def counts(self) -> dict:
        return json.loads(self.command("counts"))

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(timeout=10)
