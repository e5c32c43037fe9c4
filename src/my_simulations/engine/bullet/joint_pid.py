"""PID controllers of joint axes."""
from __future__ import annotations

from typing import Optional

from ..run_state import LoopMemory
from ..timed_forces import JointPid

MOST_EFFORT = 1000.0
"""N m or N: the limit of a loop on an axis without one (Gazebo's `JointController`)."""


class PidController:
    """Computes effort = -(p e + i integral of e + d de/dt), with e = present - target.

    This is Gazebo's `common::PID` except for the integral, which Gazebo limits to an effort of 1.
    Here the integral stops growing while the effort is at its limit (anti-windup). So it can
    balance any weight on the joint, and does not grow at a limit of the joint.
    """

    def __init__(self, settings: JointPid) -> None:
        self._settings = settings
        self._integral = 0.0
        self._last_error: Optional[float] = None

    @property
    def memory(self) -> LoopMemory:
        """The state of the loop, for `resume`."""
        return LoopMemory(self._integral, self._last_error)

    def resume(self, memory: LoopMemory) -> None:
        """Continue from a saved state."""
        self._integral, self._last_error = memory.integral, memory.error

    def effort(self, position: float, rate: float, dt: float, most: float) -> float:
        """Return the effort on the axis in the next step, N m or N.

        Args:
            position: of the axis, rad or m.
            rate: of the axis, rad/s or m/s.
            dt: the step size, s.
            most: limit of the absolute effort, N m or N.
        """
        settings = self._settings
        error = (rate if settings.rate else position) - settings.target
        slope = 0.0 if self._last_error is None else (error - self._last_error) / dt
        self._last_error = error
        integral = self._integral + settings.i * error * dt
        unlimited = -(settings.p * error + integral + settings.d * slope)
        effort = max(-most, min(most, unlimited))
        # At the limit, the integral may only change towards lower absolute efforts.
        if effort == unlimited or (unlimited > effort) == (error > 0.0):
            self._integral = integral
        return effort
