"""Calls that have no time-out of their own, with one on the wall clock."""
from __future__ import annotations

import threading
from typing import Any, Callable, Dict

from ..errors import SimulationError


class CallTimeoutError(SimulationError):
    """A call did not come back in time; the text names it and the deadline."""


def within(limit: float, what: str, call: Callable[[], Any]) -> Any:
    """Run a call; what it returns or raises.

    Raises:
        CallTimeoutError: nothing came back within `limit` wall seconds.
    """
    box: Dict[str, Any] = {}

    def work() -> None:
        try:
            box["answer"] = call()
        except BaseException as fault:  # handed to the caller below
            box["fault"] = fault

    # A daemon: a call that never answers must not keep the program alive.
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(limit)
    if "fault" in box:
        raise box["fault"]
    if "answer" not in box:
        raise CallTimeoutError(f"{what} gave no answer within {limit:g} s; is the simulator stuck?")
    return box["answer"]
