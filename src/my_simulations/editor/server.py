"""The server's life: a thread with a loop of its own, a listening socket, and an orderly end."""
from __future__ import annotations

import asyncio
import threading
from concurrent.futures import Future
from concurrent.futures import TimeoutError as TimeoutError_
from typing import TYPE_CHECKING, Optional

from aiohttp import web

from ..errors import CommandError, Issue
from ..resources.resolver import Resolver
from ..simulator.simulator import Simulator
from .assembly import Assembly
from .editor_options import EditorOptions
from .transport import address_file
from .transport.access_guard import Guard
from .transport.listening import open_listening_socket, save_address, url_of

if TYPE_CHECKING:
    from .loading_server import LoadingServer

_START_S = 10.0
_END_S = 3.0


class EditorServer:
    """Serves one simulator until `stop`.

    Args:
        loading: served the page until now; its pages go on with this server.

    Attributes:
        url: what to open in a browser; with the token, so it is for the user alone.
        public_url: the same without the token.

    Raises:
        CommandError: it cannot listen there, or the page is not installed.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, options: EditorOptions,
                 loading: "Optional[LoadingServer]" = None) -> None:
        self._world = (simulator, resolver)
        self._options = options
        self._guard = loading.guard if loading is not None else Guard(options)
        self._editor: Optional[Assembly] = None
        self._loop: Optional[asyncio.AbstractEventLoop] = None
        self._stopping: "Optional[asyncio.Future[str]]" = None
        self._listener = (loading.hand_over() if loading is not None
                          else open_listening_socket(options))
        self._started: "Future[None]" = Future()
        self._thread = threading.Thread(target=self._main, name="editor", daemon=True)
        self._thread.start()
        try:
            self._started.result(_START_S)
        except TimeoutError_ as slow:
            raise CommandError(f"the editor did not start within {_START_S:g} s") from slow
        self.url = url_of(self._listener, options.host, self._guard.token)
        self.public_url = address_file.without_token(self.url)
        self._address_files = save_address(self.url, options) if self._guard.token else []

    def stop(self, reason: str = "the simulator ends") -> None:
        """Notify the pages, and end; unsaved edits stay in the autosave."""
        if self._loop is None or not self._thread.is_alive():
            return
        address_file.remove_files(self._address_files)
        try:
            self._loop.call_soon_threadsafe(self._end, reason)
        except RuntimeError:
            return  # it has ended by itself
        self._thread.join(_END_S)

    def show_issue(self, issue: Issue) -> None:
        """Show an issue on all pages; safe from any thread."""
        if self._editor is not None:
            self._editor.show_issue(issue)

    def _main(self) -> None:
        try:
            asyncio.run(self._serve())
        except Exception as fault:
            self._listener.close()
            if self._started.done():
                raise
            self._started.set_exception(fault)

    def _end(self, reason: str) -> None:
        if self._stopping is not None and not self._stopping.done():
            self._stopping.set_result(reason)

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._stopping = self._loop.create_future()
        self._editor = Assembly(*self._world, self._options, self._guard)
        runner = web.AppRunner(self._editor.application, access_log=None, handle_signals=False,
                               shutdown_timeout=0.5)
        await runner.setup()
        assert runner.server is not None
        factory = self._guard.silent.with_deadline(runner.server, self._loop)
        server = await self._loop.create_server(factory, sock=self._listener, backlog=64)
        self._editor.start()
        self._started.set_result(None)
        reason = await self._stopping
        server.close()
        await self._editor.close(reason, runner)
