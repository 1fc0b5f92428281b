"""Stops a run that no longer improves."""

from __future__ import annotations

from collections.abc import Iterable

from training.config import FIRST_VALIDATION_SEED
from training.errors import TrainingError

_LESS_IS_BETTER = ("_mae", "_median", "_rmse", "_p90", "_nll")
_MORE_IS_BETTER = ("iou_",)


class Patience:
    """Counts the validations since a figure was best. `limit` 0: never stops the run."""

    def __init__(self, figure: str, limit: int) -> None:
        self.figure = figure
        self.limit = limit
        self.best: float | None = None
        self.best_samples = 0
        self.waited = 0
        self.scenes = FIRST_VALIDATION_SEED  # of all figures so far

    def check(self, solvers: Iterable[str], axes: Iterable[str], classes: Iterable[str]) -> None:
        """TrainingError if no validation measures the figure or it has no direction of improvement
        (such as a bias)."""
        figures = {f"{s}_{a}{kind}" for s in solvers for a in axes for kind in _LESS_IS_BETTER}
        figures |= {f"iou_{name}" for name in classes}
        if self.figure not in figures:
            raise TrainingError(
                f"--patience-figure: found '{self.figure}', wanted one of "
                f"{', '.join(sorted(figures))}"
            )

    def watch(self, metrics: dict[str, float], samples: int) -> None:
        """Records the metrics of a validation that followed `samples` training samples."""
        value = metrics[self.figure]
        if self.best is None or self._better(value, self.best):
            self.best, self.best_samples, self.waited = value, samples, 0
        else:
            self.waited += 1

    def _better(self, value: float, best: float) -> bool:
        return value > best if self.figure.startswith(_MORE_IS_BETTER) else value < best

    @property
    def exhausted(self) -> bool:
        return 0 < self.limit <= self.waited

    def __str__(self) -> str:
        if self.best is None:
            return f"{self.figure} was never measured"
        return (
            f"{self.figure} was best ({self.best:.4f}) after {self.best_samples} samples, "
            f"{self.waited} validations ago"
        )

    def state(self) -> dict[str, float | int | str | None]:
        return {key: value for key, value in vars(self).items() if key != "limit"}

    def resume(self, state: dict[str, float | int | str | None]) -> None:
        """Continues a saved count if it was of the same figure on the same scenes."""
        if state["figure"] == self.figure and state.get("scenes") == self.scenes:
            vars(self).update(state)
