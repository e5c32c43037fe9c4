"""ROS topics of a test: it says what there is, publishes, and sees what is published."""
from __future__ import annotations

from dataclasses import dataclass, field

from my_simulations.geometry import IDENTITY, Pose
from my_simulations.plugins.testing import Message


@dataclass
class Listed:
    name: str
    kind: str
    publishers: int = 1
    subscribers: int = 0
    model: str = ""
    driven: bool = False
    link: str = ""
    pose: Pose = IDENTITY


@dataclass
class Source:
    """`editor.topic_source.TopicSource`."""

    listed: list = field(default_factory=list)
    heard: dict = field(default_factory=dict)
    sent: list = field(default_factory=list)
    offered: list = field(default_factory=list)

    def topics(self):
        return list(self.listed)

    def receive(self, name, kind, call):
        heard = self.heard
        heard[name] = call

        class Subscription:
            received_bytes = 0

            def close(self):
                heard.pop(name)
        return Subscription()

    def message(self, kind):
        return Message()

    def publish(self, name, kind, queue, latch):
        source = self
        source.offered.append(name)

        class Publisher:
            def send(self, message):
                source.sent.append((name, message))

            def close(self):
                source.offered.remove(name)
        return Publisher()

    def speeds(self):
        """(topic, forward, yaw rate) of what was sent."""
        return [(name, twist.linear.x, twist.angular.z) for name, twist in self.sent]
