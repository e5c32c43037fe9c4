"""hector_quadrotor_controller_gazebo: a flying body that controllers push by a wrench.

Parameters, topics, service and laws are those of hector_quadrotor. Position, velocity and attitude
controllers form a chain: each one gives the next its command, and the last one gives the wrench, in
the axes of the first link. Where it differs: states are always the true ones (`state_topic`,
`imu_topic`); without the package hector_uav_msgs there is no service `enable_motors`, and the
motors run from the start.
"""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence

from ...description.transmission import Transmission
from ...engine.wrench_laws import Wrench
from ...geometry import Vec3, conjugate, norm, rotate, rpy_from_quat, scale
from ..call_slot import CallSlot
from ..context import Context, PluginError
from ..flight.body_wrench import NO_WRENCH, hold_wrench
from ..frames import add_tf_prefix
from ..standard_messages import wrench_message
from .hardware import Hardware
from .settings import Settings


class TwistCommand(NamedTuple):
    """A velocity, m/s, and a yaw rate, rad/s; `in_world`, else in axes that turn with the yaw."""

    linear: Vec3 = (0.0, 0.0, 0.0)
    yaw_rate: float = 0.0
    stamp_ns: int = 0
    in_world: bool = True


class AttitudeCommand(NamedTuple):
    """Roll and pitch, rad, yaw rate, rad/s, and thrust, N."""

    roll: float = 0.0
    pitch: float = 0.0
    yaw_rate: float = 0.0
    thrust: float = 0.0
    stamp_ns: int = 0


class ScalarLimits(NamedTuple):
    """Limits of a number; infinite for none. Source: hector_quadrotor_interface, FieldLimiter."""

    least: float
    most: float

    def clamp(self, value: float) -> float:
        return max(self.least, min(self.most, value))


def read_limits(s: Settings, path: str) -> ScalarLimits:
    """Read `min` and `max` below a path; `min` is the opposite of `max` by default."""
    most = s.number(f"{path}/max", math.inf)
    return ScalarLimits(s.number(f"{path}/min", -most), most)


class VectorLimits:
    """Limits of x, y, z, of the norm, and of the norm of (x, y). Source: Vector3Limiter."""

    def __init__(self, s: Settings, path: str = "") -> None:
        below = f"{path}/" if path else ""
        self._axes = [read_limits(s, f"{below}{axis}") for axis in "xyz"]
        self._most = s.number(f"{below}max", math.inf)
        self._most_across = s.number(f"{below}max_xy", math.inf)

    def clamp(self, vector: Vec3) -> Vec3:
        x, y, z = (limits.clamp(value) for limits, value in zip(self._axes, vector))
        across = math.hypot(x, y)
        found: Vec3 = (x, y, z)
        if across > self._most_across:
            found = scale(found, self._most_across / across)
        size = norm(found)
        return scale(found, self._most / size) if size > self._most else found


class QuadrotorHardware(Hardware):
    """The chain of commands; it is worked off while the motors run.

    Attributes:
        link: the body.
        twist: the command of a position controller; None without one.
        attitude: the command of a velocity controller; None without one.
        preempted: a velocity command has come that ends position control.
        running: whether the motors run.
    """

    needs_transmissions = False

    def __init__(self, context: Context, transmissions: Sequence[Transmission]) -> None:
        super().__init__(context, [])
        self.link = context.link("")
        self.twist: Optional[TwistCommand] = None
        self.attitude: Optional[AttitudeCommand] = None
        self.preempted = self.running = False
        self._updates: Dict[int, Callable[[float], None]] = {}
        self._begins: Dict[int, Callable[[], None]] = {}
        self._timer = CallSlot()
        self._wrench = NO_WRENCH
        self._period = 0.0
        limits = Settings(context, "wrench_limits")
        self._limits = (VectorLimits(limits, "force"), VectorLimits(limits, "torque"))
        self._frame = add_tf_prefix(context, str(context.parameter("base_link_frame", "base_link")))
        self._wrenches = context.publish("command/wrench", "geometry_msgs/WrenchStamped")
        for name in ("state_topic", "imu_topic"):
            if context.parameter(name, ""):
                context.warn(f"parameter {name} is ignored; controllers use the true state")
        try:
            context.serve("enable_motors", "hector_uav_msgs/EnableMotors", self._enable_asked)
        except PluginError as missing:
            context.warn(f"the motors run, they cannot be stopped: {missing}")
            self.running = True

    # -- state -----------------------------------------------------------------------------------

    @property
    def yaw(self) -> float:
        """rad."""
        return rpy_from_quat(self.link.pose.orientation)[2]

    def to_body(self, vector: Vec3) -> Vec3:
        """Rotate a vector from world axes to body axes."""
        return rotate(conjugate(self.link.pose.orientation), vector)

    # -- the chain -------------------------------------------------------------------------------

    def join(self, place: int, update: Callable[[float], None], begin: Callable[[], None],
             period: float) -> None:
        """Add a controller to the chain.

        Args:
            place: its place in the chain.
            update: called with the time in s since its last call.
            begin: called when the motors start.
            period: s of sim time between calls of `update`; 0 for each step.
        """
        self._updates[place], self._begins[place] = update, begin
        if period != self._period:
            self._period = period
            self._timer.end()
        self._begin()

    def leave(self, place: int) -> None:
        """Remove a controller from the chain."""
        self._updates.pop(place, None)
        self._begins.pop(place, None)
        if not self._updates:
            self._end()

    def command(self, value: Wrench) -> None:
        """Apply a wrench, within the limits, to the body until the next call."""
        force, torque = (limits.clamp(part) for limits, part in zip(self._limits, value))
        self._wrench = (force, torque)

    def _enable_asked(self, request: Any, response: Any) -> None:
        self.run_motors(bool(request.enable))
        response.success = True

    def run_motors(self, running: bool) -> None:
        if running == self.running:
            return
        self.running = running
        if running:
            for begin in self._begins.values():
                begin()
            self._begin()
        else:
            self._end()

    def _begin(self) -> None:
        if self.running and self._updates and not self._timer.is_active:
            self._last_ns = self._context.now_ns
            self._timer.set(self._context.every(
                1.0 / self._period if self._period > 0.0 else 0.0, self._update))

    def _end(self) -> None:
        if self._timer.is_active:
            self._timer.end()
            self._wrench = NO_WRENCH
            hold_wrench(self._context, self.link, self._wrench)

    def _update(self) -> None:
        now = self._context.now_ns
        elapsed, self._last_ns = now - self._last_ns, now
        if elapsed <= 0:
            return   # the motors have just started, or time was set back
        for place in sorted(self._updates):
            self._updates[place](elapsed * 1e-9)
        if self._wrenches.wanted:
            self._wrenches.publish(wrench_message(self._context, self._frame, self._wrench))
        hold_wrench(self._context, self.link, self._wrench)
