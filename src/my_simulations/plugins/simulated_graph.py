"""Topics, services and parameters of one plugin in a running simulator."""
from __future__ import annotations

import threading
from collections import deque
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

from ..geometry import Pose
from .checked_arguments import check_pose
from .context import PluginError, RequestError
from .graph import Graph, GraphHandle, MissingTypeError, ServiceTakenError, Topic, TransformOf
from .message_maker import PendingMessage

_LOOK_S = 0.2   # interval of checks whether the plugin of a service call still exists


class PluginTopic:
    """A topic of a plugin; its messages are sent after the engine has resumed."""

    def __init__(self, owner: "GraphUser", topic: Topic) -> None:
        self._owner, self._topic = owner, topic

    @property
    def wanted(self) -> bool:
        return not self._owner.is_silent and self._topic.wanted

    def publish(self, message: Any) -> None:
        if not self._owner.is_silent:
            self._owner.outbox.append((self._topic, message))

    def publish_later(self, make: Callable[[], Any]) -> None:
        """Publish a message that another thread makes."""
        if not self._owner.is_silent:
            self._owner.outbox.append((self._topic, PendingMessage(make, self._owner.unsent())))

    def close(self) -> None:
        """Send the waiting messages, then remove the topic from the ROS graph."""
        waiting = [one for one in self._owner.outbox if one[0] is self._topic]
        self._owner.outbox = [one for one in self._owner.outbox if one[0] is not self._topic]
        for _, message in waiting:
            self._topic.send(message.make() if isinstance(message, PendingMessage) else message)
        self._owner.close_one(self._topic)


class _UnnamedTopic:
    """A topic with an empty name, as Gazebo's plugins allow: it is not on the ROS graph."""

    wanted = False

    def send(self, message: Any) -> None:
        """Discard the message."""

    def close(self) -> None:
        """Do nothing."""


class PluginGraphHandle:
    """A subscription or service of a plugin."""

    def __init__(self, owner: "GraphUser", end: GraphHandle) -> None:
        self._owner, self._end = owner, end

    def close(self) -> None:
        """Remove the subscription or service from the ROS graph."""
        self._owner.close_one(self._end)


class GraphUser:
    """The part of a context that is about topics, services and parameters.

    For the thread of the host.

    Attributes:
        outbox, transforms: what the plugin has published since they were last taken.
        inbox: functions to be called for what has come for it.
        is_silent: what it publishes is discarded: it observes a step before the first subscriber.

    Args:
        graph: ROS.
        wake: causes the host to process `inbox`.
        changed: called, in any thread, when subscribers of a topic come or go.
    """

    def __init__(self, graph: Graph, wake: Callable[[], None], changed: Callable[[], None]) -> None:
        self._graph, self._wake, self._changed = graph, wake, changed
        self.inbox: Deque[Callable[[], None]] = deque()
        self.outbox: List[Tuple[Topic, Any]] = []
        self.transforms: List[Tuple[int, TransformOf]] = []
        self.is_silent = False
        self._opened: List[GraphHandle] = []
        self._uses: Dict[int, Tuple[str, str, bool]] = {}
        self._namespace = ""
        self._closed = threading.Event()

    @property
    def now_ns(self) -> int:
        """Sim time of this step."""
        raise NotImplementedError

    def warn(self, text: str) -> None:
        raise NotImplementedError

    def unsent(self) -> Deque[None]:
        """Return the list in which a message that is being made leaves a mark."""
        raise NotImplementedError

    def close_graph(self) -> None:
        """Remove everything from the ROS graph."""
        for one in self._opened:
            one.close()
        self._opened.clear()
        self._uses.clear()
        self._closed.set()

    def close_one(self, end: GraphHandle) -> None:
        """Remove one topic, subscription or service from the ROS graph."""
        if end in self._opened:
            self._opened.remove(end)
            self._uses.pop(id(end), None)
            end.close()

    def uses(self) -> List[Tuple[str, str, bool]]:
        """Return name, type, and whether it is a subscription, of each topic; from any thread."""
        return list(self._uses.values())

    def _open(self, begin: Callable[[str], Any], name: str, kind: str,
              is_subscription: Optional[bool] = None) -> Any:
        """Open a topic or service under its full name; `is_subscription` for topics only."""
        full = self._name(name)
        try:
            end = begin(full)
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing
        self._opened.append(end)
        if is_subscription is not None:
            self._uses[id(end)] = (full, kind, is_subscription)
        return end

    def use_namespace(self, namespace: str) -> None:
        """Set the namespace of relative names: "/" is the root, "" the node's namespace."""
        namespace = namespace.strip()
        self._namespace = namespace.rstrip("/") or namespace[:1]

    def _name(self, name: str) -> str:
        if name.startswith(("/", "~")) or not self._namespace:
            return name
        return f"{self._namespace.rstrip('/')}/{name}"

    def message(self, kind: str) -> Any:
        try:
            return self._graph.message(kind)
        except MissingTypeError as missing:
            raise PluginError(str(missing)) from missing

    def stamp(self, ns: Optional[int] = None) -> Any:
        return self._graph.stamp(self.now_ns if ns is None else ns)

    def publish(self, name: str, kind: str, queue: int = 1, latch: bool = False) -> PluginTopic:
        if not name:
            return PluginTopic(self, _UnnamedTopic())
        return PluginTopic(self, self._open(
            lambda full: self._graph.publish(full, kind, queue, latch, self._changed), name, kind,
            False))

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int = 1) -> PluginGraphHandle:
        waiting: Deque[Any] = deque(maxlen=max(1, queue))

        def deliver() -> None:
            while waiting:
                call(waiting.popleft())

        def arrived(message: Any) -> None:
            if self._closed.is_set():   # the subscription ends a moment later
                return
            waiting.append(message)
            self.inbox.append(deliver)
            self._wake()

        return PluginGraphHandle(self, self._open(
            lambda full: self._graph.subscribe(full, kind, arrived, queue), name, kind, True))

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> PluginGraphHandle:
        """Offer a service; one that another plugin offers stays with that one, with a warning."""
        def asked(request: Any, response: Any) -> None:
            done = threading.Event()

            faults: List[PluginError] = []

            def answer() -> None:
                try:
                    call(request, response)
                except RequestError as refused:
                    faults.append(refused)
                except Exception as raised:  # the caller gets the fault as well
                    faults.append(PluginError(str(raised)))
                    raise
                finally:
                    done.set()

            self.inbox.append(answer)
            self._wake()
            while not done.wait(_LOOK_S):
                if self._closed.is_set():
                    faults.append(PluginError("the plugin has ended"))
                    break
            if faults:
                raise faults[0]

        try:
            end = self._open(lambda full: self._graph.serve(full, kind, asked), name, kind)
        except ServiceTakenError as taken:  # roscpp reports it, and Gazebo's plugins continue
            self.warn(str(taken))
            end = _UnnamedTopic()
        return PluginGraphHandle(self, end)

    def parameter(self, name: str, default: Any) -> Any:
        return self._graph.parameter(self._namespace, name, default)

    def search_parameter(self, name: str, default: Any) -> Any:
        return self._graph.search_parameter(self._namespace, name, default)

    def offer_transforms(self) -> None:
        self._graph.offer_transforms(self._changed)

    def transform(self, parent: str, child: str, pose: Pose) -> None:
        if self.is_silent:
            return
        self.transforms.append(
            (self.now_ns, (str(parent), str(child), check_pose(pose, "a transform"))))
