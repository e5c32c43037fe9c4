"""Service step_world."""
from __future__ import annotations

import threading
from typing import Any

import rospy

from ...errors import CommandError
from ...simulator.simulator import Simulator

AT_ONCE = 1000
"""Steps per engine command; between two of them a shutdown of the node is noticed."""

MOST = 100000000


class StepService:
    """Executes steps, one request at a time."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._lock = threading.Lock()

    def step(self, request: Any, response: Any) -> str:
        """Execute steps as fast as possible; returns when they are done.

        Raises CommandError: the count is out of range, or the node shuts down.
        """
        steps = request.steps
        if not 0 <= steps <= MOST:
            raise CommandError(f"steps must be between 0 and {MOST}, is {steps}")
        with self._lock:
            left = steps
            while left > 0:
                if rospy.is_shutdown():
                    raise CommandError(f"node is shutting down; {left} steps not executed")
                count = min(left, AT_ONCE)
                self._simulator.clock.advance(count)
                left -= count
            nanoseconds = self._simulator.clock.sim_ns
        response.sim_time.secs, response.sim_time.nsecs = divmod(nanoseconds, 1000000000)
        return f"{steps} steps executed"
