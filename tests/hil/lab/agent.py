"""The host's side of the agent that runs scripts in the guest (tests/hil/guest/agent)."""

import dataclasses
import socket
import time


# Generous for emulation on a busy host: only a guest that hangs exceeds it.
TIMEOUT_S = 600.0
_READY = "agent ready"


class LabError(Exception):
    """The lab itself failed, so the test says nothing about the daemon."""


class GuestRestarted(LabError):
    """The guest restarted while it ran a script. Its agent is ready again."""


@dataclasses.dataclass(frozen=True)
class Reply:
    status: int
    output: str
    uptime_s: float  # of the guest, at the end of the script


class Agent:
    """Runs shell scripts in the guest, one at a time."""

    def __init__(self, socket_path: str, boot_timeout_s: float) -> None:
        self._socket = connect_unix(socket_path)
        self._received = b""
        line = self._read_line(boot_timeout_s)
        if line != _READY:
            raise LabError(f"agent: found '{line}', wanted '{_READY}'")

    def close(self) -> None:
        self._socket.close()

    def run(self, script: str, timeout_s: float = TIMEOUT_S) -> Reply:
        data = script.encode()
        try:
            self._socket.sendall(f"{len(data)}\n".encode() + data)
        except OSError as error:
            raise _connection_lost(str(error)) from None
        line = self._read_line(timeout_s)
        if line == _READY:
            raise GuestRestarted("guest: restarted in a script")
        status, length, uptime_s = line.split()
        output = self._read(int(length), timeout_s).decode(errors="replace")
        return Reply(int(status), output, float(uptime_s))

    def check(self, script: str, timeout_s: float = TIMEOUT_S) -> str:
        """Runs a script that must succeed and returns its output."""
        reply = self.run(script, timeout_s)
        if reply.status != 0:
            raise LabError(f"guest: status {reply.status}, wanted 0, of\n{script}\n{reply.output}")
        return reply.output

    def _read_line(self, timeout_s: float) -> str:
        deadline = time.monotonic() + timeout_s
        while b"\n" not in self._received:
            self._receive(deadline)
        line, self._received = self._received.split(b"\n", 1)
        return line.decode()

    def _read(self, count: int, timeout_s: float) -> bytes:
        deadline = time.monotonic() + timeout_s
        while len(self._received) < count:
            self._receive(deadline)
        data, self._received = self._received[:count], self._received[count:]
        return data

    def _receive(self, deadline: float) -> None:
        self._socket.settimeout(max(0.001, deadline - time.monotonic()))
        try:
            chunk = self._socket.recv(65536)
        except TimeoutError:
            raise LabError("guest: no answer in time; see console.log") from None
        except OSError as error:
            raise _connection_lost(str(error)) from None
        if not chunk:
            raise _connection_lost("closed the connection")
        self._received += chunk


def _connection_lost(reason: str) -> LabError:
    return LabError(f"guest: {reason}; see console.log and qemu.log")


def connect_unix(path: str, timeout_s: float = 20.0) -> socket.socket:
    """Connects to a socket that may not exist yet."""
    deadline = time.monotonic() + timeout_s
    while True:
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            connection.connect(path)
            return connection
        except OSError as error:
            connection.close()
            if time.monotonic() > deadline:
                raise LabError(f"{path}: {error}") from None
            time.sleep(0.1)
