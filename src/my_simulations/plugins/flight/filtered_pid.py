"""The PID controller of hector_gazebo_quadrotor_simple_controller."""
from __future__ import annotations

from typing import Tuple

from ..parameters import Parameters


class FilteredPid:
    """A PID controller whose command passes a limit and a first-order filter.

    Source: GazeboQuadrotorSimpleController::PIDController of hector_quadrotor_gazebo_plugins. The
    command u is clamped to +-limit and filtered with the time constant T: y += (u - y) dt / (dt +
    T). The output is p (y - x) + d (dy/dt - dx/dt) + i times the integral of (y - x).

    Args:
        parameters: of the plugin.
        prefix: of the elements, e.g. `yaw` reads `<yawProportionalGain>`.
        gains: p, i and d where the elements are missing.
        filters_rate: the rate of the command is (u - y) / (dt + T) with the new y, as sjtu_drone
            has it: without a time constant, a jump of the command gives no rate.

    Attributes:
        integral: of the error.
    """

    def __init__(self, parameters: Parameters, prefix: str,
                 gains: Tuple[float, float, float] = (0.0, 0.0, 0.0),
                 filters_rate: bool = False) -> None:
        self._p = parameters.number(f"{prefix}ProportionalGain", gains[0])
        self._i = parameters.number(f"{prefix}IntegralGain", gains[1])
        self._d = parameters.number(f"{prefix}DifferentialGain", gains[2])
        self._filters_rate = filters_rate
        self._time_constant = max(0.0, parameters.number(f"{prefix}TimeConstant", 0.0))
        self._limit = parameters.number(f"{prefix}Limit", -1.0)
        self.reset()

    def reset(self) -> None:
        """Forget commands and errors."""
        self._filtered = self.integral = 0.0

    def update(self, command: float, value: float, rate: float, dt: float) -> float:
        """Return the output for a value and its rate, `dt` s (above 0) after the last call."""
        if self._limit > 0.0:
            command = max(-self._limit, min(self._limit, command))
        command_rate = (command - self._filtered) / (dt + self._time_constant)
        self._filtered += command_rate * dt
        if self._filters_rate:
            command_rate = (command - self._filtered) / (dt + self._time_constant)
        error = self._filtered - value
        self.integral += error * dt
        return self._p * error + self._d * (command_rate - rate) + self._i * self.integral
