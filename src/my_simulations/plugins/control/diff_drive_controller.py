"""diff_drive_controller: wheels on two sides, odometry of their turning."""
from __future__ import annotations

import math
from typing import Dict, List, Optional, Sequence, Tuple

from ...geometry import norm, subtract
from ..context import Context, PluginError, Publication
from ..frames import stamp_message
from ..reconfigure import Option, Reconfigure, Value
from .base_controller import BaseController, Planar
from .controller import RUNNING
from .hardware import VELOCITY, HardwareJoint

_MULTIPLIERS = tuple(f"{name}_multiplier" for name in (
    "left_wheel_radius", "right_wheel_radius", "wheel_separation"))
_OPTIONS = (
    *(Option(name, 1.0, 0.5, 1.5, "factor on the length of the file") for name in _MULTIPLIERS),
    Option("publish_rate", 50.0, 0.0, 2000.0, "Hz of the odometry"),
    Option("enable_odom_tf", True, False, True, "publish the transform from odom to the base"),
)


class DiffDriveController(BaseController):
    """Wheels `left_wheel` and `right_wheel`: a joint each, or several."""

    def load(self) -> None:
        super().load()
        values: Dict[str, Value] = dict(zip(_MULTIPLIERS, self._multipliers))
        self.keep_handle(Reconfigure(self.context, self.name, _OPTIONS, {
            **values, "publish_rate": self.publish_hz, "enable_odom_tf": self.broadcasts},
            self._reconfigure))

    def _reconfigure(self, values: Dict[str, Value]) -> None:
        left, right, wide = (float(values[name]) for name in _MULTIPLIERS)
        self._multipliers = left, right, wide
        self.publish_hz, self.broadcasts = (float(values["publish_rate"]),
                                            bool(values["enable_odom_tf"]))
        if self.state == RUNNING:
            self.drive(self.last)
            self.end_calls()
            self.observe_all()

    def observe_all(self) -> None:
        """Begin the odometry and what the controller publishes."""
        super().observe_all()
        if self._states is not None:
            self.observe(self.hertz, self._publish_states, [self._states.publication])

    def _publish_states(self) -> None:
        assert self._states is not None
        self._states.publish(self._rates(self.command))

    def load_wheels(self) -> None:
        s = self.settings
        names = [s.texts("left_wheel"), s.texts("right_wheel")]
        if len(names[0]) != len(names[1]):
            raise PluginError(f"{self.name} has {len(names[0])} left and {len(names[1])} right"
                              " wheels")
        self._sides = [[self.claim_joint(VELOCITY, name) for name in side] for side in names]
        self.counted = [wheel for side in self._sides for wheel in side]
        self._read_geometry(names[0][0], names[1][0])
        self._states: Optional[WheelStates] = None
        if s.flag("publish_wheel_joint_controller_state", False):
            self._states = WheelStates(self.context, self._sides, self.publish(
                "wheel_joint_controller_state", "control_msgs/JointTrajectoryControllerState", 100))

    def _read_geometry(self, left: str, right: str) -> None:
        s = self.settings
        joints = [self.context.joint(name).spec for name in (left, right)]
        separation = s.number("wheel_separation",
                              norm(subtract(*map(self.joint_location, joints))))
        radius = self.wheel_radius(joints[0])
        factors = [s.number(name, 1.0) for name in _MULTIPLIERS]
        if s.get("wheel_radius_multiplier") is not None:
            factors[:2] = [s.number("wheel_radius_multiplier", 0.0)] * 2
        self._multipliers = factors[0], factors[1], factors[2]
        self._lengths = radius, radius, separation
        self.positive(wheel_separation=self._separation, wheel_radius=min(self._radii))

    @property
    def _separation(self) -> float:
        """Between the wheels, m."""
        return self._lengths[2] * self._multipliers[2]

    @property
    def _radii(self) -> Tuple[float, float]:
        """Of the left and right wheels, m."""
        return self._lengths[0] * self._multipliers[0], self._lengths[1] * self._multipliers[1]

    def _rates(self, velocity: Planar) -> Tuple[float, float]:
        """The rates of the left and right wheels that roll without slip, rad/s."""
        x, _, yaw = velocity
        left, right = self._radii
        half = yaw * self._separation / 2.0
        return (x - half) / left, (x + half) / right

    def drive(self, velocity: Planar) -> None:
        """Drive each wheel so that it rolls without slip."""
        for side, rate in zip(self._sides, self._rates(velocity)):
            for wheel in side:
                wheel.command(rate)

    def displacement(self, dt: float) -> Planar:
        """Return the motion of the base from the rotation of the wheels."""
        if self.open_loop:
            return self.last[0] * dt, 0.0, self.last[2] * dt
        turned, count = self.count_rotations(), len(self._sides[0])
        left, right = (radius * sum(turns) / count for radius, turns in zip(
            self._radii, (turned[:count], turned[count:])))
        return (left + right) / 2.0, 0.0, (right - left) / self._separation


class WheelStates:
    """Publishes commanded and present states of the wheels, left wheels first.

    Args:
        context: of the plugin.
        sides: the left and the right wheels.
        publication: of the type control_msgs/JointTrajectoryControllerState.
    """

    def __init__(self, context: Context, sides: Sequence[Sequence[HardwareJoint]],
                 publication: Publication) -> None:
        self._context, self._sides, self.publication = context, sides, publication
        self._wheels = [wheel for side in sides for wheel in side]
        self._ahead = [0.0] * len(self._wheels)   # positions by the commands, rad
        self._before: List[Tuple[float, float]] = [(0.0, 0.0)] * len(self._wheels)
        self._told_ns = context.now_ns

    def publish(self, rates: Tuple[float, float]) -> None:
        """Publish the state; `rates` are commanded for the left and right wheels, rad/s."""
        message = stamp_message(self._context, "control_msgs/JointTrajectoryControllerState")
        message.joint_names = [wheel.name for wheel in self._wheels]
        now = self._context.now_ns
        dt, self._told_ns = (now - self._told_ns) * 1e-9, now
        wanted = [rate for side, rate in zip(self._sides, rates) for _ in side]
        turning = [wheel.velocity for wheel in self._wheels]
        self._ahead = [at + rate * dt for at, rate in zip(self._ahead, wanted)]
        desired, actual, error = message.desired, message.actual, message.error
        desired.positions, desired.velocities = list(self._ahead), wanted
        actual.positions, actual.velocities = [w.position for w in self._wheels], turning
        desired.accelerations, actual.accelerations = (
            [(new - old[which]) / dt if dt > 0.0 else 0.0
             for new, old in zip(rates_now, self._before)]
            for which, rates_now in enumerate((wanted, turning)))
        desired.effort = [math.nan] * len(self._wheels)
        for field in ("positions", "velocities", "accelerations"):
            setattr(error, field, [a - b for a, b in zip(getattr(desired, field),
                                                         getattr(actual, field))])
        self._before = list(zip(wanted, turning))
        self.publication.publish(message)
