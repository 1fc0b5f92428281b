"""Programs that stand for those that a script calls."""

from __future__ import annotations

import os
import pathlib


class StubPrograms:
    """A folder of shell scripts. Each one notes how it was called before it does anything else."""

    def __init__(self, folder: pathlib.Path) -> None:
        self._folder = folder
        self._folder.mkdir()
        self._calls = folder / "calls"

    def put(self, name: str, script: str = "") -> None:
        file = self._folder / name
        note = f'echo "{name}${{*:+ }}$*" >>"{self._calls}"'
        file.write_text(f"#!/bin/bash\n{note}\n{script}\n", encoding="utf-8")
        file.chmod(0o755)

    def environment(self) -> dict[str, str]:
        """The environment in which a script finds these programs first."""
        return {**os.environ, "PATH": f"{self._folder}:{os.environ['PATH']}"}

    def take_calls(self) -> list[str]:
        """The calls since the last time, each with its arguments."""
        calls = self._calls.read_text(encoding="utf-8") if self._calls.exists() else ""
        self._calls.unlink(missing_ok=True)
        return calls.splitlines()
