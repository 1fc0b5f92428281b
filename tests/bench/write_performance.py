"""Writes this machine's numbers into docs/performance.md and draws its figure. On an idle machine:

    /usr/bin/python3 -m tests.bench.write_performance

tests/bench/peers/run --write makes the table of other runtimes.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

from evaluation.figures import frame_stages, source
from evaluation.figures.program import bevloc_program
from tests.bench.document import ROOT, write_table
from tooling.errors import run_program
from tooling.markdown import table

FIGURE = ROOT / "docs/images" / frame_stages.FILE
SWEEPS = ("cameras", "image", "bev", "hypotheses", "map")
_FRAMES = 400
_SWEEP_FRAMES = 100


def run_bench(*options: str | Path) -> str:
    """Returns what the bench prints. Runs in the repository root, so that paths match the page."""
    command: list[str | Path] = [bevloc_program(), "bench", *options]
    return subprocess.run(
        command, check=True, cwd=ROOT, stdout=subprocess.PIPE, text=True
    ).stdout


def sweep_table(rows: list[dict[str, float]], columns: list[str]) -> str:
    cells = [[f"{row[column]:.4g}" for column in columns] for row in rows]
    return table(columns, cells, text_columns=0)


def columns_of(rows: list[dict[str, float]]) -> list[str]:
    """The columns of a sweep: the varied ones first, then the measured ones."""
    measured = [column for column in rows[0] if column.endswith(("_ms", "_s", "_mib"))]
    return [column for column in rows[0] if column not in measured] + measured


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "bench.json"
        printed = run_bench("--frames", str(_FRAMES), "--json", result)
        frame_stages.draw(frame_stages.data_of(source.read(result), result), FIGURE)
        figure = f"![Where the time of a frame goes](images/{FIGURE.name})"
        write_table("stages", f"```\n{printed}```\n\n{figure}\n")
        run_bench("--frames", str(_SWEEP_FRAMES), "--json", result, "--sweep", *SWEEPS)
        for name, rows in source.read(result)["sweeps"].items():
            write_table(name, sweep_table(rows, columns_of(rows)))


if __name__ == "__main__":
    run_program(main)
