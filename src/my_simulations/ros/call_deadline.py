"""Wall-clock timeout for calls that have none of their own."""
from __future__ import annotations

import threading
from typing import Any, Callable, Dict

from ..errors import SimulationError


class CallTimeoutError(SimulationError):
    """A call did not return in time; the text names it and the timeout."""


def call_with_deadline(limit: float, what: str, call: Callable[[], Any]) -> Any:
    """Run a call in a thread; return its value, or raise its exception.

    Args:
        limit: wall seconds.
        what: name of the call for the error message.
        call: the call.

    Raises:
        CallTimeoutError: the call did not return within `limit`; it keeps running.
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
        raise CallTimeoutError(f"{what} did not respond within {limit:g} s; is the simulator busy?")
    return box["answer"]
