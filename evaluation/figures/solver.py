"""The three figures of docs/solver.md."""

from __future__ import annotations

import functools
import json
import subprocess
import tempfile
from pathlib import Path
from typing import TypedDict

from evaluation.figures import axis_features, distributions, spectra
from evaluation.figures.program import bevloc_program


class SolverFigures(TypedDict):
    """The data that evaluation/solver/solver_figures.h describes."""

    scene: int
    spectra: spectra.Spectra
    axis_features: axis_features.AxisFeatures
    distributions: distributions.Distributions


def compute(scene: int) -> SolverFigures:
    """Runs `bevloc draw solver`. CalledProcessError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "figures.json"
        options = ["draw", "solver", "--scene", str(scene), "--json", str(file)]
        subprocess.run([str(bevloc_program()), *options], check=True)
        data: SolverFigures = json.loads(file.read_text())
    return data


def draw(folder: Path, scene: int | None = None) -> None:
    """Draws all figures of one scene; without a scene, each of the one that the page describes."""

    @functools.cache
    def data(scene_of_page: int) -> SolverFigures:
        return compute(scene_of_page if scene is None else scene)

    spectra.draw(data(3)["spectra"], folder / spectra.FILE)
    distributions.draw(data(3)["distributions"], folder / distributions.FILE)
    axis_features.draw(data(0)["axis_features"], folder / axis_features.FILE)
