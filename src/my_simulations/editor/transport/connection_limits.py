"""Ends idle connections, so that no client can use up the server's descriptors."""
from __future__ import annotations

import asyncio
from typing import Any, Callable, Dict

SILENCE_S = 10.0
"""Longest time from a connection's beginning to its first right request, in seconds."""

MOST_SILENT = 64
"""Connections without a right request at a time; another one ends the oldest."""


class SilentConnections:
    """Ends connections without a right request. Used in the server's loop only."""

    def __init__(self) -> None:
        self._waiting: Dict[Any, None] = {}  # in the order of their beginning

    def with_deadline(self, factory: Callable[[], Any],
                loop: asyncio.AbstractEventLoop) -> Callable[[], asyncio.Protocol]:
        """The factory of a server's protocols, each of them with a deadline."""
        def make() -> Any:
            protocol = factory()
            if len(self._waiting) >= MOST_SILENT:
                # Those that were accepted just now have no transport yet.
                self._end(next((one for one in self._waiting if one.transport is not None), None))
            self._waiting[protocol] = None
            loop.call_later(SILENCE_S, self._end, protocol)
            return protocol

        return make

    def request_received(self, protocol: Any) -> None:
        self._waiting.pop(protocol, None)

    def _end(self, protocol: Any) -> None:
        if protocol in self._waiting:
            del self._waiting[protocol]
            if protocol.transport is not None:
                protocol.transport.abort()
