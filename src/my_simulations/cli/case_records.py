"""Writes what happens in an open world to a rosbag."""
from __future__ import annotations

from typing import Any, Dict

from ..errors import CommandError
from ..python_api import OpenWorld
from ..ros.topics.state_buffers import StatesBuffer, pack_time


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

    def record_state(self, world: OpenWorld) -> None:
        layout, sequence, rows = world.simulator.feed.states()
        now = world.simulator.clock.sim_ns
        stamp = self._time(*divmod(max(now, 1), 1000000000))
        revision = layout.revision
        for topic, data in (
                ("/clock", pack_time(now)), ("/gazebo/model_states", self._models.pack(
                    revision, sequence, layout.model_names, layout.model_places, rows)),
                ("/gazebo/link_states", self._links.pack(
                    revision, sequence, layout.link_names, layout.link_places, rows))):
            kind = self._types[topic]
            self._bag.write(topic, (kind._type, data, kind._md5sum, kind), stamp, raw=True)

    def close(self) -> None:
        self._bag.close()
