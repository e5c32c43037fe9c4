"""What the page may ask for, each with its handler and its thread."""
from __future__ import annotations

import asyncio
import secrets
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, Callable, Dict, List

from .. import __version__
from ..errors import CommandError, Issue
from ..resources.resolver import Resolver
from ..simulator.history import History
from ..simulator.simulator import Simulator
from .editing.drags import Drags
from .editing.edit_notices import EditNotices
from .editing.edit_requests import EditRequests
from .editing.users import Users
from .library.autosave import Autosave
from .library.world_files import WorldFiles
from .scene.plain_json import pose_of
from .transport.browser_client import Client
from .transport.error_messages import EditRefusedError
from .transport.hub import Hub
from .transport.web_socket import Handler, Route

_MOST_STEPS = 100000
_LISTED = 200
"""Labels of the history that are sent."""


class WorldRequests:
    """The requests about the world itself: editing, time and files.

    Those that change the world run in one thread, in the order in which they came. While another
    world is being opened, which may take a minute, they are refused, and a second thread runs the
    others. That thread always lists folders.
    """

    def __init__(self, hub: Hub, resolver: Resolver, history: History, files: WorldFiles,
                 autosave: Autosave, report: Callable[[Issue], None],
                 read_only: bool = False) -> None:
        self._read_only = read_only  # the page hides what is then refused
        self._hub = hub
        self._world: Simulator = hub.simulator
        self._history = history
        self._files = files
        self._autosave = autosave
        self._drags = Drags(self._world)
        self._users = Users()
        self._notices = EditNotices(hub, self._users, self._drags)
        self._acting = 0
        self._pending: Dict[int, Dict[str, Any]] = {}
        self._edits = EditRequests(self._world, resolver, history, hub.protocol, report,
                            lambda names: self._drags.start_poses(self._acting, names))
        self._last_history: Dict[str, Any] = {}
        self._start = secrets.token_hex(4) + "-"
        self.thread = ThreadPoolExecutor(1, "editor edits")
        self._disk = ThreadPoolExecutor(1, "editor folders")

    def routes(self) -> Dict[str, Route]:
        changes: Dict[str, Handler] = {
            "edit": self._edit, "step": self._step,
            "save": partial(self._run_file_request, "saved", self._files.save),
            "open": partial(self._run_file_request, "opened", self._files.open),
            "new": partial(self._run_file_request, "opened", self._files.new),
            **{verb: partial(self._move_in_history, verb) for verb in ("undo", "redo")}}
        others: Dict[str, Handler] = {
            "copy": lambda _, message: {"text": self._edits.copy(message["names"])},
            "play": lambda *_: self._set_paused(False), "pause": lambda *_: self._set_paused(True)}
        return {"hello": Route(self._hello, None), "drag": Route(self._drag, None),
                "folders": Route(lambda _, message: self._files.folders(message), self._disk),
                "new_folder": Route(lambda _, message: self._files.new_folder(message),
                                    self._disk),
                "presence": Route(self._presence, None),
                "autosave": Route(self._recover, None),
                "drag_end": Route(self._drag_end, self.thread),
                **{kind: Route(self._in_turn(handler), None) for kind, handler in changes.items()},
                **{kind: Route(self._soon(handler), None) for kind, handler in others.items()}}

    def _in_turn(self, handler: Handler) -> Handler:
        """A handler that runs after all changes before it; refused while another world opens.

        Its reply comes after the change of the world and the history.
        """
        async def handle(client: Client, message: Dict[str, Any]) -> Any:
            self._files.check_no_world_opens()
            try:
                return await asyncio.get_running_loop().run_in_executor(
                    self.thread, handler, client, message)
            finally:
                await self._push_changes()

        return handle

    def _soon(self, handler: Handler) -> Handler:
        """As `_in_turn`; while another world opens, the second thread runs it."""
        async def handle(client: Client, message: Dict[str, Any]) -> Any:
            return await asyncio.get_running_loop().run_in_executor(
                self._disk if self._files.opening else self.thread, handler, client, message)

        return handle

    def close(self) -> None:
        """Carry out what was asked for, and end the threads."""
        self.thread.shutdown(wait=True)
        self._disk.shutdown(wait=True)

    def leave(self, client: Client) -> None:
        """A client has gone: what it held falls."""
        self._pending.pop(client.number, None)
        self._users.leave(client.number)
        self.thread.submit(self._end_drags, client.number)

    def history_push(self) -> Dict[str, Any]:
        names = self._users.names
        undo = self._history.undo_labels
        return {"type": "history", "undo": undo[:_LISTED], "undoable": len(undo),
                "depth": self._history.depth, "state": self._history.state,
                "redo": self._history.redo_labels[:_LISTED],
                "undo_by": names(self._history.undo_authors[:_LISTED]),
                "redo_by": names(self._history.redo_authors[:_LISTED]),
                "dirty": self._history.dirty, "file": self._files.file}

    # -- greeting --------------------------------------------------------------------------------

    async def _hello(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        version = self._hub.protocol.version
        if message["version"] != version:
            raise EditRefusedError(
                "version", f"the page uses protocol version {message['version']}, the server"
                f" {version}", "reload the page")
        given = message.get("session") or ""
        if not given.startswith(self._start):
            given = ""  # of another simulator, which had this address before
        client.session = given or self._start + secrets.token_hex(8)
        self._users.join(client.number, message.get("person") or client.session,
                          message.get("name") or "")
        await self._hub.add_client(client, new=not given)
        self._hub.push(self.history_push(), [client])
        self._hub.push(self._users.push())
        found = self._autosave.push()
        if found["found"] or (found["others"] and not given):
            self._hub.push(found, [client])
        return {"session": client.session, "version": version, "app": __version__,
                "number": client.number, "read_only": self._read_only}

    async def _presence(self, client: Client, message: Dict[str, Any]) -> None:
        """Store the name or the selection that a client sends."""
        if message.get("name"):
            self._users.rename(client.number, message["name"])
            self._hub.push(self.history_push())
        if message.get("selected") is not None:
            self._users.select(client.number, message["selected"])
        self._hub.push(self._users.push())

    # -- editing ---------------------------------------------------------------------------------

    def _edit(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        _refuse_in_log(client)
        op = message["op"]
        self._acting = client.number
        with self._notices.notify_of_deletions(client.number):
            value = self._edits.do(op, self._users.key_of(client.number))
            if op.get("kind") == "move":
                self._notices.drag_ended(client.number, list(op["poses"]))
        return value

    def _move_in_history(self, verb: str, client: Client,
                         message: Dict[str, Any]) -> Dict[str, Any]:
        """Undo or redo steps; notify their authors, and reply with their names."""
        _refuse_in_log(client)
        steps = message.get("to") or 0
        history = self._history
        move, authors, labels = (
            (history.undo, history.undo_authors, history.undo_labels) if verb == "undo" else
            (history.redo, history.redo_authors, history.redo_labels))
        with self._notices.notify_of_deletions(client.number):
            label = move(steps)
        theirs = list(zip(authors[:steps + 1], labels[:steps + 1]))
        return {"label": label, "by": self._notices.notify_of_undo(
            client.number, verb, theirs)}

    async def _drag(self, client: Client, message: Dict[str, Any]) -> None:
        """Latest wins: while one drag is carried out, only the newest waits."""
        names: List[str] = message["names"]
        if len(names) != len(message["poses"]):
            raise CommandError("drag: names and poses must have the same length")
        if client.replay is not None:
            return  # the move that ends the drag is refused, once
        waiting = client.number in self._pending
        self._pending.setdefault(client.number, {}).update(zip(names, message["poses"]))
        if not waiting:
            self.thread.submit(self._drag_now, client.number)

    def _drag_now(self, number: int) -> None:
        poses = self._pending.pop(number, None)
        if poses:
            fresh = self._drags.drag(number, {name: pose_of(pose)
                                              for name, pose in poses.items()})
            self._notices.drag_started(number, fresh)

    def _drag_end(self, client: Client, _message: Dict[str, Any]) -> None:
        self._pending.pop(client.number, None)
        self._end_drags(client.number)

    def _end_drags(self, number: int) -> None:
        self._drags.end(number)
        self._notices.push_drags(always=True)

    # -- time ------------------------------------------------------------------------------------

    def _set_paused(self, paused: bool) -> Dict[str, Any]:
        clock = self._world.clock
        if not clock.choose_while_loading(paused):
            clock.pause() if paused else clock.unpause()
        self._hub.stats_soon()
        return {}

    def _step(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        steps = message["steps"]
        if not 0 < steps <= _MOST_STEPS:
            raise CommandError(f"steps must be 1 to {_MOST_STEPS}, not {steps}")
        step = self._world.clock.advance(steps)
        self._hub.stats_soon()
        return {"step": step}

    # -- files -----------------------------------------------------------------------------------

    def _run_file_request(self, verb: str, handler: Callable[[Dict[str, Any]], Dict[str, Any]],
                          client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        if message.get("discard"):
            self._autosave.save_as_discarded()
        with self._notices.notify_of_deletions(client.number):
            value = handler(message)
            if verb == "opened":
                self._end_all_drags()
        file = value.get("path") or value.get("file") or "an empty world"
        self._notices.notify_others(client.number, f"{verb} {file}")
        return value

    async def _recover(self, client: Client, message: Dict[str, Any]) -> Any:
        way = self._in_turn if message["action"] == "restore" else self._soon
        return await way(self._restore)(client, message)

    def _restore(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        if message["action"] == "list":
            return {"entries": self._autosave.entries()}
        try:
            if message["action"] == "restore":
                file = self._autosave.restore(message.get("name") or "")
                self._end_all_drags()
                return {"file": file}
            self._autosave.discard()
            return {"file": ""}
        finally:
            self._hub.push_soon(self._autosave.push())

    def _end_all_drags(self) -> None:
        """What people dragged was of the world before this one."""
        self._pending.clear()
        self._drags.clear()
        self._notices.push_drags()

    async def _push_changes(self) -> None:
        """Send all pages what an edit has changed: the world, then the history if it differs."""
        history = self.history_push()
        self._hub.wake()
        await self._hub.push_changes()
        if history != self._last_history:
            self._last_history = history
            self._hub.push(history)


def _refuse_in_log(client: Client) -> None:
    """Who looks at a log does not see what an edit does to the world. Raises EditRefusedError."""
    if client.replay is not None:
        raise EditRefusedError("replay", "the world cannot be edited while a log is open",
                               "close the log first")
