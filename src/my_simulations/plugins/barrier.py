"""Lets a thread wait until all messages due at the present step are published."""
from __future__ import annotations

import threading
from typing import Callable


class Barrier:
    """Requests of other threads, answered by the thread of the host.

    Args:
        wake: ends a wait of the host's thread.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._condition = threading.Condition()
        self._asked = self._answered = 0
        self._over = False

    def wait(self, timeout: float) -> bool:
        """Wait for the host; from any thread. Returns False after `timeout` s of wall time."""
        with self._condition:
            self._asked += 1
            number = self._asked
        self._wake()
        with self._condition:
            return self._condition.wait_for(
                lambda: self._over or self._answered >= number, timeout)

    def answer_if_quiet(self, is_quiet: Callable[[], bool]) -> None:
        """Answer the requests if nothing is due; for the host, at the end of each turn."""
        asked = self._asked
        if asked > self._answered and is_quiet():
            with self._condition:
                self._answered = asked
                self._condition.notify_all()

    def end(self) -> None:
        """Answer all requests, also those to come."""
        with self._condition:
            self._over = True
            self._condition.notify_all()
