"""Creates engines for the simulator; starts the first one in advance."""
from __future__ import annotations

from typing import Callable, Optional

from ...engine.api import Engine


class EngineSupply:
    """Engine factory that starts the first engine before it is requested."""

    def __init__(self, make: Callable[[], Engine]) -> None:
        self._make = make
        self._first: Optional[Engine] = make()

    def __call__(self) -> Engine:
        """The next engine; called once per simulator."""
        engine, self._first = self._first or self._make(), None
        return engine

    def close(self) -> None:
        """Stop an engine that was never requested."""
        if self._first is not None:
            self._first.close()
