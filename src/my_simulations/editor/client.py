"""One browser at the other end of a web socket."""
from __future__ import annotations

import asyncio
import json
from collections import deque
from typing import Any, Deque, Dict, Optional, Set

from aiohttp import web

from .frames import SentPoses

_MOST_WAITING = 64 << 20
"""Characters; a browser that is so far behind is cut off and starts anew."""


def encoded(message: Dict[str, Any]) -> str:
    """A message as text."""
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
        self._texts: Deque[str] = deque()
        self._waiting = 0
        self._frame: Optional[bytes] = None
        self._sending = False
        self._news = asyncio.Event()

    @property
    def free(self) -> bool:
        """Whether a frame would go out at once."""
        return self._frame is None and not self._sending and not self._texts

    def post(self, message: Dict[str, Any]) -> None:
        """Queue a message."""
        self.post_text(encoded(message))

    def post_text(self, text: str) -> None:
        """Queue a message that is text already."""
        self._texts.append(text)
        self._waiting += len(text)
        self._news.set()

    def offer(self, frame: bytes) -> None:
        """Send poses next; call only while `free`."""
        self._frame = frame
        self._news.set()

    async def pump(self) -> None:
        """Send what is queued until the connection ends."""
        while not self._socket.closed:
            await self._news.wait()
            self._news.clear()
            self._sending = True
            try:
                while self._texts or self._frame is not None:
                    if self._waiting > _MOST_WAITING:
                        await self._socket.close(code=1013, message=b"too slow")
                        return
                    if self._texts:
                        text = self._texts.popleft()
                        self._waiting -= len(text)
                        await self._socket.send_str(text)
                    else:
                        frame, self._frame = self._frame, None
                        await self._socket.send_bytes(frame or b"")
            except (ConnectionError, RuntimeError):
                return  # it went away; its reader hears of that too
            finally:
                self._sending = False
