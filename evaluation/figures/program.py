"""Finds the bevloc program, and runs it for the data of the solver's figures."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import TypedDict

from evaluation.figures.axis_features import AxisFeatures
from evaluation.figures.distributions import Distributions
from evaluation.figures.spectra import Spectra

ROOT = Path(__file__).resolve().parents[2]


class SolverFigures(TypedDict):
    """evaluation/solver/solver_figures.h"""

    scene: int
    spectra: Spectra
    axis_features: AxisFeatures
    distributions: Distributions


def bevloc_program() -> Path:
    """$BEVLOC, or the bevloc of the release build."""
    program = Path(os.environ.get("BEVLOC", ROOT / "build/release/bin/bevloc"))
    if not program.is_file():
        raise SystemExit(f"{program}: no such program; build it with script/build or set BEVLOC")
    return program


def solver_figures(scene: int) -> SolverFigures:
    """Runs `bevloc draw solver`. CalledProcessError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "figures.json"
        options = ["draw", "solver", "--scene", str(scene), "--json", str(file)]
        subprocess.run([str(bevloc_program()), *options], check=True)
        data: SolverFigures = json.loads(file.read_text())
    return data
