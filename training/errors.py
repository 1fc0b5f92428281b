"""Errors of training."""

from __future__ import annotations

from tooling.errors import UserError


class TrainingError(UserError):
    """Wrong input: training cannot continue."""


class CheckpointError(TrainingError):
    """A checkpoint is unreadable or belongs to another network or run."""


class NotFiniteError(TrainingError):
    """A loss, gradient or weight is infinite or NaN."""
