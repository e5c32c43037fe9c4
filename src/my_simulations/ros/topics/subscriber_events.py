"""Notification of new and lost subscribers."""
from __future__ import annotations

from typing import Any, Callable

import rospy


class SubscriberEvents(rospy.SubscribeListener):
    """Calls a function whenever a subscriber connects or disconnects."""

    def __init__(self, tell: Callable[[], None]) -> None:
        super().__init__()
        self._tell = tell

    def peer_subscribe(self, _topic: str, _publish: Any, _peer_publish: Any) -> None:
        """Called by rospy."""
        self._tell()

    def peer_unsubscribe(self, _topic: str, _peers: int) -> None:
        """Called by rospy."""
        self._tell()
