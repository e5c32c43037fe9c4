"""ROS for plugins: message types by name, topics, services, tf.

A thread of its own removes topics and services from the ROS graph. Each removal takes a call of the
master: 2 ms, 20 ms on a busy machine. A plugin may have thousands of topics, and the thread of the
plugins, for which the world waits, must not wait for them.
"""
from __future__ import annotations

import contextlib
import importlib
import os
import struct
import threading
from functools import lru_cache
from typing import Any, Callable, Dict, List, Optional, Sequence

import genpy
import rospy
from tf2_msgs.msg import TFMessage

from ...errors import SimulationError
from ...plugins.graph import GraphHandle, MissingTypeError, ServiceTakenError, Topic, TransformOf
from ...resources.ros_packages import PackageIndex
from ..direct_connection import direct_publish
from ..topics.subscriber_events import SubscriberEvents

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
        self._closing.close_now(resolved)

        def defer(close: Callable[[], Any]) -> None:
            def remove() -> None:
                with contextlib.suppress(OSError):  # the master has gone: nothing is registered
                    close()

            self._closing.close_soon(resolved, remove)

        return defer

    def _type(self, kind: str, sort: str) -> Any:
        if kind not in self._types:
            package, _, name = kind.partition("/")
            try:
                self._types[kind] = getattr(importlib.import_module(f"{package}.{sort}"), name)
            except (ImportError, AttributeError) as fault:
                folder = PackageIndex().find(package)
                raise MissingTypeError(_missing_type(kind, sort, folder, fault)) from fault
        return self._types[kind]


def _missing_type(kind: str, sort: str, folder: Optional[str], fault: Exception) -> str:
    """The text about a type that cannot be imported; `folder`: of its package."""
    package, _, name = kind.partition("/")
    if folder and os.path.isfile(os.path.join(folder, sort, f"{name}.{sort}")):
        return f"{kind} has not been built; build the package {package} in {folder} ({fault})"
    return f"{kind} is not installed; install the package ros-{package} ({fault})"


_COUNT = struct.Struct("<I")
_STAMP = struct.Struct("<III")   # seq, seconds, nanoseconds
_POSE = struct.Struct("<7d")     # translation, rotation x, y, z, w


class PackedTransforms(TFMessage):
    """Transforms as of one sim time (ns), in the layout of geometry_msgs/TransformStamped."""

    __slots__ = ["_packed"]

    def __init__(self, transforms: Sequence[TransformOf], ns: int) -> None:
        # The fields stay empty: `_packed` holds the message.
        stamp = _STAMP.pack(0, *divmod(ns, 10 ** 9))
        parts = [_COUNT.pack(len(transforms))]
        for parent, child, pose in transforms:
            parts += (stamp, _frames(parent, child), _POSE.pack(*pose.position, *pose.orientation))
        self._packed = b"".join(parts)

    def serialize(self, buff: Any) -> None:
        """Write what a TFMessage with these transforms writes."""
        buff.write(self._packed)


@lru_cache(maxsize=4096)
def _frames(parent: str, child: str) -> bytes:
    """`frame_id` and `child_frame_id`, one after the other."""
    return b"".join(_COUNT.pack(len(name)) + name
                    for name in (parent.encode(), child.encode()))


_PAUSE_S = 0.001   # between two removals: rospy holds a lock in each that others need as well


class DeferredClosing:
    """Makes calls in their order, except those for a name that is used again."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: Dict[str, List[Callable[[], None]]] = {}
        self._current = ""
        self._is_running = False

    def close_soon(self, name: str, close: Callable[[], None]) -> None:
        """Make a call soon, in another thread."""
        with self._changed:
            self._waiting.setdefault(name, []).append(close)
            if not self._is_running:
                self._is_running = True
                threading.Thread(target=self._run, name="graph-closing", daemon=True).start()

    def close_now(self, name: str) -> None:
        """Make the calls for a name that are still due, before the name is used again."""
        with self._changed:
            self._changed.wait_for(lambda: self._current != name)
            calls = self._waiting.pop(name, [])
        for call in calls:
            call()

    def _run(self) -> None:
        while True:
            with self._changed:
                if not self._waiting:
                    self._is_running = False
                    return
                self._current = next(iter(self._waiting))
                calls = self._waiting.pop(self._current)
            for call in calls:
                try:
                    call()
                except Exception as fault:  # a thread that ended here would remove nothing more
                    rospy.logerr("%s was not removed from the ROS graph: %r", self._current, fault)
            with self._changed:
                self._current = ""
                self._changed.notify_all()
                self._changed.wait(_PAUSE_S)
