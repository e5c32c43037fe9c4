"""Waits for what a test has started."""
from __future__ import annotations

import time
from typing import Callable, TypeVar

T = TypeVar("T")


def wait_for(condition: Callable[[], T], what: str, seconds: float) -> T:
    """Return the first true value of a condition.

    Raises:
        AssertionError: it was not true for some seconds of wall time; `what` names what is missing.
    """
    until = time.monotonic() + seconds
    while True:
        found = condition()
        if found:
            return found
        assert time.monotonic() < until, f"{what} did not come"
        time.sleep(0.05)


def until(condition: Callable[[], object], failure: str = "the condition never came true",
          seconds: float = 60.0) -> None:
    """Wait until a condition is true. Raises AssertionError after some seconds of wall time."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, failure
        time.sleep(0.001)
