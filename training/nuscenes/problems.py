"""Records which samples could not be used, and why."""

from __future__ import annotations

import sys
import threading
from collections import Counter

from training.nuscenes.errors import NuscenesError


class Problems:
    """The bad samples. Each is reported once on stderr. Several threads may call add()."""

    NAMED_PER_KIND = 10  # samples reported on stderr for each kind; `messages` has all of them

    def __init__(self) -> None:
        self._mutex = threading.Lock()
        self.messages: dict[str, str] = {}  # by sample token
        self.counts: Counter[str] = Counter()  # by kind

    def add(self, sample_token: str, error: NuscenesError) -> None:
        with self._mutex:
            if sample_token in self.messages:
                return
            self.messages[sample_token] = str(error)
            self.counts[error.kind] += 1
            if self.counts[error.kind] <= self.NAMED_PER_KIND:
                print(f"bad sample {sample_token}: {error}", file=sys.stderr, flush=True)

    def summary(self) -> str:
        kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(self.counts.items()))
        return f"{len(self.messages)} bad ({kinds})" if kinds else "none bad"
