"""ROS for plugins: message types by name, topics, services, tf."""
from __future__ import annotations

import contextlib
import importlib
from typing import Any, Callable, Dict, List

import genpy
import rospy

from ...errors import SimulationError
from ...plugins.graph import GraphHandle, MissingTypeError, ServiceTakenError, Topic, TransformOf
from ..direct_connection import direct_publish
from ..topics.subscriber_events import SubscriberEvents
from .deferred_closing import DeferredClosing
from .packed_transforms import PackedTransforms

_TF_QUEUE = 100


def _ignore() -> None:
    """Nothing depends on who subscribes."""


class RosTopic:
    """A publisher. `close` is called with the function that removes it from the graph."""

    def __init__(self, publisher: rospy.Publisher,
                 close: Callable[[Callable[[], Any]], None]) -> None:
        self._publisher, self._publish = publisher, direct_publish(publisher)
        self._close = close

    @property
    def wanted(self) -> bool:
        implementation = self._publisher.impl
        return implementation is not None and bool(implementation.connections)

    def send(self, message: Any) -> None:
        """Publish, unless the node is ending."""
        try:
            self._publish(message)
        except rospy.ROSException:
            if not rospy.is_shutdown():
                raise

    def close(self) -> None:
        self._close(self._publisher.unregister)


class _Closing:
    def __init__(self, close: Callable[[], Any],
                 defer: Callable[[Callable[[], Any]], None]) -> None:
        self._close, self._defer = close, defer

    def close(self) -> None:
        self._defer(self._close)


class RosGraph:
    """See `plugins.graph.Graph`. Names are remapped as the node's arguments say."""

    def __init__(self) -> None:
        self._types: Dict[str, Any] = {}
        self._tf: Any = None
        self._stamp = (0, genpy.Time())
        self._closing = DeferredClosing()

    def message(self, kind: str) -> Any:
        return self._type(kind, "msg")()

    def stamp(self, ns: int) -> Any:
        if ns != self._stamp[0]:  # all plugins that act in one step have one
            self._stamp = (ns, genpy.Time(ns // 10 ** 9, ns % 10 ** 9))
        return self._stamp[1]

    def publish(self, name: str, kind: str, queue: int, latch: bool,
                changed: Callable[[], None] = _ignore) -> Topic:
        made, closing = self._type(kind, "msg"), self._reuse(name)
        return RosTopic(rospy.Publisher(name, made, SubscriberEvents(changed), queue_size=queue,
                                        latch=latch, tcp_nodelay=True), closing)

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int) -> GraphHandle:
        made, closing = self._type(kind, "msg"), self._reuse(name)
        return _Closing(rospy.Subscriber(name, made, call, queue_size=queue,
                                         tcp_nodelay=True).unregister, closing)

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> GraphHandle:
        """Offer a service; a plugin's refusal goes to who has asked, and not into the log."""
        service = self._type(kind, "srv")

        def answer(request: Any) -> Any:
            response = service._response_class()
            try:
                call(request, response)
            except SimulationError as fault:
                # rospy would log a traceback of another exception; the plugin host reports
                # faults itself, with file and line.
                raise rospy.ServiceException(str(fault)) from fault
            return response

        closing = self._reuse(name)
        try:
            return _Closing(rospy.Service(name, service, answer).shutdown, closing)
        except rospy.ServiceException:
            raise ServiceTakenError(f"the service {rospy.resolve_name(name)} is offered already, by"
                                    " another plugin") from None

    def parameter(self, namespace: str, name: str, default: Any) -> Any:
        at = rospy.resolve_name(namespace) if namespace else rospy.get_namespace()
        return rospy.get_param(name if name.startswith("/") else f"{at.rstrip('/')}/{name}",
                               default)

    def search_parameter(self, namespace: str, name: str, default: Any) -> Any:
        at = rospy.resolve_name(namespace) if namespace else rospy.get_namespace()
        while True:
            found = rospy.get_param(f"{at.rstrip('/')}/{name}", None)
            if found is not None:
                return found
            if at in ("", "/"):
                return default
            at = at.rstrip("/").rpartition("/")[0] or "/"

    def offer_transforms(self, changed: Callable[[], None]) -> None:
        if self._tf is None:
            self._tf = self.publish("/tf", "tf2_msgs/TFMessage", _TF_QUEUE, False, changed)

    @property
    def transforms_wanted(self) -> bool:
        return self._tf is not None and self._tf.wanted

    def send_transforms(self, transforms: List[TransformOf], ns: int) -> None:
        """Broadcast to /tf, all in one message."""
        if self._tf is None:
            self.offer_transforms(_ignore)
        if self._tf.wanted:
            self._tf.send(PackedTransforms(transforms, ns))

    def _reuse(self, name: str) -> Callable[[Callable[[], Any]], None]:
        """End the removal of a name that is used again; return what defers the next removal."""
        resolved = rospy.resolve_name(name)
        self._closing.finish(resolved)

        def defer(close: Callable[[], Any]) -> None:
            def remove() -> None:
                with contextlib.suppress(OSError):  # the master has gone: nothing is registered
                    close()

            self._closing.put(resolved, remove)

        return defer

    def _type(self, kind: str, sort: str) -> Any:
        if kind not in self._types:
            package, _, name = kind.partition("/")
            try:
                self._types[kind] = getattr(importlib.import_module(f"{package}.{sort}"), name)
            except (ImportError, AttributeError) as fault:
                raise MissingTypeError(f"{kind} is not installed; install the package ros-{package}"
                                       f" ({fault})") from fault
        return self._types[kind]
