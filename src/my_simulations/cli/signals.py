"""Signal handling at the start and the end of a program."""
from __future__ import annotations

import os
import signal


def exit_on_signals() -> None:
    """Have SIGINT and SIGTERM exit at once with status 0 and without a traceback.

    For the time until the program installs its own handlers: during imports there is nothing to
    clean up, and child processes end with it.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: os._exit(0))


def ignore_signals() -> None:
    """Ignore SIGINT, SIGTERM and SIGHUP: the program has done its work and is about to end.

    Python restores the default of signals that it handles before it exits: another Ctrl-C would
    change the exit status. It leaves those that are ignored.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
