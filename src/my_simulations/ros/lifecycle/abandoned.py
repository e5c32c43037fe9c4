"""Detects that the ROS master or the roslaunch that started this node is gone."""
from __future__ import annotations

import time
from typing import Callable

from . import master_api
from .launch_info import Launch

SECONDS = 60.0
"""Default of `~master_timeout`: wall seconds until the node exits without either of them."""

ASK_SECONDS = 5.0
"""Wall seconds between two queries of the master."""


class Abandonment:
    """Watches master and roslaunch; call `reason` periodically from one thread.

    Args:
        uri: URI of the master.
        name: name of this node.
        launch: how this process was started.
        limit: wall seconds that one of them may be gone; 0 for no limit.
        clock: source of wall time in seconds, for tests.
    """

    def __init__(self, uri: str, name: str, launch: Launch, limit: float,
                 clock: Callable[[], float] = time.monotonic) -> None:
        self._uri, self._name, self._launch = uri, name, launch
        self._limit, self._clock = limit, clock
        self._seen = {"master": clock(), "launch": clock()}
        self._asked = clock()

    def reason(self) -> str:
        """Why the node must exit, as a sentence; "" if it must not."""
        if self._limit <= 0.0:
            return ""
        now = self._clock()
        if self._launch.is_alive:
            self._seen["launch"] = now
        if now - self._asked >= min(ASK_SECONDS, self._limit / 2.0):
            self._asked = now
            if not master_api.fault_of(self._uri, self._name):
                self._seen["master"] = self._clock()
        if now - self._seen["master"] >= self._limit:
            return f"the ROS master at {self._uri} has been gone for {self._limit:g} s"
        if now - self._seen["launch"] >= self._limit:
            return (f"the roslaunch that started this node (process {self._launch.pid}) has been "
                    f"gone for {self._limit:g} s")
        return ""
