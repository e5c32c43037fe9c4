"""What the editor needs of ROS: topics by name. The front end of ROS satisfies it."""
from __future__ import annotations

from typing import Any, Callable, List, Protocol

from ..geometry import Pose


class ListedTopic(Protocol):
    @property
    def name(self) -> str:
        """As resolved, with a leading slash."""

    @property
    def kind(self) -> str:
        """Type, such as `sensor_msgs/LaserScan`; "" if it is unknown."""

    @property
    def publishers(self) -> int:
        """Number of nodes."""

    @property
    def subscribers(self) -> int:
        """Number of nodes."""

    @property
    def model(self) -> str:
        """The model whose plugin publishes or subscribes to it; "" for others."""

    @property
    def driven(self) -> bool:
        """Whether a plugin of the model subscribes to it."""

    @property
    def link(self) -> str:
        """The link that carries the sensor whose data it is, within the model; "" for others."""

    @property
    def pose(self) -> Pose:
        """Where in that link the data's axes are."""


class Subscription(Protocol):
    @property
    def received_bytes(self) -> int:
        """Bytes that have come so far, of all publishers."""

    def close(self) -> None:
        """End the subscription."""


class Publisher(Protocol):
    """A topic that is offered."""

    def send(self, message: Any) -> None:
        """Publish."""

    def close(self) -> None:
        """Take it off the graph."""


class TopicSource(Protocol):
    """Topics by name; all calls may wait for the master and raise OSError."""

    def topics(self) -> List[ListedTopic]:
        """All topics with a publisher or subscriber, by name."""

    def receive(self, name: str, kind: str, call: Callable[[Any], None]) -> Subscription:
        """Subscribe; `call` comes from another thread and must not change the message.

        Raises SimulationError: the type's package is not installed.
        """

    def message(self, kind: str) -> Any:
        """A new message. Raises SimulationError: the type's package is not installed."""

    def publish(self, name: str, kind: str, queue: int, latch: bool) -> Publisher:
        """Offer a topic. Raises SimulationError: the type's package is not installed."""


def type_of(source: TopicSource, name: str) -> str:
    """The type of a topic; "" if it is unknown. May wait for the master; raises OSError."""
    kind = next((one.kind for one in source.topics() if one.name == name), "")
    return "" if kind == "*" else kind
