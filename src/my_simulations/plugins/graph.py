"""The interface to ROS that plugins use; the ROS front end implements it."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, List, Protocol, Tuple

from ..errors import SimulationError
from ..geometry import Pose

TransformOf = Tuple[str, str, Pose]
"""Parent frame, child frame, pose of the child in the parent."""


@dataclass(frozen=True)
class TopicUse:
    """A topic that a plugin publishes or subscribes to.

    Attributes:
        name: the name that the plugin uses, before remapping.
        kind: type, such as `sensor_msgs/LaserScan`.
        is_subscription: whether the plugin subscribes to it; otherwise it publishes it.
        model: the plugin's model.
        link: the link that carries the plugin's sensor; "" for a plugin of the model.
        sensor: the sensor's type; "" likewise.
        pose: where in that link the sensor is.
    """

    name: str
    kind: str
    is_subscription: bool
    model: str
    link: str
    sensor: str
    pose: Pose


class MissingTypeError(SimulationError):
    """A message or service type whose package is not installed."""


class ServiceTakenError(SimulationError):
    """A service that this node offers already."""


class Topic(Protocol):
    @property
    def wanted(self) -> bool:
        """Whether the topic has a subscriber."""

    def send(self, message: Any) -> None:
        """Publish a message."""

    def close(self) -> None:
        """Remove the topic from the ROS graph."""


class GraphHandle(Protocol):
    """A subscription or service that can be removed from the graph."""

    def close(self) -> None:
        """Remove it from the graph."""


class Graph(Protocol):
    """Names are relative to the node's namespace unless they begin with a slash."""

    def message(self, kind: str) -> Any:
        """Return a new message. Raises MissingTypeError."""

    def stamp(self, ns: int) -> Any:
        """Return a time as a message field."""

    def publish(self, name: str, kind: str, queue: int, latch: bool,
                changed: Callable[[], None]) -> Topic:
        """Advertise a topic; `changed` is called, in any thread, when subscribers come or go.

        Raises MissingTypeError.
        """

    def subscribe(self, name: str, kind: str, call: Callable[[Any], None],
                  queue: int) -> GraphHandle:
        """Subscribe to a topic; `call` runs in another thread. Raises MissingTypeError."""

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> GraphHandle:
        """Advertise a service; `call` (request, response) runs in another thread.

        Raises MissingTypeError, and ServiceTakenError.
        """

    def parameter(self, namespace: str, name: str, default: Any) -> Any:
        """Return a parameter of a namespace."""

    def search_parameter(self, namespace: str, name: str, default: Any) -> Any:
        """Return a parameter of a namespace or of the nearest parent that has it."""

    def offer_transforms(self, changed: Callable[[], None]) -> None:
        """Advertise tf; `changed` as for `publish`. A second call has no effect."""

    @property
    def transforms_wanted(self) -> bool:
        """Whether tf has a subscriber."""

    def send_transforms(self, transforms: List[TransformOf], ns: int) -> None:
        """Broadcast transforms to tf, stamped with a sim time."""
