"""Serves the page while its world is loaded: the progress, until there is an editor."""
from __future__ import annotations

import asyncio
import socket
import threading
from concurrent.futures import Future
from typing import Any, Dict, Optional, Set

from aiohttp import WSMsgType, web

from .editor_options import EditorOptions
from .transport import address_file
from .transport.access_guard import Guard
from .transport.browser_client import encode_message
from .transport.listening import open_listening_socket, save_address, url_of
from .transport.page_files import PageFiles

_WAIT_S = 10.0
_AGAIN = 1012
"""Close code of a web socket: the service restarts, come again (RFC 6455 registry)."""


class LoadingServer:
    """The page's files, and a web socket that reports the progress.

    Attributes:
        url: what to open in a browser; with the token.
        public_url: the same without the token.
        guard: checks who may ask; the editor goes on with it.

    Raises:
        CommandError: it cannot listen there, or the page is not installed.
    """

    def __init__(self, options: EditorOptions) -> None:
        self.guard = Guard(options)
        self._files = PageFiles(options.web, options.cache_dir)
        self._listener = open_listening_socket(options)
        self.url = url_of(self._listener, options.host, self.guard.token)
        self.public_url = address_file.without_token(self.url)
        self._state: Dict[str, Any] = {"type": "loading", "title": "", "text": "", "done": 0,
                                       "of": 0}
        self._sockets: Set[web.WebSocketResponse] = set()
        self._loop: Optional[asyncio.AbstractEventLoop] = None
        self._ending: "Optional[asyncio.Future[None]]" = None
        self._started: "Future[None]" = Future()
        self._thread = threading.Thread(target=self._main, name="loading page", daemon=True)
        self._thread.start()
        self._started.result(_WAIT_S)
        self._address_files = save_address(self.url, options) if self.guard.token else []

    def show(self, title: str, text: str = "", done: int = 0, of: int = 0) -> None:
        """What is under way, and how much of it is done (`of` 0: unknown). From any thread."""
        self._state = {**self._state, "title": title, "text": text, "done": done, "of": of}
        self._soon(self._push_state)

    def show_line(self, text: str) -> None:
        """A line about what is under way. From any thread."""
        self._state = {**self._state, "text": text}
        self._soon(self._push_state)

    def hand_over(self) -> socket.socket:
        """End; returns the listening socket, at which browsers that come meanwhile wait."""
        self._end()
        return self._listener

    def stop(self) -> None:
        """End for good: the world cannot be loaded, or loading was cancelled."""
        self._end()
        address_file.remove_files(self._address_files)
        self._listener.close()

    def _end(self) -> None:
        self._soon(self._finish)
        self._thread.join(_WAIT_S)

    def _finish(self) -> None:
        if self._ending is not None and not self._ending.done():
            self._ending.set_result(None)

    def _soon(self, call: Any) -> None:
        try:
            if self._loop is not None:
                self._loop.call_soon_threadsafe(call)
        except RuntimeError:
            return  # it has ended

    def _main(self) -> None:
        try:
            asyncio.run(self._serve())
        except Exception as fault:
            if self._started.done():
                raise
            self._started.set_exception(fault)

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._ending = self._loop.create_future()
        application = web.Application(middlewares=[self.guard.middleware])
        application.add_routes([web.get("/ws", self._socket), *self._files.routes()])
        runner = web.AppRunner(application, access_log=None, handle_signals=False,
                               shutdown_timeout=0.2)
        await runner.setup()
        assert runner.server is not None
        factory = self.guard.silent.with_deadline(runner.server, self._loop)
        # A copy: the server closes what it listens at, the editor goes on with the original.
        server = await self._loop.create_server(factory, sock=self._listener.dup(), backlog=64)
        self._started.set_result(None)
        await self._ending
        server.close()
        for browser in list(self._sockets):
            await browser.close(code=_AGAIN, message=b"the world is ready")
        await runner.cleanup()

    async def _socket(self, request: web.Request) -> web.WebSocketResponse:
        browser = web.WebSocketResponse(compress=False)
        await browser.prepare(request)
        self._sockets.add(browser)
        try:
            await browser.send_str(encode_message(self._state))
            async for message in browser:
                if message.type != WSMsgType.TEXT:
                    break  # requests have no answer yet: the page repeats its greeting
        finally:
            self._sockets.discard(browser)
        return browser

    def _push_state(self) -> None:
        text = encode_message(self._state)
        for browser in list(self._sockets):
            asyncio.ensure_future(self._send(browser, text))

    async def _send(self, browser: web.WebSocketResponse, text: str) -> None:
        try:
            await browser.send_str(text)
        except (ConnectionError, RuntimeError):
            self._sockets.discard(browser)
