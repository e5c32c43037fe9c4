"""Reports the progress of downloads, once a second."""
from __future__ import annotations

import time
from typing import Callable

from ...errors import Issue, Severity

_EVERY_S = 1.0


class DownloadNotes:
    """A `model_provider.Progress` that logs the progress of a download."""

    def __init__(self, log: Callable[[Issue], None]) -> None:
        self._log = log
        self._next = 0.0
        self._name = ""

    def __call__(self, name: str, done: int, expected: int) -> None:
        """`done` bytes of a model have been received, of `expected` (0 if unknown)."""
        now = time.monotonic()
        if name == self._name and now < self._next and done != expected:
            return
        self._name, self._next = name, now + _EVERY_S
        of = f" of {expected / 1e6:.1f}" if expected else ""
        self._log(Issue(Severity.NOTE, "model-download",
                        f"downloading model {name!r}: {done / 1e6:.1f}{of} MB"))
