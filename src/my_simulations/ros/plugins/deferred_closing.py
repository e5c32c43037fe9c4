"""Removes topics and services from the ROS graph in a thread of its own.

Each removal takes a call of the master: 2 ms, 20 ms on a busy machine. A plugin may have thousands
of topics, and the thread of the plugins, for which the world waits, must not wait for them.
"""
from __future__ import annotations

import threading
from typing import Callable, Dict, List

import rospy

_PAUSE_S = 0.001   # between two removals: rospy holds a lock in each that others need as well


class DeferredClosing:
    """Makes calls in their order, except those for a name that is used again."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: Dict[str, List[Callable[[], None]]] = {}
        self._current = ""
        self._is_running = False

    def put(self, name: str, close: Callable[[], None]) -> None:
        """Make a call soon, in another thread."""
        with self._changed:
            self._waiting.setdefault(name, []).append(close)
            if not self._is_running:
                self._is_running = True
                threading.Thread(target=self._run, name="graph-closing", daemon=True).start()

    def finish(self, name: str) -> None:
        """Return after all calls for a name, before the name is used again."""
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
