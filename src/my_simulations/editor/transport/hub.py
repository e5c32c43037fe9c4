"""The clients of one world: what all of them are told, and when.

Everything here runs in the server's event loop, but for what is said to be safe from any thread.
"""
from __future__ import annotations

import asyncio
import functools
import time
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Deque, Dict, Iterable, List, Optional, Tuple

from ...errors import CommandError, Issue, error
from ...simulator.simulator import Simulator
from ..scene.scene_changes import Mirror
from ..scene.scene_json import Documents
from .browser_client import Client, encode_message
from .clock_statistics import ClockStatistics
from .error_messages import issue_document
from .pose_messages import LIVE, Poses
from .pose_reader import PoseReader
from .protocol import Protocol

_MOST_ISSUES = 100
_TICK = 1e-3           # s between the times of two issues, at least
_DEMAND = "editor"
_IDLE_S = 1.0
_IDLE_PERIOD_S = 0.2
"""How often a world that stands still, and has for `_IDLE_S`, is looked at.

Waking a sleeping processor costs more than the look does. What pages do ends the quiet at once.
"""


class Hub:
    """Tells clients of changes, poses, time and issues.

    Args:
        simulator: the world.
        documents: makes documents.
        protocol: gives the rates.
        check: hold what is sent to the protocol.

    Attributes:
        clients: by number.
        on_tick: hear of each look at the world: its poses, None where none moved, and revision.
        greetings: each makes a push for a client that comes, or comes back.
    """

    def __init__(self, simulator: Simulator, documents: Documents, protocol: Protocol,
                 check: bool = False) -> None:
        self.simulator = simulator
        self.protocol = protocol
        self.documents = documents
        self.clients: Dict[int, Client] = {}
        self.on_tick: List[Callable[[Optional[Poses], int], None]] = []
        self.greetings: List[Callable[[], Dict[str, Any]]] = []
        self.clock = ClockStatistics(simulator)
        self._check = check
        self._mirror = Mirror(simulator, documents)
        self._loop = asyncio.get_running_loop()
        self._writer = ThreadPoolExecutor(1, "editor documents")
        self._woken = asyncio.Event()
        self._changed_at = 0.0
        self._sequence = -1
        self._listeners = 0
        self._states_hz = 0.0
        self._stats_due = 0.0
        self._issues: Deque[Dict[str, Any]] = deque(maxlen=_MOST_ISSUES)
        self._issue_time = 0.0
        self._poses: Optional[Poses] = None
        self._reader = PoseReader(simulator)

    # -- telling ---------------------------------------------------------------------------------

    def push(self, message: Dict[str, Any], to: Optional[Iterable[Client]] = None) -> None:
        self.check([message])
        text = encode_message(message)
        for client in list(self.clients.values()) if to is None else to:
            client.append(text)

    def check(self, messages: Iterable[Dict[str, Any]]) -> None:
        """Hold pushes to the protocol where that was asked for. Raises ProtocolError."""
        for message in messages if self._check else ():
            self.protocol.check_push(message)

    def check_view(self, head: Dict[str, Any]) -> None:
        """Hold the head of a topic's view to the protocol, as `check`."""
        if self._check:
            self.protocol.types.check(head, "TopicHead", "view")

    def push_soon(self, message: Dict[str, Any]) -> None:
        """As `push` to all; safe from any thread."""
        self._soon(self.push, message)

    def show_issue(self, issue: Issue) -> None:
        """Show an issue to everybody, and to who comes later; safe from any thread."""
        self._soon(self._show_issue, issue)

    def show_issue_to(self, issue: Issue, numbers: Iterable[int]) -> None:
        """Show an issue to these clients alone; safe from any thread."""
        message = {"type": "issue", "issue": issue_document(issue)}
        self._soon(self._push_some, message, list(numbers))

    def wake(self) -> None:
        """Something may have changed: look now; safe from any thread."""
        self._soon(self._woken.set)

    def note_activity(self) -> None:
        """A page does something: look often again."""
        quiet, self._changed_at = self._is_idle(), self._loop.time()
        if quiet:
            self._woken.set()

    def stats_soon(self) -> None:
        """Send the statistics as soon as possible; safe from any thread."""
        self._stats_due = 0.0
        self.wake()

    def _soon(self, call: Callable[..., object], *arguments: Any) -> None:
        try:
            self._loop.call_soon_threadsafe(functools.partial(call, *arguments))
        except RuntimeError:
            return  # the server has ended

    def _push_some(self, message: Dict[str, Any], numbers: List[int]) -> None:
        self.push(message, [self.clients[number] for number in numbers
                            if number in self.clients])

    def _show_issue(self, issue: Issue) -> None:
        # A page that is loaded again compares the time with that of the last issue it has shown: it
        # must grow, whatever the clock does.
        self._issue_time = max(time.time(), self._issue_time + _TICK)
        message = {"type": "issue", "issue": issue_document(issue), "time": self._issue_time}
        self._issues.append(message)
        self.push(message)

    # -- coming and going ------------------------------------------------------------------------

    async def add_client(self, client: Client, new: bool) -> None:
        """Give a client the world, and from then on all of its changes."""
        if self._mirror.revision < 0:
            await self.push_changes()
        world = await self._loop.run_in_executor(self._writer, self._encoded_world)
        client.append(world)
        client.sent.forget()
        client.live = True
        self._sequence = -1
        self.push(self.clock.read(), [client])
        for message in list(self._issues) if new else ():
            self.push(message, [client])
        for greeting in self.greetings:
            self.push(greeting(), [client])
        self._woken.set()

    async def world_push(self) -> Dict[str, Any]:
        """The push `world`, of now."""
        return await self._loop.run_in_executor(self._writer, self._mirror.world_push)

    def resend_poses(self) -> None:
        """Let the next tick come with all poses, moved or not."""
        self._sequence = -1
        self._woken.set()

    def count_pose_readers(self, change: int) -> None:
        """Add to the number of clients that read poses; negative for fewer."""
        self._listeners += change
        self._request_rates()
        self._sequence = -1
        self._woken.set()

    def request_states(self, states_hz: float) -> None:
        """Set how often the engine reads whole states, not only poses, for connected clients."""
        if states_hz != self._states_hz:
            self._states_hz = states_hz
            self._request_rates()

    def _request_rates(self) -> None:
        rate = self.protocol.limits["frames_hz"]
        self.simulator.feed.request(_DEMAND, poses_hz=rate if self._listeners else 0.0,
                                  states_hz=self._states_hz if self._listeners else 0.0)

    def current_poses(self) -> Tuple[Optional[Poses], int]:
        """All poses of now, and the revision of the world that clients know.

        None for the poses while names have changed that clients have not heard of.
        """
        revision = self._mirror.revision
        return self._reader.read(revision, self.clock.real_ns * 1e-9), revision

    # -- the loop --------------------------------------------------------------------------------

    async def run(self) -> None:
        """Look after the world until cancelled."""
        period = 1.0 / self.protocol.limits["frames_hz"]
        while True:
            if not self._listeners:
                await self._woken.wait()
                self._woken.clear()
                continue
            started = self._loop.time()
            self._woken.clear()
            try:
                await self._tick()
            except CommandError as fault:
                self._show_issue(error("editor-view", str(fault)))
                await asyncio.sleep(1.0)
            except Exception as defect:
                # Whatever is wrong with one look at the world, the next one may go well.
                self._show_issue(error("editor-defect", "the editor failed to follow the world: "
                                 f"{type(defect).__name__}: {defect}"))
                self._loop.call_exception_handler(
                    {"message": "the editor failed to follow the world", "exception": defect})
                await asyncio.sleep(1.0)
            await self._pause(started + (_IDLE_PERIOD_S if self._is_idle() else period))

    def _is_idle(self) -> bool:
        """Whether nothing has happened for a while, and nothing will by itself."""
        return self.simulator.clock.paused and self._loop.time() > self._changed_at + _IDLE_S

    async def _pause(self, until: float) -> None:
        left = until - self._loop.time()
        if left <= 0.0:
            await asyncio.sleep(0)
            return
        timer = self._loop.call_later(left, self._woken.set)
        await self._woken.wait()
        timer.cancel()

    async def _tick(self) -> None:
        if self.simulator.models.revision != self._mirror.revision:
            await self.push_changes()
        sequence = self.simulator.feed.changes
        moved = sequence != self._sequence or self._has_late_client()
        if moved:
            self._changed_at = self._loop.time()
            self._sequence = sequence
            # None: names have changed that clients have not heard of.
            self._poses, _ = self.current_poses()
            if self._poses is None:
                self._sequence = -1
            self._send_poses()
        for listener in self.on_tick:
            listener(self._poses if moved else None, self._mirror.revision)
        if self._loop.time() >= self._stats_due:
            self._stats_due = self._loop.time() + 1.0 / self.protocol.limits["stats_hz"]
            change = self.clock.changes()
            if change is not None:
                self.push(change, self._live_clients())

    def _live_clients(self) -> List[Client]:
        return [client for client in self.clients.values() if client.live]

    def _has_late_client(self) -> bool:
        """Whether some client could not take its last frame."""
        return any(client.live and client.sent.late for client in self.clients.values())

    async def push_changes(self) -> None:
        """Tell everybody what has changed in the description."""
        change = await self._loop.run_in_executor(self._writer, self._mirror.changes)
        if change is None:
            return
        live = self._live_clients()
        self.push(change.push, live)
        for client in live:
            client.sent.forget(change.links)
        self._sequence = -1

    def _encoded_world(self) -> str:
        message = self._mirror.world_push()
        self.check([message])
        return encode_message(message)

    def _send_poses(self) -> None:
        poses = self._poses
        for client in self.clients.values():
            if not client.live:
                continue
            client.sent.late = poses is None or not client.is_free
            if poses is not None and client.is_free:
                frame = client.sent.frame(LIVE, self._mirror.revision, poses)
                if frame:
                    client.append(frame)
