"""Recording state logs, and playing them to single browsers."""
from __future__ import annotations

import asyncio
import contextlib
import json
import os
import re
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, Iterable, List, Optional

from ...errors import CommandError, Issue, warning
from ..transport.browser_client import Client
from ..transport.error_messages import EditRefusedError
from ..transport.hub import Hub
from ..transport.pose_messages import LOG, Poses
from ..transport.web_socket import Route
from .state_log import FILE, LogReader, LogWriter, new_name

_NAME = re.compile(r"[\w][\w.+-]{0,80}\Z")


class Replay:
    """A log that one client looks at."""

    def __init__(self, name: str, reader: LogReader) -> None:
        self.name = name
        self.reader = reader
        self.time = reader.begin
        self.rate = 0.0
        self.shown = -2
        self.task: "Optional[asyncio.Task[None]]" = None

    def push(self) -> Dict[str, Any]:
        return {"type": "log", "state": "playing" if self.rate else "open", "name": self.name,
                "begin": self.reader.begin, "end": self.reader.end, "time": self.time,
                "rate": self.rate}


class Logs:
    """The requests `log_…`. Everything runs in the server's loop but reading and writing.

    Args:
        hub: the clients.
        folder: where logs are, each in a folder of its name.
        report: receives faults.
        more: log files that lie elsewhere.
    """

    def __init__(self, hub: Hub, folder: str, report: Callable[[Issue], None],
                 more: Iterable[str] = ()) -> None:
        self._hub = hub
        self._folder = folder
        self._more = {os.path.basename(os.path.dirname(path)): path for path in more
                      if os.path.dirname(os.path.dirname(path)) != os.path.abspath(folder)}
        self._report = report
        self._writer: Optional[LogWriter] = None
        self._name = ""
        self._revision = -1
        self._fetching: "Optional[asyncio.Future[Any]]" = None
        self._disk = ThreadPoolExecutor(1, "editor logs")
        hub.on_tick.append(self._tick)
        hub.greetings.append(self.state)

    def routes(self) -> Dict[str, Route]:
        return {"log_start": Route(self._start, None), "log_stop": Route(self._stop, None),
                "log_list": Route(self._list, self._disk), "log_open": Route(self._open, None),
                "log_seek": Route(self._seek, None), "log_play": Route(self._play, None),
                "log_close": Route(self._close, None)}

    def state(self) -> Dict[str, Any]:
        """The push `log` for who looks at the running world."""
        writer = self._writer
        begin = writer.begin if writer and writer.begin is not None else 0.0
        return {"type": "log", "state": "recording" if writer else "idle", "name": self._name,
                "begin": begin, "end": writer.end if writer else 0.0,
                "time": writer.end if writer else 0.0, "rate": 0.0}

    def data(self, name: str) -> bytes:
        """A whole log, for a download. Raises CommandError."""
        try:
            with open(self._path(name), "rb") as stream:
                return stream.read()
        except OSError as fault:
            raise CommandError(f"log {name!r} does not exist") from fault

    def leave(self, client: Client) -> None:
        replay: Optional[Replay] = client.replay
        if replay is not None:
            self._end(replay)
            client.replay = None

    def close(self) -> None:
        """Finish what is being recorded."""
        writer, self._writer = self._writer, None
        if writer is not None:
            writer.close()

    # -- recording -------------------------------------------------------------------------------

    async def _start(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        if self._writer is not None:
            raise EditRefusedError("recording", f"the log {self._name!r} is already being recorded")
        name = message.get("name") or new_name()
        if not _NAME.match(name):
            raise CommandError(f"{name!r} is not a valid log name")
        path = self._more.get(name) or os.path.join(self._folder, name, FILE)
        if os.path.lexists(path):
            raise EditRefusedError("exists", f"log {name!r} already exists")
        self._writer, self._name, self._revision = LogWriter(path), name, -1
        self._hub.count_pose_readers(1)
        self._hub.push(self.state())
        return {"name": name}

    async def _stop(self, _client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        if self._writer is None:
            raise CommandError("no log is being recorded")
        self._tick(*self._hub.current_poses())  # steps made since the last look may have been many
        if self._fetching is not None:
            await self._fetching
            self._tick(*self._hub.current_poses())
        try:
            self.close()
        finally:
            self._hub.count_pose_readers(-1)
            self._hub.push(self.state())
        return {"name": self._name}

    def _tick(self, poses: Optional[Poses], revision: int) -> None:
        writer = self._writer
        if writer is None:
            return
        if revision != self._revision:
            if self._fetching is None:
                self._fetching = asyncio.ensure_future(self._describe(writer))
            return
        if poses is None:
            return
        try:
            writer.poses(poses)
        except CommandError as fault:
            self._end_recording(fault)

    async def _describe(self, writer: LogWriter) -> None:
        """Write the world's description into the log."""
        try:
            message = await self._hub.world_push()
            writer.document(self._hub.simulator.clock.sim_ns * 1e-9, message["document"])
            self._revision = message["revision"]
            self._hub.resend_poses()
        except (CommandError, ValueError) as fault:  # ValueError: it was closed meanwhile
            if self._writer is writer:
                self._end_recording(CommandError(str(fault)))
        finally:
            self._fetching = None

    def _end_recording(self, fault: CommandError) -> None:
        """End the recording after a fault; warn the users and push the new state."""
        self._report(warning("log", f"the log {self._name!r} ends here: {fault}"))
        with contextlib.suppress(CommandError):  # this fault was reported
            self.close()
        self._hub.count_pose_readers(-1)
        self._hub.push(self.state())

    def _list(self, _client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        found: List[Dict[str, Any]] = []
        for name, path in self._paths().items():
            try:
                status = os.stat(path)
            except OSError:
                continue
            found.append({"name": name, "bytes": status.st_size, "modified": status.st_mtime})
        return {"logs": sorted(found, key=lambda log: -float(log["modified"]))}

    def _paths(self) -> Dict[str, str]:
        """Where logs may be, by name: folders may have been renamed to any name."""
        try:
            names = os.listdir(self._folder)
        except OSError:
            names = []
        return {**{name: os.path.join(self._folder, name, FILE) for name in names}, **self._more}

    def _path(self, name: str) -> str:
        """Raises CommandError for a name that is not listed."""
        path = self._paths().get(name)
        if path is None:
            raise CommandError(f"log {name!r} does not exist")
        return path

    # -- playing ---------------------------------------------------------------------------------

    async def _open(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        loop = asyncio.get_running_loop()
        reader = await loop.run_in_executor(self._disk, LogReader, self._path(message["name"]))
        self.leave(client)
        client.live = False
        client.replay = replay = Replay(message["name"], reader)
        client.sent.forget()
        await self._show(client, replay)
        return {"name": replay.name, "begin": reader.begin, "end": reader.end}

    async def _seek(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        replay = self._replay(client)
        replay.time = min(max(message["time"], replay.reader.begin), replay.reader.end)
        await self._show(client, replay)
        return {"time": replay.time}

    async def _play(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        replay = self._replay(client)
        replay.rate = min(max(message["rate"], -100.0), 100.0)
        if replay.rate > 0 and replay.time >= replay.reader.end:
            replay.time = replay.reader.begin
        if replay.rate and (replay.task is None or replay.task.done()):
            replay.task = asyncio.get_running_loop().create_task(self._run(client, replay))
        self._hub.push(replay.push(), [client])
        return {}

    async def _close(self, client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        self._replay(client)
        self.leave(client)
        await self._hub.add_client(client, new=False)
        self._hub.push(self.state(), [client])
        return {}

    async def _run(self, client: Client, replay: Replay) -> None:
        """Play until the end, a pause, or another log."""
        period = 1.0 / self._hub.protocol.limits["frames_hz"]
        loop = asyncio.get_running_loop()
        before = loop.time()
        while client.replay is replay and replay.rate:
            await asyncio.sleep(period)
            now = loop.time()
            wanted = replay.time + (now - before) * replay.rate
            before = now
            replay.time = min(max(wanted, replay.reader.begin), replay.reader.end)
            if wanted != replay.time:
                replay.rate = 0.0
            if client.is_free or not replay.rate:
                await self._show(client, replay)

    async def _show(self, client: Client, replay: Replay) -> None:
        loop = asyncio.get_running_loop()
        number, poses = await loop.run_in_executor(self._disk, replay.reader.seek, replay.time)
        if client.replay is not replay:
            return
        if number != replay.shown:
            document = await loop.run_in_executor(self._disk, self._document, replay, number)
            if client.replay is not replay:
                return
            replay.shown = number
            client.sent.forget()
            self._hub.push({"type": "world", "revision": number, "document": document}, [client])
        self._hub.push(replay.push(), [client])
        frame = client.sent.frame(LOG, number, poses)
        if frame:
            client.append(frame)

    def _document(self, replay: Replay, number: int) -> Dict[str, Any]:
        """A world of a log; the files it names are served from now on, where they may be."""
        text = replay.reader.text(number)
        document: Dict[str, Any] = json.loads(text)
        self._hub.documents.served.serve_again(text, os.path.dirname(document.get("file") or ""))
        return document

    @staticmethod
    def _replay(client: Client) -> Replay:
        replay: Optional[Replay] = client.replay
        if replay is None:
            raise CommandError("no log is open")
        return replay

    @staticmethod
    def _end(replay: Replay) -> None:
        replay.rate = 0.0
        if replay.task is not None:
            replay.task.cancel()
        replay.reader.close()
