"""Topics, services and parameters of plugins in one process, without ROS."""
from __future__ import annotations

import contextlib
import threading
from typing import Any, Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Tuple

from ..errors import CommandError, SimulationError
from ..geometry import Pose
from ..messages.conversion import Converter, require_message
from ..messages.message_types import FindPackage, Message, MessageTypes, UnknownTypeError
from ..messages.time_values import Time
from .graph import MissingTypeError, ServiceTakenError, TransformOf
from .local_parameters import LocalParameters

_NODE = "/gazebo"
_TF, _TF_KIND = "/tf", "tf2_msgs/TFMessage"

Listener = Callable[[Any], None]


def resolve_name(name: str, namespace: str = "/") -> str:
    """The name with a leading slash, as in a node `/gazebo` of the given namespace."""
    if name.startswith("~"):
        name = f"{_NODE}/{name[1:]}"
    elif not name.startswith("/"):
        name = f"{namespace}/{name}"
    return "/" + "/".join(part for part in name.split("/") if part)


class _Listening(NamedTuple):
    call: Listener
    plugin: bool   # whether it gets the values of rospy


class _Topic:
    """A topic of a graph: its type, publishers and listeners."""

    def __init__(self) -> None:
        self.kind = ""
        self.publishers: List["LocalTopic"] = []
        self.listening: List[_Listening] = []

    @property
    def has_plugin_subscriber(self) -> bool:
        return any(one.plugin for one in self.listening)


class LocalTopic:
    """A publisher; see `graph.Topic`."""

    def __init__(self, graph: "LocalGraph", name: str, kind: str, latch: bool,
                 changed: Callable[[], None]) -> None:
        self._graph, self.name, self.kind, self._latch = graph, name, kind, latch
        self.changed = changed
        self._count = 0
        self.latched: Optional[Any] = None

    @property
    def wanted(self) -> bool:
        return self._graph.has_listener(self.name)

    def send(self, message: Any) -> None:
        """Pass the message to all listeners. Raises MessageFieldError for an invalid one."""
        require_message(message, self.kind)
        self._count += 1
        header = getattr(message, "header", None)
        if header is not None and hasattr(header, "seq"):
            header.seq = self._count   # as rospy does
        if self._latch:
            self.latched = self._graph.to_plugin.convert(message, self.kind)
        self._graph.deliver(self.name, self.kind, message)

    def close(self) -> None:
        self._graph.end_publisher(self)


class _Closing:
    def __init__(self, close: Callable[[], None]) -> None:
        self.close = close


class LocalGraph:
    """See `graph.Graph`; used by plugins and, with `listen`, `publish_once` and `call`, by others.

    Methods may be called from any thread. A listener is called in the thread that publishes.

    Args:
        parameters: of the plugins.
        find_package: finds folders of packages that may define message types.
    """

    def __init__(self, parameters: LocalParameters,
                 find_package: FindPackage = lambda name: None) -> None:
        self.parameters = parameters
        self._types = MessageTypes(find_package)
        self.to_plugin = Converter(self._types.message, numpy_arrays=False)
        self.to_user = Converter(self._types.message, numpy_arrays=True)
        self._topics: Dict[str, _Topic] = {}
        self._services: Dict[str, Tuple[str, Callable[[Any, Any], None]]] = {}
        self._lock = threading.RLock()
        self._tf: Optional[LocalTopic] = None
        self._is_suspended = False

    # -- for plugins: graph.Graph ------------------------------------------------------------------

    def message(self, kind: str) -> Any:
        """Return a new message. Raises MissingTypeError."""
        self._require(kind)
        return self.to_plugin.blank(kind)

    def stamp(self, ns: int) -> Time:
        return Time.of_ns(ns)

    def publish(self, name: str, kind: str, queue: int, latch: bool,
                changed: Callable[[], None]) -> LocalTopic:
        """Offer a topic; `changed` is called when listeners come or go. Raises MissingTypeError."""
        self._require(kind)
        made = LocalTopic(self, resolve_name(name), kind, latch, changed)
        with self._lock:
            topic = self._topic(made.name)
            topic.kind = topic.kind or kind
            topic.publishers.append(made)
        return made

    def subscribe(self, name: str, kind: str, call: Listener, queue: int) -> _Closing:
        """Subscribe to a topic. Raises MissingTypeError."""
        self._require(kind)
        with self._lock:
            topic = self._topic(resolve_name(name))
            topic.kind = topic.kind or kind
        return _Closing(self._listen(name, call, plugin=True))

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> _Closing:
        """Advertise a service. Raises MissingTypeError and ServiceTakenError."""
        try:
            self._types.service(kind)
        except UnknownTypeError as unknown:
            raise MissingTypeError(str(unknown)) from unknown
        full = resolve_name(name)
        with self._lock:
            if full in self._services:
                raise ServiceTakenError(f"the service {full} is offered already, by another plugin")
            self._services[full] = (kind, call)

        def close() -> None:
            self._services.pop(full, None)
        return _Closing(close)

    def parameter(self, namespace: str, name: str, default: Any) -> Any:
        return self.parameters.get(resolve_name(name, resolve_name(namespace)), default)

    def search_parameter(self, namespace: str, name: str, default: Any) -> Any:
        return self.parameters.search(resolve_name(namespace), name, default)

    def offer_transforms(self, changed: Callable[[], None]) -> None:
        if self._tf is None:
            self._tf = self.publish(_TF, _TF_KIND, 1, False, changed)

    @property
    def transforms_wanted(self) -> bool:
        return self.has_listener(_TF)

    def send_transforms(self, transforms: List[TransformOf], ns: int) -> None:
        """Broadcast to /tf, all in one message."""
        if self.transforms_wanted:
            self.deliver(_TF, _TF_KIND, {"transforms": [
                _transform(parent, child, pose, ns) for parent, child, pose in transforms]})

    # -- for others --------------------------------------------------------------------------------

    def topics(self) -> Dict[str, str]:
        """Return the types of the topics that plugins publish or subscribe to, by name."""
        with self._lock:
            return {name: topic.kind for name, topic in sorted(self._topics.items())
                    if topic.publishers or topic.has_plugin_subscriber}

    def services(self) -> Dict[str, str]:
        """The types of the services that plugins offer, by name."""
        with self._lock:
            return {name: kind for name, (kind, _) in sorted(self._services.items())}

    def listen(self, name: str, call: Listener) -> Callable[[], None]:
        """Call a function with the messages of a topic; returns what ends it.

        The function receives the last message of a latched topic at once.
        """
        return self._listen(name, call, plugin=False)

    def end_transforms(self) -> None:
        """Remove /tf from the graph until a plugin advertises it again."""
        if self._tf is not None:
            self._tf.close()

    @contextlib.contextmanager
    def suspended(self) -> Iterator[None]:
        """Let plugins run as if the functions of `listen` were given at the end.

        So robots that are loaded again publish what they have published the first time.
        """
        self._is_suspended = True
        try:
            yield
        finally:
            self._is_suspended = False
            with self._lock:
                topics_of_plugins = [(topic, [one for one in topic.listening if not one.plugin])
                         for topic in self._topics.values()]
            for topic, listening in topics_of_plugins:
                for one in listening:
                    self._begin(topic, one)

    def publish_once(self, name: str, message: Any) -> None:
        """Send a message to the plugins that subscribe to a topic, in their type.

        Raises CommandError: the topic does not exist, or the message does not fit its type.
        """
        full = resolve_name(name)
        with self._lock:
            topics_of_plugins = {one: topic.kind for one, topic in sorted(self._topics.items())
                     if topic.has_plugin_subscriber}
        if full not in topics_of_plugins:
            raise CommandError(f"no plugin subscribes to {full}; plugins subscribe to "
                               f"{', '.join(topics_of_plugins) or 'no topic'}")
        self.deliver(full, topics_of_plugins[full], message)

    def call(self, name: str, request: Any) -> Message:
        """Ask a service and wait for its response; `request` is a message or a mapping.

        Raises CommandError: the service does not exist, refuses, or the request does not fit.
        """
        full = resolve_name(name)
        with self._lock:
            found = self._services.get(full)
            names = ", ".join(sorted(self._services)) or "none"
        if found is None:
            raise CommandError(f"no plugin offers the service {full}; services are {names}")
        kind, answer = found
        self._types.service(kind)
        finder = {f"{kind}{end}": made for end, made in
                  zip(("Request", "Response"), self._types.service(kind))}
        find = lambda one: finder.get(one) or self._types.message(one)  # noqa: E731
        to_plugin, to_user = Converter(find, False), Converter(find, True)
        response = to_plugin.blank(f"{kind}Response")
        try:
            answer(to_plugin.convert(request, f"{kind}Request"), response)
        except CommandError:
            raise
        except SimulationError as refusal:
            raise CommandError(f"{full}: {refusal}") from refusal
        copy: Message = to_user.convert(response, f"{kind}Response")
        return copy

    # -- inside ------------------------------------------------------------------------------------

    def _require(self, kind: str) -> None:
        try:
            self._types.message(kind)
        except UnknownTypeError as unknown:
            raise MissingTypeError(str(unknown)) from unknown

    def _topic(self, name: str) -> _Topic:
        return self._topics.setdefault(name, _Topic())

    def has_listener(self, name: str) -> bool:
        topic = self._topics.get(name)
        return topic is not None and bool(self._listening(topic))

    def _listening(self, topic: _Topic) -> List[_Listening]:
        return [one for one in topic.listening if one.plugin or not self._is_suspended]

    def _listen(self, name: str, call: Listener, plugin: bool) -> Callable[[], None]:
        listening = _Listening(call, plugin)
        with self._lock:
            topic = self._topic(resolve_name(name))
            topic.listening.append(listening)
        self._begin(topic, listening)

        def end() -> None:
            with self._lock:
                if listening in topic.listening:
                    topic.listening.remove(listening)
            for one in list(topic.publishers):
                one.changed()
        return end

    def _begin(self, topic: _Topic, listening: _Listening) -> None:
        """Hand latched messages over, and notify the publishers."""
        for one in list(topic.publishers):
            if one.latched is not None:
                self._hand_over(listening, topic.kind, one.latched)
            one.changed()

    def deliver(self, name: str, kind: str, message: Any) -> None:
        """Pass a message to all listeners of a topic. Raises MessageFieldError."""
        topic = self._topics.get(name)
        for listening in self._listening(topic) if topic is not None else ():
            self._hand_over(listening, kind, message)

    def _hand_over(self, listening: _Listening, kind: str, message: Any) -> None:
        converter = self.to_plugin if listening.plugin else self.to_user
        listening.call(converter.convert(message, kind))

    def end_publisher(self, publisher: LocalTopic) -> None:
        with self._lock:
            publishers = self._topic(publisher.name).publishers
            if publisher in publishers:
                publishers.remove(publisher)
            if publisher is self._tf:
                self._tf = None


def _transform(parent: str, child: str, pose: Pose, ns: int) -> Mapping[str, Any]:
    translation = dict(zip("xyz", pose.position))
    rotation = dict(zip("xyzw", pose.orientation))
    return {"header": {"stamp": Time.of_ns(ns), "frame_id": parent}, "child_frame_id": child,
            "transform": {"translation": translation, "rotation": rotation}}
