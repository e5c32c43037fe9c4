"""PID loops on joint axes."""
from __future__ import annotations

from typing import Optional

from ..run_state import LoopMemory
from ..timed_forces import JointPid

MOST_EFFORT = 1000.0
"""N m or N that a loop may ask for where the axis has no limit (Gazebo's `JointController`)."""


class PidController:
    """One loop: effort = -(p e + i integral of e + d de/dt), e = present - target.

    Gazebo's `common::PID`, but for the integral, which Gazebo stops at an effort of 1: here it
    stops growing while the effort is at its limit, so that it carries what weight the joint bears
    and does not wind up at a stop.
    """

    def __init__(self, servo: JointPid) -> None:
        self._servo = servo
        self._integral = 0.0
        self._last: Optional[float] = None

    @property
    def memory(self) -> LoopMemory:
        """Its state, for `resume`."""
        return LoopMemory(self._integral, self._last)

    def resume(self, memory: LoopMemory) -> None:
        self._integral, self._last = memory.integral, memory.error

    def effort(self, position: float, rate: float, dt: float, most: float) -> float:
        """What to drive the axis with in the next step, N m or N.

        Args:
            position: of the axis now, rad or m; `rate` per second.
            rate: see position.
            dt: the step size, s.
            most: what the effort is limited to, either way.
        """
        servo = self._servo
        error = (rate if servo.rate else position) - servo.target
        slope = 0.0 if self._last is None else (error - self._last) / dt
        self._last = error
        grown = self._integral + servo.i * error * dt
        wanted = -(servo.p * error + grown + servo.d * slope)
        given = max(-most, min(most, wanted))
        if given == wanted or (wanted > given) == (error > 0.0):
            self._integral = grown
        return given
