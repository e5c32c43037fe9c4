"""The figures of the time bar: sim time, wall time that was not paused, real-time factor."""
from __future__ import annotations

import time
from collections import deque
from typing import Any, Deque, Dict, Optional, Tuple

from ...simulator.simulator import Simulator

_WINDOW = 20
"""Readings the real-time factor is a mean of (Gazebo behaviour)."""


class ClockStatistics:
    """Counts wall time while the world runs."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._at = time.monotonic_ns()
        # The world may have run before the first reading: assume real time.
        self._real_ns = simulator.clock.sim_ns
        self._sim_ns = simulator.clock.sim_ns
        self._paused = simulator.clock.paused
        self._readings: Deque[Tuple[int, int]] = deque(maxlen=_WINDOW)
        self._last_sent: Optional[Tuple[int, bool]] = None

    @property
    def real_ns(self) -> int:
        """Wall time without pauses, nanoseconds, as of the last reading."""
        return self._real_ns

    @property
    def factor(self) -> float:
        """Sim time by wall time, over the last readings; 0 while paused."""
        return self._factor()

    def read(self) -> Dict[str, Any]:
        # In this order: the step that a pause is told with is its last.
        now, paused = time.monotonic_ns(), self._simulator.clock.paused
        step, clock = self._simulator.clock.now()
        sim_ns = clock.sim_ns(step)
        if not self._paused:
            self._real_ns += now - self._at
        if sim_ns < self._sim_ns:  # time was reset
            self._real_ns = sim_ns
            self._readings.clear()
        self._at, self._sim_ns, self._paused = now, sim_ns, paused
        if paused:
            self._readings.clear()
        else:
            self._readings.append((self._real_ns, sim_ns))
        return {"type": "stats", "sim_ns": sim_ns, "real_ns": self._real_ns,
                "factor": self._factor(), "iterations": step, "paused": paused}

    def changes(self) -> Optional[Dict[str, Any]]:
        """As `read`; None when nothing has changed since it was last told."""
        found = self.read()
        current = (found["sim_ns"], found["paused"])
        if current == self._last_sent:
            return None
        self._last_sent = current
        return found

    def _factor(self) -> float:
        if len(self._readings) < 2:
            return 0.0
        (real0, sim0), (real1, sim1) = self._readings[0], self._readings[-1]
        return (sim1 - sim0) / (real1 - real0) if real1 > real0 else 0.0
