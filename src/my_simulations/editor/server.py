"""The server's life: a thread with a loop of its own, a listening socket, and an orderly end."""
from __future__ import annotations

import asyncio
import errno
import socket
import threading
from concurrent.futures import Future
from typing import Optional, Tuple

from aiohttp import web

from ..errors import CommandError, Issue, Severity
from ..resources.resolver import Resolver
from ..simulator.history import History
from ..simulator.simulator import Simulator
from .autosave import Autosave
from .document import Documents
from .faults import Refusal
from .guard import Guard
from .hub import Hub
from .options import DEFAULT_PORT, EditorOptions
from .pages import Pages
from .protocol import Protocol
from .requests import Requests
from .sockets import Sockets
from .worlds import WorldFiles

_START_S = 10.0
_END_S = 3.0
_AUTOSAVE_S = 1.0


class EditorServer:
    """Serves one simulator until `stop`.

    Attributes:
        url: what to open in a browser; holds the token where one is needed.

    Raises:
        CommandError: it cannot listen there, or the page is not installed.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, options: EditorOptions) -> None:
        self._simulator = simulator
        self._resolver = resolver
        self._options = options
        self._guard = Guard(options)
        self._documents = Documents(resolver)
        self._hub: Optional[Hub] = None
        self._stopping: Optional[asyncio.Event] = None
        self._loop: Optional[asyncio.AbstractEventLoop] = None
        self._listener = _listening(options)
        self._started: "Future[None]" = Future()
        self._thread = threading.Thread(target=self._main, name="editor", daemon=True)
        self._thread.start()
        self._started.result(_START_S)
        self.url = _url(self._listener, options.host, self._guard.token)

    def stop(self, reason: str = "the simulator ends") -> None:
        """Tell the pages, and end; unsaved edits stay in the autosave."""
        if self._loop is None or not self._thread.is_alive():
            return
        try:
            self._loop.call_soon_threadsafe(self._end, reason)
        except RuntimeError:
            return  # it has ended by itself
        self._thread.join(_END_S)

    def tell(self, issue: Issue) -> None:
        """Show an issue on all pages; safe from any thread."""
        if self._hub is not None:
            self._hub.tell(issue)

    def _main(self) -> None:
        try:
            asyncio.run(self._serve())
        except Exception as fault:
            if self._started.done():
                raise
            self._started.set_exception(fault)

    def _end(self, reason: str) -> None:
        if self._hub is not None:
            self._hub.push({"type": "shutdown", "reason": reason})
        if self._stopping is not None:
            self._stopping.set()

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._stopping = asyncio.Event()
        options = self._options
        history = History(self._simulator)
        files = WorldFiles(self._simulator, self._resolver, history, options.save_roots,
                           self._told)
        autosave = Autosave(files, history, options.cache_dir + "/autosave", self._told)
        pages = Pages(options, self._documents, 64 << 20,
                      lambda name: self._export(name, files))
        protocol = Protocol.from_folder(pages.web)
        self._hub = hub = Hub(self._simulator, self._documents, protocol,
                              options.check_outgoing)
        requests = Requests(hub, self._resolver, history, files, autosave, self._told)
        sockets = Sockets(hub, {**requests.routes()}, requests.leave, options.check_outgoing)
        application = web.Application(middlewares=[self._guard.middleware],
                                      client_max_size=protocol.limits["upload_bytes"])
        application.add_routes([web.get("/ws", sockets.serve), *pages.routes()])
        runner = web.AppRunner(application, access_log=None, handle_signals=False,
                               shutdown_timeout=0.5)
        await runner.setup()
        await web.SockSite(runner, self._listener).start()
        tasks = [asyncio.ensure_future(hub.run()), asyncio.ensure_future(self._keep(autosave))]
        self._started.set_result(None)
        await self._stopping.wait()
        await asyncio.sleep(0.05)  # the farewell goes out
        for task in tasks:
            task.cancel()
        await runner.cleanup()
        requests.thread.shutdown(wait=True)
        autosave.keep()

    async def _keep(self, autosave: Autosave) -> None:
        """Write the autosave whenever there is something new."""
        loop = asyncio.get_running_loop()
        while True:
            started = loop.time()
            await loop.run_in_executor(None, autosave.keep)
            # A world that takes long to write is written less often.
            await asyncio.sleep(_AUTOSAVE_S + 10.0 * (loop.time() - started))

    def _told(self, issue: Issue) -> None:
        """An issue of the editor's own work: to the pages, and to who started the server."""
        self.tell(issue)
        if issue.severity is not Severity.NOTE:
            self._options.log(issue)

    def _export(self, name: str, files: WorldFiles) -> Tuple[bytes, str]:
        if name.endswith((".world", ".sdf")):
            return files.text(), name
        raise Refusal("not-found", f"there is nothing to download called {name!r}")


def _listening(options: EditorOptions) -> socket.socket:
    """A listening socket. Raises CommandError."""
    host = options.host.strip("[]")
    ports = [options.port] + ([0] if options.port == DEFAULT_PORT else [])
    for port in ports:
        try:
            family, kind, _, _, address = socket.getaddrinfo(
                host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
            listener = socket.socket(family, kind)
        except OSError as fault:
            raise CommandError(f"the editor cannot listen at {host!r}: {fault}") from fault
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(address)
            listener.listen(64)
            return listener
        except OSError as fault:
            listener.close()
            if fault.errno != errno.EADDRINUSE or port == ports[-1]:
                raise CommandError(f"the editor cannot listen at {host}:{port}: "
                                   f"{fault.strerror}") from fault
    raise AssertionError("there is a port to try")


def _url(listener: socket.socket, host: str, token: str) -> str:
    port = listener.getsockname()[1]
    shown = {"0.0.0.0": socket.gethostname(), "::": socket.gethostname()}.get(host, host)
    shown = f"[{shown}]" if ":" in shown else shown
    return f"http://{shown}:{port}/" + (f"?token={token}" if token else "")


