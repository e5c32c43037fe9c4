"""Repeats a case after a crash of its process."""
from __future__ import annotations

from typing import Callable, Optional, Tuple, TypeVar

from .row import CRASHED, Row

Output = TypeVar("Output")


def repeat_after_crash(most: int, attempt: Callable[[int], Tuple[Row, Output]]
                       ) -> Tuple[Row, Output]:
    """Return the first attempt, counted from 1, that does not crash, or the last of `most`.

    If a later attempt succeeds, its row is flaky and describes the first crash.
    """
    crash: Optional[Row] = None
    for number in range(1, most + 1):
        row, output = attempt(number)
        if row.status != CRASHED:
            break
        crash = crash or row
    if crash is not None and row.status != CRASHED:
        row.flaky, row.signal = True, crash.signal
        row.issue = row.issue or f"in attempt 1: {crash.issue}"
    return row, output
