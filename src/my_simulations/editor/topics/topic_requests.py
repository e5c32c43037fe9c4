"""The requests about ROS topics."""
from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Optional, TypeVar

from ...errors import CommandError, SimulationError
from ..topic_source import ListedTopic, TopicSource, type_of
from ..transport.browser_client import Client
from ..transport.hub import Hub
from ..transport.web_socket import Route
from .driving import Driving
from .live_topics import LiveTopic, LiveTopics
from .message_fields import numeric_fields
from .topic_frame import document_of

_Result = TypeVar("_Result")


class TopicRequests:
    """Lists topics, views them, drives robots.

    Attributes:
        live: the topics that pages look at.
    """

    def __init__(self, hub: Hub, source: Optional[TopicSource]) -> None:
        self._source = source
        self._pool = ThreadPoolExecutor(3, "editor topics")
        self.live = LiveTopics(hub, source, self._pool)
        self._driving = Driving(source, self._pool)

    def routes(self) -> Dict[str, Route]:
        return {"topics": Route(self._topics, None), "drive": Route(self._driving.drive, None),
                "viewed": Route(self._viewed, None), "topic_fields": Route(self._fields, None)}

    def leave(self, client: Client) -> None:
        self.live.leave(client)
        self._driving.leave(client)

    def close(self) -> None:
        """Stop all driven models, and end all subscriptions."""
        self._driving.close()
        self.live.close()
        self._pool.shutdown(wait=False)

    async def _viewed(self, client: Client, message: Dict[str, Any]) -> None:
        self.live.mark_shown(client, message["topic"])

    async def _topics(self, _client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        if self._source is None:
            return {"available": False, "topics": []}
        listed = sorted(await self._in_pool(self._source.topics), key=lambda one: one.name)
        subscribed = self.live.traffic()
        return {"available": True,
                "topics": [_document(one, subscribed.get(one.name)) for one in listed]}

    async def _fields(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        return {"fields": await self._in_pool(lambda: self._fields_of(message["topic"]))}

    async def _in_pool(self, call: Callable[[], _Result]) -> _Result:
        """Call a function that may wait for the master. Raises CommandError without an answer."""
        try:
            return await asyncio.get_running_loop().run_in_executor(self._pool, call)
        except OSError as fault:
            raise CommandError(f"the ROS master does not respond: {fault}") from fault

    def _fields_of(self, name: str) -> List[str]:
        """In a thread of the pool. Raises CommandError for an unknown topic or type."""
        source = self._source
        kind = type_of(source, name) if source is not None else ""
        if source is None or not kind:
            raise CommandError(f"unknown topic {name!r}")
        try:
            return numeric_fields(self.live.newest(name) or source.message(kind), source.message)
        except SimulationError as fault:
            raise CommandError(str(fault)) from fault


def _document(one: ListedTopic, subscribed: Optional[LiveTopic]) -> Dict[str, Any]:
    found = document_of(one)
    if subscribed is not None and subscribed.subscription is not None:
        found.update(hz=subscribed.hz, bytes_per_s=subscribed.bytes_per_s)
    return found
