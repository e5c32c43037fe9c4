"""Connections that say nothing: they end, so that nobody can use up the server's descriptors."""
from __future__ import annotations

import asyncio
from typing import Any, Callable, Set

SILENCE_S = 10.0
"""Longest time from a connection's beginning to its first right request, in seconds."""


class SilentConnections:
    """Ends connections without a right request. Used in the server's loop only."""

    def __init__(self) -> None:
        self._waiting: Set[Any] = set()

    def watched(self, factory: Callable[[], Any],
                loop: asyncio.AbstractEventLoop) -> Callable[[], asyncio.Protocol]:
        """The factory of a server's protocols, each of them with a deadline."""
        def make() -> Any:
            protocol = factory()
            self._waiting.add(protocol)
            loop.call_later(SILENCE_S, self._end, protocol)
            return protocol

        return make

    def heard(self, protocol: Any) -> None:
        """A right request came."""
        self._waiting.discard(protocol)

    def _end(self, protocol: Any) -> None:
        if protocol in self._waiting:
            self._waiting.discard(protocol)
            if protocol.transport is not None:
                protocol.transport.abort()
