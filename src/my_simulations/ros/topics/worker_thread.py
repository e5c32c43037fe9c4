"""A thread that sleeps while there is nothing to do."""
from __future__ import annotations

import threading
from abc import ABC, abstractmethod

_STOP_SECONDS = 2.0


class WorkerThread(ABC):
    """A thread that can be woken.

    Attributes:
        _wake: set from any thread, ends `_sleep`.
        _stop: set to make `_run` return.
    """

    def __init__(self, name: str) -> None:
        """`name`: name of the thread, which is not started yet."""
        self._wake = threading.Event()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """Stop the thread; waits 2 s at most."""
        self._stop.set()
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(_STOP_SECONDS)

    def _sleep(self) -> None:
        """Wait until woken; returns at once if that happened since the last call."""
        self._wake.wait()
        self._wake.clear()

    @abstractmethod
    def _run(self) -> None:
        """Body of the thread; returns once `_stop` is set."""
