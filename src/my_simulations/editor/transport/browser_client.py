"""One browser at the other end of a web socket."""
from __future__ import annotations

import asyncio
import json
from collections import deque
from typing import Any, Deque, Dict, Set, Union

from aiohttp import web

from .pose_messages import SentPoses

_MOST_WAITING = 64 << 20
"""Bytes, approximately; a browser that is so far behind is disconnected and connects again."""

_FULL = 1 << 20


def encode_message(message: Dict[str, Any]) -> str:
    return json.dumps(message, separators=(",", ":"), allow_nan=False)


class Client:
    """Sends in order; of pose frames only ever the newest.

    Attributes:
        number: tells clients apart.
        live: gets the running world's changes and frames.
        sent: the poses it has.
        topics: what it watches.
        replay: what it plays, if it looks at a log.
    """

    def __init__(self, number: int, socket: web.WebSocketResponse) -> None:
        self.number = number
        self.session = ""
        self.live = False
        self.sent = SentPoses()
        self.topics: Set[str] = set()
        self.replay: Any = None
        self._socket = socket
        self._queue: Deque[Union[str, bytes]] = deque()
        self._waiting = 0
        self._sending = False
        self._news = asyncio.Event()

    @property
    def is_free(self) -> bool:
        """Whether a frame would go out at once; else better send a newer one later."""
        return not self._queue and not self._sending

    @property
    def is_full(self) -> bool:
        """Whether data sent many times a second should be left out."""
        return self._waiting > _FULL

    @property
    def is_stuck(self) -> bool:
        """Whether it is so far behind that it is to be disconnected."""
        return self._waiting > _MOST_WAITING

    def post(self, message: Dict[str, Any]) -> None:
        self.append(encode_message(message))

    def append(self, data: Union[str, bytes]) -> None:
        """Queue a message that is text already, or a frame."""
        self._queue.append(data)
        self._waiting += len(data)
        self._news.set()

    async def close(self) -> None:
        """End the connection."""
        await self._socket.close(code=1001, message=b"the server ends")

    async def pump(self) -> None:
        """Send what is queued until the connection ends."""
        while not self._socket.closed:
            await self._news.wait()
            self._news.clear()
            self._sending = True
            try:
                while self._queue:
                    if self.is_stuck:
                        await self._socket.close(code=1013, message=b"too slow")
                        return
                    data = self._queue.popleft()
                    self._waiting -= len(data)
                    if isinstance(data, str):
                        await self._socket.send_str(data)
                    else:
                        await self._socket.send_bytes(data)
            except (ConnectionError, RuntimeError):
                return  # it went away; its reader hears of that too
            finally:
                self._sending = False
