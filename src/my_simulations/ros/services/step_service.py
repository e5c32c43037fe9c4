"""step_world: time on request."""
from __future__ import annotations

import threading
from typing import Any

import rospy

from ...errors import CommandError
from ...simulator.simulator import Simulator

AT_ONCE = 1000
"""Steps between two looks whether the node ends; other requests are served in between anyway."""

MOST = 100000000


class SteppingService:
    """Makes steps, one request after the other."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._lock = threading.Lock()

    def step(self, request: Any, response: Any) -> str:
        """So many steps as fast as the machine can; answered when they are done."""
        steps = request.steps
        if not 0 <= steps <= MOST:
            raise CommandError(f"steps must be in 0 to {MOST}, it is {steps}")
        with self._lock:
            left = steps
            while left > 0:
                if rospy.is_shutdown():
                    raise CommandError(f"the node ends, {left} steps were not made")
                count = min(left, AT_ONCE)
                self._simulator.clock.advance(count)
                left -= count
            nanoseconds = self._simulator.clock.sim_ns
        response.sim_time.secs, response.sim_time.nsecs = divmod(nanoseconds, 1000000000)
        return f"{steps} steps made"
