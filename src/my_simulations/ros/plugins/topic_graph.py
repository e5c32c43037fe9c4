"""All topics of the ROS graph, for the world editor: listed, heard and offered by name."""
from __future__ import annotations

import contextlib
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Set, Tuple

import genpy
import rospy

from ...geometry import IDENTITY, Pose, compose
from ...plugins.graph import TopicUse
from .ros_graph import RosGraph

_CAMERAS = frozenset(("camera", "depth", "rgbd", "multicamera", "wideanglecamera"))
_CLOUDS = frozenset(("sensor_msgs/PointCloud", "sensor_msgs/PointCloud2"))
_OPTICAL = Pose(orientation=(-0.5, 0.5, -0.5, 0.5))
"""Axes of a camera's data: x right, y down, z forward (REP 103), in those of its sensor."""


class ListedTopic(NamedTuple):
    """A topic of the graph.

    Attributes:
        name: with a leading slash.
        kind: type; "" if it is unknown.
        publishers, subscribers: how many nodes.
        model: the model whose plugin offers or hears it; "" for others.
        driven: whether a plugin of the model hears it.
        link: the link that carries the sensor whose data it is; "" for others.
        pose: where in that link the data's axes are.
    """

    name: str
    kind: str
    publishers: int
    subscribers: int
    model: str = ""
    driven: bool = False
    link: str = ""
    pose: Pose = IDENTITY


class TopicSubscription:
    """A subscription to a topic, which counts the received bytes."""

    def __init__(self, subscriber: rospy.Subscriber) -> None:
        self._subscriber = subscriber

    @property
    def received_bytes(self) -> int:
        implementation = self._subscriber.impl
        if implementation is None:
            return 0
        return sum(int(one.stat_bytes) for one in list(implementation.connections or ()))

    def close(self) -> None:
        with contextlib.suppress(OSError):  # the master has gone
            self._subscriber.unregister()


class TopicGraph(RosGraph):
    """Topics by name.

    Args:
        uses: the topics of all plugins.
        ask: calls a method of the master's API; returns the value. Raises OSError.
    """

    def __init__(self, uses: Callable[[], Iterable[TopicUse]], ask: Callable[[str], Any]) -> None:
        super().__init__()
        self._uses, self._ask = uses, ask

    def topics(self) -> List[ListedTopic]:
        """All topics with a publisher or subscriber. Raises OSError."""
        state: Any = self._ask("getSystemState") or ([], [], [])
        kinds: Dict[str, str] = dict(self._ask("getTopicTypes") or ())
        return list_topics(state, kinds, self._uses(), rospy.resolve_name)

    def receive(self, name: str, kind: str, call: Callable[[Any], None]) -> TopicSubscription:
        """Subscribe. Raises MissingTypeError."""
        # rospy shares one connection among the subscribers of a process: its queue is left as the
        # one who came first has made it, so a plugin that hears the topic loses nothing.
        made = self._type(kind, "msg")

        def take(message: Any) -> None:
            read = _decode_message(message, made) if isinstance(message, rospy.AnyMsg) else message
            if read is not None:
                call(read)

        return TopicSubscription(rospy.Subscriber(name, made, take, tcp_nodelay=True))


def _decode_message(message: rospy.AnyMsg, made: Any) -> Any:
    """A message whose first subscriber in this process asked for any type; None for other types."""
    if message._connection_header.get("md5sum") != made._md5sum:
        return None
    try:
        return made().deserialize(message._buff)
    except genpy.DeserializationError:
        return None


def list_topics(state: Tuple[Any, Any, Any], kinds: Dict[str, str], uses: Iterable[TopicUse],
                resolve: Callable[[str], str]) -> List[ListedTopic]:
    """List all topics: those of the master, with the types and users that plugins add.

    Args:
        state: publishers, subscribers, services: lists of (name, nodes).
        kinds: types by topic.
        uses: topics of plugins.
        resolve: remaps a name.
    """
    publishers = {name: len(nodes) for name, nodes in state[0]}
    subscribers = {name: len(nodes) for name, nodes in state[1]}
    of_plugins: Dict[str, List[TopicUse]] = {}
    for use in uses:
        of_plugins.setdefault(resolve(use.name), []).append(use)
    found = []
    for name in sorted({*publishers, *subscribers}):
        mine = of_plugins.get(name, [])
        kind = kinds.get(name, "")
        if kind in ("", "*") and mine:
            kind = mine[0].kind
        found.append(ListedTopic(name, "" if kind == "*" else kind, publishers.get(name, 0),
                                 subscribers.get(name, 0), *_of_plugins(mine)))
    return found


def _of_plugins(uses: List[TopicUse]) -> Tuple[str, bool, str, Pose]:
    models: Set[str] = {use.model for use in uses}
    if len(models) != 1:
        return "", False, "", IDENTITY  # of no robot, or of several ones
    driven = any(use.is_subscription for use in uses)
    sensor = next((use for use in uses if use.link and not use.is_subscription), None)
    if sensor is None:
        return models.pop(), driven, "", IDENTITY
    optical = sensor.sensor in _CAMERAS and sensor.kind in _CLOUDS
    return (models.pop(), driven, sensor.link,
            compose(sensor.pose, _OPTICAL) if optical else sensor.pose)
