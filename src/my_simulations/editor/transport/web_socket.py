"""The web socket: requests in, answers out, in the right threads."""
from __future__ import annotations

import asyncio
from concurrent.futures import Executor
from typing import Any, Callable, Dict, Optional

from aiohttp import WSMsgType, web

from ...errors import CommandError, InputError
from ...geometry import is_finite_number
from .browser_client import Client
from .error_messages import EditRefusedError, issue_document, issues_of
from .hub import Hub
from .protocol import ProtocolError

Handler = Callable[[Client, Dict[str, Any]], Any]

_SILENCE_S = 20.0
"""Pings this often; a browser that answers none of them has gone."""
MOST_REQUESTS = 256
"""Requests of one client without an answer; others are refused, so that memory stays bounded."""

_LAST_S = 2.0
"""How long the last requests of a client that has gone may take before it is forgotten."""


class Route:
    """A request's handler, and where it runs (None: in the loop, as a coroutine)."""

    def __init__(self, handler: Handler, executor: Optional[Executor]) -> None:
        self.handler = handler
        self.executor = executor


class Sockets:
    """All web sockets of one server.

    Args:
        hub: greets clients and forgets them.
        routes: by type of message.
        on_leave: called in the loop for each client that has gone.
        check: hold answers to the protocol.
    """

    def __init__(self, hub: Hub, routes: Dict[str, Route],
                 on_leave: Callable[[Client], None], check: bool = False) -> None:
        self._hub = hub
        self._routes = routes
        self._on_leave = on_leave
        self._check = check
        self._count = 0

    async def serve(self, request: web.Request) -> web.WebSocketResponse:
        """One connection, from its beginning to its end."""
        limit = self._hub.protocol.limits["request_bytes"]
        socket = web.WebSocketResponse(max_msg_size=limit, heartbeat=_SILENCE_S, compress=False)
        await socket.prepare(request)
        self._count += 1
        client = Client(self._count, socket)
        self._hub.clients[client.number] = client
        self._hub.count_pose_readers(1)
        pump = asyncio.ensure_future(client.pump())
        tasks: "set[asyncio.Future[None]]" = set()
        try:
            async for message in socket:
                if message.type == WSMsgType.TEXT:
                    if client.is_stuck:
                        break  # it sends, and does not read
                    self._hub.note_activity()
                    busy = len(tasks) >= MOST_REQUESTS
                    task = asyncio.ensure_future(self._handle(client, message.data, busy))
                    tasks.add(task)
                    task.add_done_callback(tasks.discard)
                elif message.type == WSMsgType.BINARY:
                    break  # nothing of the protocol is binary in this direction
        finally:
            pump.cancel()
            del self._hub.clients[client.number]
            self._hub.count_pose_readers(-1)
            try:
                # What came with the farewell is carried out, before what its client held falls.
                if tasks:
                    await asyncio.wait(tasks, timeout=_LAST_S)
            finally:
                self._on_leave(client)
        return socket

    async def _handle(self, client: Client, text: str, busy: bool) -> None:
        number: Any = None
        try:
            message = self._hub.protocol.parse(text)
            found = message.get("id")
            number = found if is_finite_number(found) else None
            if busy:
                raise EditRefusedError("busy", f"{MOST_REQUESTS} requests of this page have no"
                                       " answer yet", "wait for their answers")
            self._hub.protocol.check_texts(message, text)
            self._hub.protocol.check_message(message)
            value = await self._answer(client, message)
            if number is not None:
                if self._check:
                    self._hub.protocol.check_reply(message["type"], value)
                client.post({"type": "reply", "id": number, "ok": True, "value": value})
        except (CommandError, InputError) as fault:
            self._refuse(client, number, fault)
        except Exception as defect:
            # A fault of ours must not cost the others their connection; it is told and raised.
            self._refuse(client, number, CommandError(
                f"the editor's server failed: {type(defect).__name__}: {defect}"))
            raise

    async def _answer(self, client: Client, message: Dict[str, Any]) -> Any:
        route = self._routes.get(message["type"])
        if route is None:
            raise ProtocolError(f"{message['type']} is not supported")
        if route.executor is None:
            return await route.handler(client, message)
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(route.executor, route.handler, client, message)

    def _refuse(self, client: Client, number: Any, fault: Exception) -> None:
        issues = [issue_document(issue) for issue in issues_of(fault)]
        if number is not None:
            client.post({"type": "reply", "id": number, "ok": False, "issues": issues})
            return
        for issue in issues:
            client.post({"type": "issue", "issue": issue})
