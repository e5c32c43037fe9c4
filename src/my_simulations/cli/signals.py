"""What a signal does to a program that has only just begun."""
from __future__ import annotations

import os
import signal


def end_quietly() -> None:
    """Have SIGINT and SIGTERM end this process at once, with status 0 and without a traceback.

    For the time until the program has handlers of its own: while it imports there is nothing to be
    put away, and its children end with it.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: os._exit(0))
