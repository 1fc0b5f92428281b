"""Errors in a nuScenes tree. `kind` is the name under which errors are counted."""

from __future__ import annotations

from training.errors import TrainingError


class NuscenesError(TrainingError, ValueError):
    """The message is one sentence: the place, what was found, what was wanted."""

    kind = "error"


class MissingFileError(NuscenesError):
    kind = "missing file"


class UnreadableJsonError(NuscenesError):
    kind = "unreadable JSON"


class WrongTypeError(NuscenesError):
    kind = "wrong type"


class MissingTokenError(NuscenesError):
    kind = "missing token"


class MissingSceneError(NuscenesError):
    kind = "missing scene"


class MissingFrameError(NuscenesError):
    kind = "missing frame"


class CalibrationError(NuscenesError):
    kind = "bad calibration"


class UnreadableImageError(NuscenesError):
    kind = "unreadable image"


class WrongSizeError(NuscenesError):
    kind = "wrong size"
