"""Controls the emulated USB cameras (tests/hil/usb_cameras) and their faults."""

import json
import pathlib
import subprocess

from tests.hil.lab.agent import LabError, connect_unix

NAMES = ("front_left", "front", "front_right", "back_left", "back", "back_right")
# The camera in which scenarios inject faults.
BROKEN_CAMERA = 2


class Cameras:
    """Six cameras. They connect to QEMU when it listens at the sockets `sockets`0 to `sockets`5."""

    def __init__(self, program: pathlib.Path, pictures: pathlib.Path, folder: pathlib.Path) -> None:
        self.control_path = str(folder / "control")
        self.sockets = str(folder / "usb")
        command: list[str | pathlib.Path] = [program, "--pictures", pictures]
        command += ["--sockets", self.sockets, "--control", self.control_path]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        self._socket = connect_unix(self.control_path)
        self._answers = self._socket.makefile("r")

    def command(self, line: str) -> str:
        """Sends a command of camera_bench.h, such as `unplug 2`, and returns the answer."""
        try:
            self._socket.sendall(f"{line}\n".encode())
            answer = self._answers.readline().strip()
        except OSError as error:
            raise LabError(f"cameras: {error}, wanted an answer to '{line}'") from None
        if not answer or answer.startswith("error"):
            raise LabError(f"cameras: {answer or f'ended, wanted an answer to {line!r}'}")
        return answer

    def counts(self) -> dict:
        return json.loads(self.command("counts"))

    def sent_by(self, name: str) -> int:
        """Returns how many frames a camera has sent."""
        return self.counts()["cameras"][name]["sent"]

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(timeout=10)
