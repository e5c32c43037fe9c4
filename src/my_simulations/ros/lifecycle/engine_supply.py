"""Engines for the simulator, the first one started ahead of need."""
from __future__ import annotations

from typing import Callable, Optional

from ...engine.api import Engine


class EngineSupply:
    """Makes engines for the simulator; the first is on its way before it is asked for."""

    def __init__(self, make: Callable[[], Engine]) -> None:
        self._make = make
        self._first: Optional[Engine] = make()

    def __call__(self) -> Engine:
        """The next engine; the simulator calls this again after a crash."""
        engine, self._first = self._first or self._make(), None
        return engine

    def close(self) -> None:
        """End an engine that nobody took."""
        if self._first is not None:
            self._first.close()
