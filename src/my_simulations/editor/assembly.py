"""All parts of one editor, put together in its event loop."""
from __future__ import annotations

import asyncio
import contextlib
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Tuple

from aiohttp import web

from ..errors import CommandError, Issue, Severity, error
from ..resources.resolver import Resolver
from ..simulator.history import History
from ..simulator.simulator import Simulator
from .editor_options import EditorOptions
from .library.autosave import Autosave
from .library.building_requests import BuildingRequests
from .library.library_requests import LibraryRequests
from .library.model_library import Library
from .library.world_files import WorldFiles
from .logs.replay import Logs
from .scene.plugin_states import PluginStates
from .scene.scene_json import Documents
from .topics.topic_requests import TopicRequests
from .transport.access_guard import Guard
from .transport.browser_client import Client
from .transport.error_messages import EditRefusedError
from .transport.http_pages import Pages
from .transport.hub import Hub
from .transport.protocol import Protocol
from .transport.watch_requests import WatchRequests
from .transport.web_socket import Route, Sockets
from .world_requests import WorldRequests

_AUTOSAVE_S = 1.0
_READING = ("hello", "presence", "viewed", "watch", "topics", "topic_fields", "library",
            "templates")
"""Requests and notices that are accepted if `EditorOptions.read_only` is set."""


async def _refuse(_client: Client, message: Dict[str, Any]) -> Any:
    raise EditRefusedError("read-only", "the world belongs to a program: this page shows it, and"
                           f" accepts no request '{message['type']}'")


class Assembly:
    """Made and used in the loop, but for `show_issue`.

    Attributes:
        application: serves pages and sockets.
        routes: the handlers of messages, by type.
        sockets: what they come through.

    Raises:
        CommandError: the page is not installed.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, options: EditorOptions,
                 guard: Guard) -> None:
        self._options = options
        documents = Documents(resolver)
        self._history = History(simulator)
        self._files = WorldFiles(simulator, resolver, self._history, options, self.report_issue)
        self._autosave = Autosave(self._files, self._history,
                                  os.path.join(options.cache_dir, "autosave"), self.report_issue)
        web_folder = options.web or Pages.own_folder()
        protocol = Protocol.from_folder(web_folder)
        pages = Pages(options, web_folder, documents, protocol.limits["upload_bytes"], self._export)
        self.hub = Hub(simulator, documents, protocol, options.check_outgoing)
        self._plugins = PluginStates(options.plugins)
        self.hub.greetings.append(self._plugins.last_push)
        self.hub.on_tick.append(self._push_plugins)
        self._pool = ThreadPoolExecutor(4, "editor requests")
        library = Library(resolver, documents.served, options.config_dir, self._downloading)
        self._requests = WorldRequests(self.hub, resolver, self._history, self._files,
                                  self._autosave, self.report_issue, options.read_only)
        self._models = LibraryRequests(self.hub, resolver, library, self._pool, self.report_issue)
        self._logs = Logs(self.hub, options.data_dir, self.report_issue, options.more_logs)
        self._topics = TopicRequests(self.hub, options.topics)
        self.routes: Dict[str, Route] = {
            **self._requests.routes(), **self._models.routes(), **self._logs.routes(),
            **WatchRequests(self.hub, self._topics.live).routes(), **self._topics.routes(),
            **BuildingRequests(self.hub, library, self._pool, self._files).routes(),
        }
        if options.read_only:
            self._autosave.found = None
            self.routes = {kind: route if kind in _READING else Route(_refuse, None)
                           for kind, route in self.routes.items()}
        self.sockets = Sockets(self.hub, self.routes, self._leave, options.check_outgoing)
        self.application = web.Application(middlewares=[guard.middleware],
                                           client_max_size=protocol.limits["upload_bytes"])
        self.application.add_routes([web.get("/ws", self.sockets.serve), *(
            route for route in pages.routes() if route.method == "GET" or not options.read_only)])
        self._tasks: "List[asyncio.Future[Any]]" = []

    def start(self) -> None:
        """Begin to look after the world."""
        works: List[Callable[[], Any]] = [self.hub.run, self._models.watch]
        if not self._options.read_only:
            works.append(self._autosave_loop)
        self._tasks = [asyncio.ensure_future(work()) for work in works]
        for task in self._tasks:
            task.add_done_callback(self._report_ended_task)

    async def close(self, reason: str, runner: web.AppRunner) -> None:
        """Say farewell, end what runs, keep unsaved edits."""
        self.hub.push({"type": "shutdown", "reason": reason})
        await asyncio.sleep(0.05)  # the farewell goes out
        for task in self._tasks:
            task.cancel()
        self._topics.close()
        with contextlib.suppress(CommandError):  # no page is left to report it to
            self._logs.close()
        clients = list(self.hub.clients.values())
        await asyncio.gather(*(client.close() for client in clients), return_exceptions=True)
        await runner.cleanup()
        self._pool.shutdown(wait=False)
        self._requests.close()
        if not self._options.read_only:
            self._autosave.save()

    def show_issue(self, issue: Issue) -> None:
        """Show an issue on all pages; safe from any thread."""
        self.hub.show_issue(issue)

    def report_issue(self, issue: Issue) -> None:
        """An issue of the editor's own work: to the pages, and to who started the server."""
        self.hub.show_issue(issue)
        if issue.severity is not Severity.NOTE:
            self._options.log(issue)

    async def _autosave_loop(self) -> None:
        """Write the autosave whenever there is something new."""
        loop = asyncio.get_running_loop()
        while True:
            started = loop.time()
            await loop.run_in_executor(self._pool, self._autosave.save)
            # A world that takes long to write is written less often.
            await asyncio.sleep(_AUTOSAVE_S + 10.0 * (loop.time() - started))

    def _report_ended_task(self, task: "asyncio.Future[Any]") -> None:
        """Report a task that ended by itself, which is a defect, to the owner of the server."""
        if not task.cancelled():
            defect = task.exception()
            self.report_issue(error("editor-defect", "a part of the editor has ended: "
                                f"{type(defect).__name__}: {defect}"))
            asyncio.get_running_loop().call_exception_handler(
                {"message": "a part of the editor has ended", "exception": defect})

    def _push_plugins(self, *_poses_and_revision: object) -> None:
        news = self._plugins.changes()
        if news is not None:
            self.hub.push(news)

    def _leave(self, client: Client) -> None:
        self._requests.leave(client)
        self._logs.leave(client)
        self._topics.leave(client)

    def _downloading(self, name: str, done: int, expected: int) -> None:
        self.hub.push_soon({"type": "download", "name": name, "done": done,
                            "expected": expected})

    def _export(self, name: str) -> Tuple[bytes, str]:
        """The download of that name: the world as it is, or a log."""
        if name.endswith((".world", ".sdf")):
            return self._files.world_sdf(), name
        if name.endswith(".log"):
            return self._logs.data(name[:-len(".log")]), name
        raise EditRefusedError("not-found", f"unknown download {name!r}")
