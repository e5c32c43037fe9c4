"""The request `watch`, and the pushes it asks for."""
from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Dict, Optional, Protocol, Set, Tuple

from ...errors import CommandError
from .browser_client import Client, encoded
from .hub import Hub
from .pose_messages import Poses
from .watched_values import MOST_TOPICS, PLOT, WatchedValues, check_topic
from .web_socket import Route

PREFIX = "ros:"
"""Begins what a page watches of ROS, before the name of the topic."""


class RosTopics(Protocol):
    """What of ROS pages watch (`editor.topics`)."""

    def subscribe(self, client: Client, names: Set[str], plotted: Set[str]) -> None:
        """Subscribe a page to views and to numbers of topics. Raises CommandError."""

    def number_of(self, variable: str) -> Optional[float]:
        """The number of a field now; None before the first message. Raises CommandError."""


class WatchRequests:
    """Reads each topic once for all clients, in a thread of its own, as often as it can.

    Topics of ROS are handed on to `live`.
    """

    def __init__(self, hub: Hub, live: RosTopics) -> None:
        self._hub, self._live = hub, live
        self._watches = WatchedValues(hub.simulator, hub.clock, live.number_of)
        self._thread = ThreadPoolExecutor(1, "editor watches")
        self._due = 0.0
        self._task: "Optional[asyncio.Future[None]]" = None
        self._last_sent: Tuple[int, int] = (-1, -1)
        self._fresh = False
        hub.on_tick.append(self._tick)

    def routes(self) -> Dict[str, Route]:
        return {"watch": Route(self._watch, None)}

    async def _watch(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        topics = list(dict.fromkeys(message["topics"]))
        of_ros = {topic for topic in topics if topic.startswith(PREFIX)}
        if len(topics) > MOST_TOPICS:
            raise CommandError(f"at most {MOST_TOPICS} topics can be watched")
        for topic in topics:
            if topic not in of_ros:
                check_topic(topic)
        plotted = {topic[len(PLOT):].partition(".")[0] for topic in topics
                   if topic.startswith(f"{PLOT}/")}
        self._live.subscribe(client, {topic[len(PREFIX):] for topic in of_ros}, plotted)
        client.topics = set(topics) - of_ros
        self._fresh = True
        self._hub.wake()
        return {"topics": topics}

    def _tick(self, _poses: Optional[Poses], _revision: int) -> None:
        loop = asyncio.get_running_loop()
        if loop.time() < self._due or (self._task is not None and not self._task.done()):
            return
        topics: Set[str] = set()
        for client in self._hub.clients.values():
            if client.live:
                topics |= client.topics
        # Twists and joints are read for frames only when they happen to be.
        self._hub.request_states(self._hub.protocol.limits["watch_hz"] if topics else 0.0)
        simulator = self._hub.simulator
        now = (simulator.clock.step, simulator.feed.latest)
        if not topics or (now == self._last_sent and not self._fresh):
            return
        self._last_sent, self._fresh = now, False
        self._due = loop.time() + 1.0 / self._hub.protocol.limits["watch_hz"]
        self._task = asyncio.ensure_future(self._send(topics))

    async def _send(self, topics: Set[str]) -> None:
        loop = asyncio.get_running_loop()
        try:
            pushes = await loop.run_in_executor(self._thread, self._watches.pushes, topics)
        except CommandError:
            return  # no engine for the moment; the next tick asks again
        texts = {topic: encoded(push) for topic, push in pushes.items()}
        self._hub.check(pushes.values())
        for client in self._hub.clients.values():
            for topic in client.topics & topics if client.live and not client.is_full else ():
                client.append(texts[topic])
