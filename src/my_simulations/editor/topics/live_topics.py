"""Topics that pages show: subscribed to while one does, sent as often as each page accepts.

If messages arrive faster than they are shown, only the newest one is converted. A page receives the
next view of a topic after it has shown the one before, so a slow page does not delay others.
"""
from __future__ import annotations

import asyncio
import contextlib
from concurrent.futures import Executor
from typing import Any, Callable, Dict, List, Optional, Set

from ...errors import CommandError, SimulationError
from ..topic_source import Subscription, TopicSource, type_of
from ..transport.browser_client import Client, encode_message
from ..transport.hub import Hub
from ..transport.watch_requests import PREFIX
from .message_fields import number_at
from .message_views import Viewer
from .topic_frame import encode_frame

_LOOK_S = 1.0
"""How soon a topic with its first publisher is found."""


class LiveTopic:
    """One topic, and who looks at it. Of the loop, but for `receive`."""

    def __init__(self, name: str, notify: Callable[["LiveTopic"], None]) -> None:
        self.name = name
        self.clients: Dict[int, int] = {}
        self.unshown: Set[int] = set()
        self.plotters: Set[int] = set()
        self.viewer: Optional[Viewer] = None
        self.subscription: Optional[Subscription] = None
        self.opening = self.closed = False
        self.problem = ""
        self.received = 0
        self.due = 0.0
        self.frame: bytes = b""
        self.shown = 0
        self.task: "Optional[asyncio.Future[None]]" = None
        self.hz, self.bytes_per_s = 0.0, 0.0
        self._counted = (0.0, 0, 0)
        self._on_message = False
        self._notify = notify

    def receive(self, message: Any) -> None:
        """Pass a message to the viewer; from any thread."""
        if self.viewer is None:
            return
        self.viewer.receive(message)
        self.received += 1
        if not self._on_message:
            self._on_message = True
            self._notify(self)

    def clear_notification(self) -> None:
        self._on_message = False

    def count(self, now: float) -> None:
        """Measure rate and bandwidth since the last call."""
        before, received, size = self._counted
        total = self.subscription.received_bytes if self.subscription is not None else 0
        if before and now > before:
            self.hz = (self.received - received) / (now - before)
            self.bytes_per_s = max(0.0, (total - size) / (now - before))
        self._counted = (now, self.received, total)


class LiveTopics:
    """All topics that pages look at.

    Args:
        hub: knows the pages.
        source: the topics; None in a world without ROS.
        pool: for what may wait.
    """

    def __init__(self, hub: Hub, source: Optional[TopicSource], pool: Executor) -> None:
        self._hub, self._source, self._pool = hub, source, pool
        self._loop = asyncio.get_running_loop()
        self._topics: Dict[str, LiveTopic] = {}
        self._period = 1.0 / hub.protocol.limits["view_hz"]

    def subscribe(self, client: Client, names: Set[str], plotted: Set[str]) -> None:
        """Subscribe a page to the views of topics, and to numbers of topics.

        Replaces what the page wanted before. Raises CommandError without ROS.
        """
        if (names or plotted) and self._source is None:
            raise CommandError("there are no ROS topics: the simulator runs without ROS")
        for name in plotted:
            self._topic(name).plotters.add(client.number)
        for name in names:
            topic = self._topic(name)
            if client.number not in topic.clients:
                topic.clients[client.number] = 0
                if topic.problem:
                    self._send_problem(topic, [client])
                self._serve(topic)
        for topic in list(self._topics.values()):
            if topic.name not in plotted:
                topic.plotters.discard(client.number)
            if topic.name not in names:
                self._remove_client(topic, client)

    def newest(self, name: str) -> Any:
        """The newest message of a topic that a page wants; None before the first. Of any thread.

        Raises CommandError if none can be received.
        """
        topic = self._topics.get(name)
        if topic is None:
            return None
        if topic.problem:
            raise CommandError(topic.problem)
        return topic.viewer.newest if topic.viewer is not None else None

    def number_of(self, variable: str) -> Optional[float]:
        """The number that `/TOPIC.FIELD` has now; None before the first message. Of any thread.

        Raises CommandError: there is no such number.
        """
        name, _, field = variable.partition(".")
        message = self.newest(name)
        return None if message is None else number_at(message, field)

    def leave(self, client: Client) -> None:
        for topic in list(self._topics.values()):
            topic.plotters.discard(client.number)
            self._remove_client(topic, client)

    def mark_shown(self, client: Client, name: str) -> None:
        """Send the next message of a topic to a page that has shown the one before."""
        topic = self._topics.get(name)
        if topic is not None:
            topic.unshown.discard(client.number)
            self._serve(topic)

    def traffic(self) -> Dict[str, LiveTopic]:
        """The subscribed topics, with their message rates."""
        now = self._loop.time()
        for topic in self._topics.values():
            topic.count(now)
        return self._topics

    def close(self) -> None:
        for topic in list(self._topics.values()):
            self._drop(topic)

    # -- subscribing -----------------------------------------------------------------------------

    def _remove_client(self, topic: LiveTopic, client: Client) -> None:
        topic.clients.pop(client.number, None)
        topic.unshown.discard(client.number)
        if not topic.clients and not topic.plotters:
            self._drop(topic)

    def _drop(self, topic: LiveTopic) -> None:
        topic.closed = True
        self._topics.pop(topic.name, None)
        if topic.subscription is not None:
            self._pool.submit(topic.subscription.close)

    def _topic(self, name: str) -> LiveTopic:
        topic = self._topics.get(name)
        if topic is None:
            topic = self._topics[name] = LiveTopic(name, self._on_message)
            asyncio.ensure_future(self._subscribe(topic))
        return topic

    async def _subscribe(self, topic: LiveTopic) -> None:
        """Look for the topic's type until it is known, then subscribe to it."""
        while not topic.closed:
            try:
                found = await self._loop.run_in_executor(self._pool, self._open, topic)
            except OSError as fault:
                self._fail(topic, f"the ROS master does not respond: {fault}")
            except SimulationError as fault:
                self._fail(topic, str(fault))
                return
            else:
                if found is not None:
                    topic.subscription, topic.problem = found, ""
                    if topic.closed:
                        self._pool.submit(found.close)
                    return
                self._fail(topic, "no node publishes it yet")
            await asyncio.sleep(_LOOK_S)

    def _open(self, topic: LiveTopic) -> Optional[Subscription]:
        """In a thread of the pool."""
        assert self._source is not None
        kind = type_of(self._source, topic.name)
        if not kind:
            return None
        topic.viewer = Viewer(kind, self._sim_time)
        return self._source.receive(topic.name, kind, topic.receive)

    def _sim_time(self) -> float:
        return self._hub.simulator.clock.sim_ns * 1e-9

    def _fail(self, topic: LiveTopic, problem: str) -> None:
        if topic.problem != problem:
            topic.problem = problem
            self._send_problem(topic, self._clients_of(topic))

    def _send_problem(self, topic: LiveTopic, clients: List[Client]) -> None:
        push = {"type": "watch", "topic": PREFIX + topic.name, "time": 0.0,
                "problem": topic.problem}
        self._hub.check([push])
        for client in clients:
            client.append(encode_message(push))

    def _clients_of(self, topic: LiveTopic) -> List[Client]:
        known = self._hub.clients
        return [known[number] for number in topic.clients if number in known]

    # -- sending ---------------------------------------------------------------------------------

    def _on_message(self, topic: LiveTopic) -> None:
        with contextlib.suppress(RuntimeError):  # the server has ended
            self._loop.call_soon_threadsafe(self._serve_message, topic)

    def _serve_message(self, topic: LiveTopic) -> None:
        topic.clear_notification()
        self._serve(topic)

    def _serve(self, topic: LiveTopic) -> None:
        """Send the newest view to who may have it, now or when it is time."""
        if topic.closed or (topic.task is not None and not topic.task.done()):
            return
        if any(topic.clients[client.number] < topic.received for client in self._ready(topic)):
            topic.task = asyncio.ensure_future(self._send(topic))

    def _ready(self, topic: LiveTopic) -> List[Client]:
        return [client for client in self._clients_of(topic)
                if client.number not in topic.unshown and not client.is_full]

    async def _send(self, topic: LiveTopic) -> None:
        await asyncio.sleep(max(0.0, topic.due - self._loop.time()))
        number = topic.received
        if number != topic.shown:
            topic.due = self._loop.time() + self._period
            try:
                topic.frame = await self._loop.run_in_executor(self._pool, self._frame, topic)
            except SimulationError as fault:
                topic.frame = b""
                self._fail(topic, str(fault))
            else:
                topic.problem = ""
            topic.shown = number
        for client in self._ready(topic):
            if topic.clients[client.number] < number:
                topic.clients[client.number] = number
                if topic.frame:
                    topic.unshown.add(client.number)
                    client.append(topic.frame)
        if topic.received > number:
            self._loop.call_soon(self._serve, topic)

    def _frame(self, topic: LiveTopic) -> bytes:
        """In a thread of the pool."""
        assert topic.viewer is not None
        frame, stamp, (fields, payload) = topic.viewer.view()
        head = {"topic": topic.name, "frame": frame, "stamp": stamp, "view": fields}
        self._hub.check_view(head)
        return encode_frame(head, payload)
