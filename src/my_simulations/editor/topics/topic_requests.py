"""The requests about ROS topics."""
from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Dict, List, Optional

from ...errors import CommandError, SimulationError
from ..topic_source import ListedTopic, TopicSource
from ..transport.browser_client import Client
from ..transport.hub import Hub
from ..transport.web_socket import Route
from .driving import Driving
from .live_topics import LiveTopic, LiveTopics
from .message_fields import numeric_fields
from .topic_frame import document_of


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
        """By type of message."""
        return {"topics": Route(self._topics, None), "drive": Route(self._driving.drive, None),
                "viewed": Route(self._viewed, None), "topic_fields": Route(self._fields, None)}

    def leave(self, client: Client) -> None:
        """A page has gone."""
        self.live.leave(client)
        self._driving.leave(client)

    def close(self) -> None:
        """Stop what is driven; hear nothing any more."""
        self._driving.close()
        self.live.close()
        self._pool.shutdown(wait=False)

    async def _viewed(self, client: Client, message: Dict[str, Any]) -> None:
        self.live.viewed(client, message["topic"])

    async def _topics(self, _client: Client, _message: Dict[str, Any]) -> Dict[str, Any]:
        if self._source is None:
            return {"available": False, "topics": []}
        loop = asyncio.get_running_loop()
        try:
            listed = await loop.run_in_executor(self._pool, self._source.topics)
        except OSError as fault:
            raise CommandError(f"the ROS master does not respond: {fault}") from fault
        heard = self.live.traffic()
        return {"available": True,
                "topics": [_document(one, heard.get(one.name)) for one in _ordered(listed)]}


    async def _fields(self, _client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        loop = asyncio.get_running_loop()
        try:
            return {"fields": await loop.run_in_executor(self._pool, self._fields_of,
                                                         message["topic"])}
        except OSError as fault:
            raise CommandError(f"the ROS master does not respond: {fault}") from fault

    def _fields_of(self, name: str) -> List[str]:
        """In a thread of the pool. Raises CommandError for an unknown topic or type."""
        source = self._source
        kind = next((one.kind for one in source.topics() if one.name == name), "") if source else ""
        if source is None or kind in ("", "*"):
            raise CommandError(f"unknown topic {name!r}")
        try:
            return numeric_fields(self.live.newest(name) or source.message(kind), source.message)
        except SimulationError as fault:
            raise CommandError(str(fault)) from fault


def _ordered(listed: List[ListedTopic]) -> List[ListedTopic]:
    return sorted(listed, key=lambda one: one.name)


def _document(one: ListedTopic, heard: Optional[LiveTopic]) -> Dict[str, Any]:
    found = document_of(one)
    if heard is not None and heard.subscription is not None:
        found.update(hz=heard.hz, bytes_per_s=heard.bytes_per_s)
    return found
