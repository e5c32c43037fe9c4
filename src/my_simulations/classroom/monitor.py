"""Reads what happens in the world of a student, from its editor."""
from __future__ import annotations

import asyncio
import contextlib
import json
import struct
from typing import Any, Dict, Union

import aiohttp

from .world_picture import WorldPicture

_RETRY_S = 1.0
_SILENCE_S = 30.0
_LONGEST = 64 << 20      # bytes of a message: a world
_LONGEST_TEXT = 300      # characters of an error
_VERSION_KEY = "version"
_INVALID = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError,
            struct.error)
"""Raised by messages that the editor of this package does not send, but a student may."""


class Monitor:
    """Follows the editor of a world in an event loop, for the manager of the class.

    Args:
        version: of the editor's protocol.

    Attributes:
        is_connected: whether the world runs.
        world: name of the world; "" before it is known.
        models: number of models.
        factor: real-time factor.
        time: sim time, s.
        is_paused: whether sim time stands still.
        error: the last error that pages showed; "" for none.
        people: number of browsers.
        picture: picture of the world.
    """

    def __init__(self, version: int) -> None:
        self._version = version
        self.error = ""
        self.picture = WorldPicture()
        self._clear()

    def _clear(self) -> None:
        self.is_connected = self.is_paused = False
        self.world = ""
        self.models = self.people = 0
        self.factor = self.time = 0.0
        self.picture.clear()

    async def follow(self, port: int, token: str) -> None:
        """Follow the editor at a port of this machine until the task is cancelled."""
        url = f"http://127.0.0.1:{port}/ws"
        try:
            async with aiohttp.ClientSession() as session:
                while True:
                    try:
                        async with session.ws_connect(url, params={"token": token},
                                                      heartbeat=_SILENCE_S,
                                                      max_msg_size=_LONGEST) as socket:
                            await self._read(socket)
                    except (aiohttp.ClientError, asyncio.TimeoutError, OSError):
                        pass   # it starts, or has ended: the manager sees the processes
                    self._clear()
                    await asyncio.sleep(_RETRY_S)
        finally:
            self._clear()

    async def _read(self, socket: "aiohttp.ClientWebSocketResponse") -> None:
        await socket.send_str(json.dumps({"type": "hello", "id": 1, _VERSION_KEY: self._version,
                                          "name": "tutor"}))
        async for message in socket:
            if message.type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY):
                self.receive(message.data)

    def receive(self, data: Union[str, bytes]) -> None:
        """Process a message of the editor; ignore invalid messages."""
        with contextlib.suppress(*_INVALID):   # it comes from a student's processes
            if isinstance(data, bytes):
                self.picture.update_poses(data)
            else:
                self._handle_message(json.loads(data))

    def _handle_message(self, message: Dict[str, Any]) -> None:
        kind = message.get("type")
        if kind == "world":
            document = message["document"]
            self.world, self.models = str(document["name"])[:100], len(document["models"])
            self.is_connected = True
            self.picture.clear()
            self.picture.update_models({one["name"]: one for one in document["models"]})
        elif kind == "stats":
            self.factor, self.time = float(message["factor"]), float(message["sim_ns"]) * 1e-9
            self.is_paused = bool(message["paused"])
        elif kind == "change":
            self.models = len(message["order"]) if message.get("order") else self.models
            self.picture.update_models(message.get("models") or {})
        elif kind == "people":
            self.people = max(0, len(message["people"]) - 1)
        elif kind == "issue" and message["issue"]["severity"] == "error":
            self.error = str(message["issue"]["message"])[:_LONGEST_TEXT]
