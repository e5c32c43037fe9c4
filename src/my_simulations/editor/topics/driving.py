"""Drives robots from a page: velocities on the topic that a robot hears, and a stop in the end."""
from __future__ import annotations

import asyncio
from concurrent.futures import Executor
from typing import Any, Dict, List, Optional, Sequence

from ...errors import CommandError, SimulationError
from ..topic_source import ListedTopic, Publisher, TopicSource
from ..transport.browser_client import Client

KIND = "geometry_msgs/Twist"
_SILENCE_S = 0.5
"""The robot stops if a page sends no command for this time."""

_KEPT_S = 5.0
"""How long a topic is offered after the last command."""


class Drive:
    """A model that a page drives."""

    def __init__(self, topic: str, publisher: Publisher) -> None:
        self.topic, self.publisher = topic, publisher
        self.client = 0
        self.moving = False
        self.timer: Optional[asyncio.TimerHandle] = None


class Driving:
    """All models that pages drive. Of the loop.

    Args:
        source: the topics; None in a world without ROS.
        pool: for what may wait.
    """

    def __init__(self, source: Optional[TopicSource], pool: Executor) -> None:
        self._source, self._pool = source, pool
        self._loop = asyncio.get_running_loop()
        self._drives: Dict[str, Drive] = {}
        self._opening = asyncio.Lock()

    async def drive(self, client: Client, message: Dict[str, Any]) -> Dict[str, Any]:
        """The request `drive`. Raises CommandError for a model that hears no velocities."""
        model, linear, angular = message["model"], message["linear"], message["angular"]
        moving = any((*linear, *angular))
        drive = self._drives.get(model)
        if drive is None:
            async with self._opening:
                drive = self._drives.get(model)
                if drive is None:
                    drive = await self._loop.run_in_executor(self._pool, self._open_drive, model)
                    self._drives[model] = drive
        drive.client, drive.moving = client.number, moving
        self._send(drive, linear, angular)
        if drive.timer is not None:
            drive.timer.cancel()
        drive.timer = self._loop.call_later(_SILENCE_S if moving else _KEPT_S, self._rest, model)
        return {"topic": drive.topic}

    def leave(self, client: Client) -> None:
        """A page has gone: what it drove stops."""
        for model, drive in list(self._drives.items()):
            if drive.client == client.number and drive.moving:
                self._rest(model)

    def close(self) -> None:
        """Stop everything that moves."""
        for model, drive in list(self._drives.items()):
            if drive.moving:
                self._rest(model)
            if drive.timer is not None:
                drive.timer.cancel()
            drive.publisher.close()
        self._drives.clear()

    def _rest(self, model: str) -> None:
        drive = self._drives[model]
        if drive.timer is not None:
            drive.timer.cancel()
        if drive.moving:
            drive.moving = False
            self._send(drive, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
            drive.timer = self._loop.call_later(_KEPT_S, self._rest, model)
            return
        del self._drives[model]
        self._pool.submit(drive.publisher.close)

    def _send(self, drive: Drive, linear: Sequence[float], angular: Sequence[float]) -> None:
        assert self._source is not None
        twist = self._source.message(KIND)
        twist.linear.x, twist.linear.y, twist.linear.z = map(float, linear)
        twist.angular.x, twist.angular.y, twist.angular.z = map(float, angular)
        drive.publisher.send(twist)

    def _open_drive(self, model: str) -> Drive:
        """In a thread of the pool. Raises CommandError."""
        if self._source is None:
            raise CommandError("there are no ROS topics: the simulator runs without ROS")
        try:
            name = velocity_topic(self._source.topics(), model)
            if not name:
                raise CommandError(f"{model} cannot be driven: no node subscribes to its"
                                   f" velocity commands ({KIND})")
            return Drive(name, self._source.publish(name, KIND, 1, False))
        except OSError as fault:
            raise CommandError(f"the ROS master does not respond: {fault}") from fault
        except SimulationError as fault:
            raise CommandError(str(fault)) from fault


def velocity_topic(topics: List[ListedTopic], model: str) -> str:
    """The topic on which a model hears velocities; "" for none.

    That of a plugin of the model, else one below the model's name, else the only one there is that
    belongs to no other model.
    """
    subscribed = [one for one in topics if one.kind == KIND and one.subscribers > 0]
    own = [one.name for one in subscribed if one.model == model and one.driven]
    below = [one.name for one in subscribed if one.name.startswith(f"/{model}/")]
    free = [one.name for one in subscribed if not one.model]
    for found in (own, below):
        if found:
            return min(found, key=lambda name: ("cmd_vel" not in name, len(name), name))
    return free[0] if len(free) == 1 else ""
