"""Finds the files that CMake built, for commands without a variable that names them."""

from __future__ import annotations

from pathlib import Path

_PRESET = "release"  # what script/build makes by default, so the others may be older


def built_file(build: Path, name: str) -> Path | None:
    """A file of a build: that of the preset release, or else the newest one. None if there is none.
    `build`: a folder with a folder for each preset, or a build without presets."""
    if (released := build / _PRESET / name).exists():
        return released
    found = [path for path in (build / name, *build.glob(f"*/{name}")) if path.exists()]
    return max(found, key=lambda path: path.stat().st_mtime) if found else None
