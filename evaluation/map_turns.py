"""Lets every second drive of a script go through one of several maps, as evaluation/map_turns.h."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path
from typing import Optional


def map_of(drive: int, maps: list[Path]) -> Optional[Path]:
    """The map of a drive, which is counted from 0. None if it goes through a procedural town."""
    return maps[drive // 2 % len(maps)] if maps and drive % 2 else None


def check(parser: ArgumentParser, option: str, drives: int, maps: list[Path]) -> None:
    """Ends the program with exit code 2 if the drives are too few to go through each map.
    `option` names the number of drives."""
    wanted = 2 * len(maps)
    if drives < wanted:
        parser.error(
            f"argument --map: found {len(maps)} of them with {option} {drives}, wanted {option} "
            f"{wanted} or more, because only every second drive goes through a map"
        )
