"""Writes what happens in a world of a Python program to a state log."""
from __future__ import annotations

import contextlib
import os
from typing import List, Optional, Sequence

from ...python_api import OpenWorld
from ...resources.resolver import Resolver
from ..scene.scene_changes import Mirror
from ..scene.scene_json import Documents
from ..topic_source import TopicSource
from ..transport.pose_reader import PoseReader
from .log_channels import ContactChannel, LogChannel, TopicChannel
from .state_log import LogWriter


class LogRecord:
    """A state log, which the editor plays.

    Args:
        path: the file; one that is there is replaced.

    Raises:
        CommandError: it cannot be written; also from `record_state` and `close`.
    """

    def __init__(self, path: str) -> None:
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
        self._writer = LogWriter(os.path.abspath(path))
        self._documents = Documents(Resolver.from_environment())
        self._reader: Optional[PoseReader] = None
        self._contacts: Optional[ContactChannel] = None
        self._topics: List[LogChannel] = []
        self._revision = -1

    def record_state(self, world: OpenWorld) -> None:
        """Add the present state; of one world only."""
        simulator = world.simulator
        self._reader = self._reader or PoseReader(simulator)
        if simulator.models.revision != self._revision:
            message = Mirror(simulator, self._documents).world_push()
            self._writer.document(simulator.clock.sim_ns * 1e-9, message["document"])
            self._revision = message["revision"]
        poses = self._reader.read(self._revision, 0.0)
        if poses is not None:
            self._writer.poses(poses)
            self._contacts = self._contacts or ContactChannel(simulator)
            for channel in (self._contacts, *self._topics):
                channel.write(self._writer, poses.sim_time)

    def record_topics(self, world: OpenWorld, source: TopicSource, names: Sequence[str],
                      most_bytes: float) -> None:
        """Record messages of topics of ROS from now on, until `end_topics`.

        Args:
            world: whose states are recorded.
            source: the topics.
            names: with a leading slash; they need not exist yet.
            most_bytes: of all messages; those that follow are left out.
        """
        clock = world.simulator.clock
        self._topics.append(TopicChannel(source, names, lambda: clock.sim_ns * 1e-9, most_bytes))

    def end_topics(self) -> None:
        """End all subscriptions, before the source of the topics ends."""
        while self._topics:
            self._topics.pop().close()

    def close(self) -> None:
        self.end_topics()
        self._writer.close()
