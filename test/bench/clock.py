"""Counts what arrives on /clock."""
from __future__ import annotations

import time


class Clock:
    """A subscriber.

    Attributes:
        first: when the first message came, s of `time.perf_counter`; 0 for not yet.
        count: of messages.
        sim: the newest time, s.
    """

    def __init__(self, topic: str = "/clock") -> None:
        import rospy
        from rosgraph_msgs.msg import Clock as Message
        self.first = 0.0
        self.count = 0
        self.sim = 0.0
        self._subscriber = rospy.Subscriber(topic, Message, self._hear)

    def _hear(self, message: object) -> None:
        self.sim = message.clock.to_sec()
        self.count += 1
        if not self.first:
            self.first = time.perf_counter()

    def factor(self, seconds: float) -> float:
        """Sim seconds a second of wall time, over so many of these."""
        sim, since = self.sim, time.perf_counter()
        time.sleep(seconds)
        return (self.sim - sim) / (time.perf_counter() - since)

    def close(self) -> None:
        self._subscriber.unregister()
