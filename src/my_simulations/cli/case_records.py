"""Writes what happens in an open world to a rosbag, or to a state log of the editor."""
from __future__ import annotations

import contextlib
import os
from typing import Any, Dict, Optional

from ..editor.logs.state_log import LogWriter
from ..editor.scene.scene_changes import Mirror
from ..editor.scene.scene_json import Documents
from ..editor.transport.pose_reader import PoseReader
from ..errors import CommandError
from ..python_api import OpenWorld
from ..resources.resolver import Resolver
from ..ros.topics.state_buffers import StatesBuffer, packed_time


class BagRecord:
    """A rosbag with `/clock`, `/gazebo/model_states` and `/gazebo/link_states`.

    Stamps are sim time. At sim time 0, which no bag can hold, messages are stamped 1 ns.

    Args:
        path: the file; one that is there is replaced.

    Raises:
        CommandError: ROS's rosbag is not there, or the file cannot be written.
    """

    def __init__(self, path: str) -> None:
        try:
            import genpy
            import rosbag
            from gazebo_msgs.msg import LinkStates, ModelStates
            from rosgraph_msgs.msg import Clock
        except ImportError as fault:
            raise CommandError("a rosbag needs ROS: source the setup.bash of your workspace"
                               f" ({fault})") from None
        self._time = genpy.Time
        self._types: Dict[str, Any] = {"/clock": Clock, "/gazebo/model_states": ModelStates,
                                       "/gazebo/link_states": LinkStates}
        self._models, self._links = StatesBuffer(), StatesBuffer()
        try:
            self._bag = rosbag.Bag(path, "w")
        except OSError as fault:
            raise CommandError(f"{path} cannot be written: {fault.strerror}") from None

    def look(self, world: OpenWorld) -> None:
        """Add the present state."""
        layout, sequence, rows = world.simulator.feed.states()
        now = world.simulator.clock.sim_ns
        stamp = self._time(*divmod(max(now, 1), 1000000000))
        revision = layout.revision
        for topic, data in (
                ("/clock", packed_time(now)),
                ("/gazebo/model_states", self._models.pack(
                    revision, sequence, layout.model_names, layout.model_places, rows)),
                ("/gazebo/link_states", self._links.pack(
                    revision, sequence, layout.link_names, layout.link_places, rows))):
            kind = self._types[topic]
            self._bag.write(topic, (kind._type, data, kind._md5sum, kind), stamp, raw=True)

    def close(self) -> None:
        """Finish the file."""
        self._bag.close()


class LogRecord:
    """A state log, which the editor plays.

    Args:
        path: the file; one that is there is replaced.

    Raises:
        CommandError: it cannot be written; also from `look` and `close`.
    """

    def __init__(self, path: str) -> None:
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
        self._writer = LogWriter(os.path.abspath(path))
        self._documents = Documents(Resolver.from_environment())
        self._reader: Optional[PoseReader] = None
        self._revision = -1

    def look(self, world: OpenWorld) -> None:
        """Add the present state; of one world only."""
        simulator = world.simulator
        self._reader = self._reader or PoseReader(simulator)
        if simulator.models.revision != self._revision:
            message = Mirror(simulator, self._documents).whole()
            self._writer.document(simulator.clock.sim_ns * 1e-9, message["document"])
            self._revision = message["revision"]
        poses = self._reader.read(self._revision, 0.0)
        if poses is not None:
            self._writer.poses(poses)

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()
