"""Tries a case again whose process crashed."""
from __future__ import annotations

from typing import Callable, Optional, Tuple, TypeVar

from .row import CRASHED, Row

Kept = TypeVar("Kept")


def repeat_after_crash(most: int, attempt: Callable[[int], Tuple[Row, Kept]]) -> Tuple[Row, Kept]:
    """Return the first attempt, counted from 1, that does not crash, or the last of `most`.

    One that comes out after a crash is flaky, and its row describes the first crash.
    """
    crash: Optional[Row] = None
    for number in range(1, most + 1):
        row, kept = attempt(number)
        if row.status != CRASHED:
            break
        crash = crash or row
    if crash is not None and row.status != CRASHED:
        row.flaky, row.signal = True, crash.signal
        row.issue = row.issue or f"in attempt 1: {crash.issue}"
    return row, kept
