"""The node /gazebo of a world that another program steps."""
from __future__ import annotations

import importlib
import threading
from typing import Any, Callable, Dict, Optional, Set, Tuple

import rospy

from ..errors import CommandError
from ..resources.resolver import Resolver
from ..simulator.simulator import Simulator
from .interface import SUBSCRIBES, Row
from .node import Node
from .prompt_end import end_promptly
from .registration import advertise_topic

_NAME = "gazebo"
_CLOCK_QUEUE = 1000
_SERVICE_S = 3600.0   # the caller decides how long an answer may take


class AttachedNode:
    """Offers a running, paused simulator to the ROS graph; only its owner makes steps.

    Args:
        simulator: the simulator.
        resolver: resolves URIs of spawned models.
        master: URI of the master, which must run.
        may_change_world: whether requests of others can change the world.
    """

    def __init__(self, simulator: Simulator, resolver: Resolver, master: str,
                 may_change_world: bool = True) -> None:
        rospy.init_node(_NAME, argv=[_NAME], disable_rostime=True, disable_signals=True,
                        log_level=rospy.WARN)
        end_promptly()
        rospy.set_param("/use_sim_time", True)
        rospy.set_param("~manual_stepping", True)
        clock = advertise_topic("/clock", queue_size=_CLOCK_QUEUE, tcp_nodelay=True)
        self._refused = RefusedRequests(may_change_world)
        self._node = Node(simulator, resolver, clock, None, master, replace=self._refused.replace)
        self._node.advertise()
        self._node.start_publishing()
        self._node.advertise_late()
        self._lock = threading.Lock()
        self._messages: Dict[str, int] = {}
        self._types: Dict[str, str] = {}
        self._answers: Dict[str, str] = {}
        self._subscribers: Dict[str, Any] = {}

    @property
    def topics(self) -> Any:
        """All topics of the graph by name (`TopicGraph`)."""
        return self._node.topic_graph()

    @property
    def refused(self) -> Tuple[str, ...]:
        """Names of the services and topics of /gazebo that were used but are not permitted."""
        return self._refused.used

    def refresh(self) -> None:
        """Keep the registration up to date; call it about once a second."""
        self._node.refresh()

    def wait_for_plugins(self, seconds: float) -> bool:
        """Wait until plugins have published all that is due, s of wall time; False if not yet."""
        return self._node.wait_for_plugins(seconds)

    def watch(self, topic: str) -> None:
        """Count the messages of a topic from now on."""
        def count(message: Any) -> None:
            with self._lock:
                self._messages[topic] = self._messages.get(topic, 0) + 1
                self._types[topic] = str(message._connection_header.get("type", ""))

        if topic not in self._subscribers:
            self._subscribers[topic] = rospy.Subscriber(topic, rospy.AnyMsg, count)

    def message_count(self, topic: str) -> Tuple[int, str]:
        """How many messages of a watched topic have come, and their type."""
        with self._lock:
            return self._messages.get(topic, 0), self._types.get(topic, "")

    def call(self, service: str, type_name: str) -> None:
        """Call a service as soon as it exists, with a default request, in a thread."""
        thread = threading.Thread(target=self._call, args=(service, type_name), daemon=True,
                                  name=f"call {service}")
        thread.start()

    def call_result(self, service: str) -> "str | None":
        """Return why the `call` of a service failed; "" if it succeeded, None while it is open."""
        with self._lock:
            return self._answers.get(service)

    def _call(self, service: str, type_name: str) -> None:
        answer = ""
        try:
            package, _, name = type_name.partition("/")
            kind = getattr(importlib.import_module(f"{package}.srv"), name)
            rospy.wait_for_service(service, _SERVICE_S)
            rospy.ServiceProxy(service, kind)()
        except Exception as fault:  # of the called node, its types or the network
            answer = f"{type(fault).__name__}: {fault}"
        with self._lock:
            self._answers[service] = answer

    def close(self) -> None:
        self._node.stop()
        rospy.signal_shutdown("the world is closed")


STEPPING = "step_world"
"""The service that makes steps."""


class RefusedRequests:
    """Decides which services and topics of the node work, and stores which others were used.

    Only the owner of the world makes steps, so `step_world` is always refused.

    Args:
        may_change_world: whether requests can change the world at all.
    """

    def __init__(self, may_change_world: bool) -> None:
        self._may_change_world = may_change_world
        self._lock = threading.Lock()
        self._used: Set[str] = set()

    @property
    def used(self) -> Tuple[str, ...]:
        """Names of the refused services and topics that were used, sorted."""
        with self._lock:
            return tuple(sorted(self._used))

    def replace(self, row: Row) -> Optional[Callable[..., Any]]:
        """The handler that refuses the requests of a row; None if the row is permitted."""
        if row.name != STEPPING and (self._may_change_world or not row.changes_world):
            return None

        def refuse(*_request: Any) -> str:
            with self._lock:
                self._used.add(row.name)
            if row.direction is SUBSCRIBES:
                return ""     # a message has no response
            raise CommandError(f"/gazebo/{row.name} is not permitted in this world")

        return refuse
