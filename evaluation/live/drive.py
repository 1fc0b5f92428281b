"""A simulated drive with a live page, in the background.

It runs on a virtual clock, so that a slow machine shows the same.
"""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path
from types import TracebackType

ROOT = Path(__file__).resolve().parents[2]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Drive:
    """Use it as a context manager: it ends the drive."""

    def __init__(self, duration_s: int, seed: int = 1) -> None:
        self.port = free_port()
        self.address = f"http://127.0.0.1:{self.port}"
        self._arguments = ["--duration", str(duration_s), "--seed", str(seed)]

    def __enter__(self) -> Drive:
        program = os.environ.get("BEVLOCD", str(ROOT / "build/release/bin/bevlocd"))
        self._out = tempfile.mkdtemp(prefix="bevloc-live-")
        self._process = subprocess.Popen(
            [program, "--config", str(ROOT / "config/demo.yaml"), "--live", str(self.port)]
            + ["--fast", "--out", self._out, *self._arguments],
            stdout=subprocess.DEVNULL,
        )
        end = time.monotonic() + 120.0
        while self.get("/healthz")[0] == 0:
            assert self._process.poll() is None, "bevlocd has ended"
            assert time.monotonic() < end, "bevlocd does not answer"
            time.sleep(0.1)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._process.terminate()
        self._process.wait()
        shutil.rmtree(self._out, ignore_errors=True)

    def get(self, path: str) -> tuple[int, str]:
        """The status and the text of the answer; the status is 0 if there is no answer."""
        try:
            with urllib.request.urlopen(self.address + path, timeout=10) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as refused:
            return refused.code, refused.read().decode()
        except OSError:
            return 0, ""
