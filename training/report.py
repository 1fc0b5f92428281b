"""Writes the results of training.evaluate: a JSON file and the tables of the model card."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path

from tooling.markdown import table, write_between_marks

BEGIN, END = "<!-- results: written by training.evaluate -->", "<!-- end of results -->"
_SHIPPED = "nano"  # its card is the folder's README.md
Metrics = dict[str, float]  # as named by training.evaluate
_AXES = (("x", "Longitudinal (m)"), ("y", "Lateral (m)"), ("yaw", "Yaw (degrees)"))
_ERRORS = (
    ("mae", "MAE"),
    ("rmse", "RMSE"),
    ("median", "median"),
    ("p90", "90 %"),
    ("bias", "mean"),
)
_SHARES = (("within_1_sigma", "within 1 sigma"), ("within_3_sigma", "within 3 sigma"))
# (field of Results, solver, title)
_ROWS = (
    ("float", "joint", "float, block"),
    ("float", "decoupled", "float, decoupled"),
    ("int8", "full-fft", "int8, full-fft"),
    ("int8", "block", "int8, block"),
    ("int8", "decoupled", "int8, decoupled"),
    ("int8", "decoupled+refine", "int8, decoupled+refine"),
    ("int8", "banded+refine", "int8, banded+refine"),
)


@dataclass
class Results:
    """The results of one model. The JSON file has the same fields."""

    trained_samples: int  # of the run that wrote the checkpoint
    samples: int  # evaluation scenes
    float: Metrics
    int8: Metrics


def _axis_table(results: Results, axis: str, title: str) -> str:
    def errors(metrics: Metrics, solver: str) -> list[str]:
        return [f"{metrics[f'{solver}_{axis}_{key}']:.3f}" for key, _ in _ERRORS]

    def shares(metrics: Metrics, solver: str) -> list[str]:
        return [f"{100 * metrics[f'{solver}_{axis}_{key}']:.1f} %" for key, _ in _SHARES]

    rows = [["prior, uncorrected", *errors(results.float, "prior"), "", ""]]
    for network, solver, row_title in _ROWS:
        metrics = getattr(results, network)
        rows.append([row_title, *errors(metrics, solver), *shares(metrics, solver)])
    header = [title, *(name for _, name in _ERRORS), *(name for _, name in _SHARES)]
    return table(header, rows)


def _iou_table(results: Results) -> str:
    classes = [key for key in results.float if key.startswith("iou_")]
    rows = [
        [network, *(f"{getattr(results, network)[key]:.3f}" for key in classes)]
        for network in ("float", "int8")
    ]
    return table(["Perceived mask, IoU", *(key.removeprefix("iou_") for key in classes)], rows)


def markdown(results: Results) -> str:
    """One table per axis and one for the masks."""
    trained = results.trained_samples  # 0 for a blend of networks
    samples = f"Training samples of the last run: {trained:,}. " if trained > 0 else ""
    axes = [_axis_table(results, axis, title) for axis, title in _AXES]
    scenes = f"{samples}Evaluation scenes: {results.samples}.\n"
    return "\n".join([scenes, *axes, _iou_table(results)])


def write_results(models: Path, network: str, results: Results) -> None:
    """Writes the JSON file and updates the generated part of the model card. A network without a
    card gets a new one with this part only."""
    text = json.dumps(dataclasses.asdict(results), indent=1)
    (models / f"{network}_results.json").write_text(text + "\n")
    card = models / ("README.md" if network == _SHIPPED else f"{network}.md")
    if not card.exists():
        card.write_text(f"# Model card: {network}\n\n{BEGIN}\n{END}\n")
    write_between_marks(card, BEGIN, END, f"\n\n{markdown(results)}\n")
