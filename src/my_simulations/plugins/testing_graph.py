"""Topics, services and parameters of a plugin in a test, with the types that ROS gives them."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Set, Tuple

from ..geometry import Pose
from ..messages.conversion import Converter, require_message
from ..messages.message_types import Message as TypedMessage
from ..messages.message_types import MessageTypes, UnknownTypeError
from ..messages.time_values import Time
from ..resources.ros_packages import PackageIndex
from .context import PluginError


class Message:
    """Fields of a message that a test delivers; a field is created when it is read."""

    def __init__(self, **fields: Any) -> None:
        for name, value in fields.items():
            setattr(self, name, Message(**value) if isinstance(value, dict) else value)

    def __getattr__(self, name: str) -> "Message":
        if name.startswith("__"):
            raise AttributeError(name)
        made = Message()
        setattr(self, name, made)
        return made


def _plain(value: Any) -> Any:
    """The fields of a `Message` as a dictionary, also of those in lists."""
    if isinstance(value, Message):
        value = vars(value)
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    return value


class _Topic:
    def __init__(self, send: Callable[[Any], None], wanted: Callable[[], bool]) -> None:
        self._send, self._wanted = send, wanted

    @property
    def wanted(self) -> bool:
        return self._wanted()

    def publish(self, message: Any) -> None:
        self._send(message)

    def publish_later(self, make: Callable[[], Any]) -> None:
        self._send(make())

    def close(self) -> None:
        """Do nothing: a test can still read the published messages."""


class FakeHandle:
    """A handle that calls a function of the test when it is closed."""

    def __init__(self, close: Callable[[], Any] = lambda: None) -> None:
        self.close = close


class FakeGraph:
    """The part of a context that is about topics, services and parameters.

    A type that does not exist, a field that a type does not have, and a value that a field cannot
    have raise an exception, as they do in ROS.

    Attributes:
        published: messages by topic, as named with the namespace.
        transforms: (parent, child, pose), in order.
        unwanted: topics without subscribers.
        services: functions (request, response) by name.
        ros_parameters: what `parameter` and `search_parameter` find.
    """

    def __init__(self) -> None:
        self.published: Dict[str, List[Any]] = {}
        self.transforms: List[Tuple[str, str, Pose]] = []
        self.unwanted: Set[str] = set()
        self.services: Dict[str, Callable[[Any, Any], None]] = {}
        self.ros_parameters: Dict[str, Any] = {}
        self._namespace = ""
        self._heard: Dict[str, Callable[[Any], None]] = {}
        self._types = MessageTypes(PackageIndex().find)
        self._converter = Converter(self._types.message, numpy_arrays=False)

    @property
    def now_ns(self) -> int:
        raise NotImplementedError

    # -- what a test does --------------------------------------------------------------------------

    def deliver(self, topic: str, **fields: Any) -> None:
        """Deliver a message on a topic; dictionaries become nested messages.

        Raises MessageFieldError for fields that its type does not have, and PluginError if the
        plugin does not subscribe to it.
        """
        if topic not in self._heard:
            raise PluginError(f"the plugin does not subscribe to {topic!r}; it subscribes to"
                              f" {', '.join(sorted(self._heard)) or 'nothing'}")
        self._heard[topic](fields)

    def call(self, service: str, **fields: Any) -> Any:
        """Call a service; return the response. Raises as `deliver`."""
        response = Message()
        if service not in self.services:
            raise PluginError(f"the plugin does not offer {service!r}; it offers"
                              f" {', '.join(sorted(self.services)) or 'no service'}")
        self.services[service](fields, response)
        return response

    # -- Context -----------------------------------------------------------------------------------

    def use_namespace(self, namespace: str) -> None:
        self._namespace = namespace.strip("/")

    def _name(self, name: str) -> str:
        return name if name.startswith("/") or not self._namespace else f"{self._namespace}/{name}"

    def message(self, kind: str) -> Any:
        """Return a message of a type. Raises PluginError if it does not exist."""
        self._require(kind)
        return self._converter.blank(kind)

    def _require(self, kind: str) -> None:
        try:
            self._types.message(kind)
        except UnknownTypeError as fault:
            raise PluginError(str(fault)) from fault

    def stamp(self, ns: Optional[int] = None) -> Time:
        return Time.of_ns(self.now_ns if ns is None else ns)

    def publish(self, name: str, kind: str, queue: int = 1, latch: bool = False) -> Any:
        """Advertise a topic. Raises PluginError if its type does not exist."""
        self._require(kind)
        if not name:
            return _Topic(lambda message: None, lambda: False)
        name = self._name(name)
        sent = self.published.setdefault(name, [])

        def send(message: Any) -> None:
            require_message(message, kind)
            sent.append(self._converter.convert(message, kind))

        return _Topic(send, lambda: name not in self.unwanted)

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int = 1) -> FakeHandle:
        """Subscribe to a topic. Raises PluginError if its type does not exist."""
        self._require(kind)
        name = self._name(name)
        self._heard[name] = lambda fields: call(self._converter.convert(_plain(fields), kind))
        return FakeHandle(lambda: self._heard.pop(name))

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> FakeHandle:
        """Advertise a service. Raises PluginError if its type does not exist."""
        try:
            types = {made.KIND: made for made in self._types.service(kind)}
        except UnknownTypeError as fault:
            raise PluginError(str(fault)) from fault

        def find(one: str) -> "type[TypedMessage]":
            return types.get(one) or self._types.message(one)

        converter = Converter(find, numpy_arrays=False)

        def answer(request: Any, response: Any) -> None:
            filled = converter.blank(f"{kind}Response")
            call(converter.convert(_plain(request or {}), f"{kind}Request"), filled)
            if response is not None:
                vars(response).update(vars(converter.convert(filled, f"{kind}Response")))

        name = self._name(name)
        self.services[name] = answer
        return FakeHandle(lambda: self.services.pop(name))

    def parameter(self, name: str, default: Any) -> Any:
        """What a test says, by the name with its namespace, or of parts of dictionaries."""
        found: Any = self.ros_parameters
        for part in self._name(name).strip("/").split("/"):
            if not isinstance(found, dict) or part not in found:
                return default
            found = found[part]
        return found

    def search_parameter(self, name: str, default: Any) -> Any:
        return self.ros_parameters.get(name, default)

    def transform(self, parent: str, child: str, pose: Pose) -> None:
        self.transforms.append((parent, child, pose))
