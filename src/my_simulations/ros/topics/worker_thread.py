"""Threads that work while somebody listens, and sleep else."""
from __future__ import annotations

import threading
from abc import ABC, abstractmethod

_STOP_SECONDS = 2.0


class WorkerThread(ABC):
    """A thread that can be woken.

    Attributes:
        _wake: set from any thread, ends `_sleep`.
        _stop: set once `_run` shall return.
    """

    def __init__(self, name: str) -> None:
        """Not started yet; `name` is the thread's."""
        self._wake = threading.Event()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Begin to publish."""
        self._thread.start()

    def stop(self) -> None:
        """End, and wait for the end, 2 s at most."""
        self._stop.set()
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(_STOP_SECONDS)

    def _sleep(self) -> None:
        """Wait until woken; at once when that has happened since the last sleep."""
        self._wake.wait()
        self._wake.clear()

    @abstractmethod
    def _run(self) -> None:
        """What the thread does until `_stop` is set."""
