"""libPriusHybridPlugin.so: the car of car_demo.

Parameters, topic and laws are those of car_demo's PriusHybridPlugin. Where it differs: laws of the
drive are computed at 100 Hz, not in every step; drag acts at the origin of the chassis, not at its
centre of mass; there is no keyboard, and no battery and fuel gauge, which only Gazebo's own
transport showed.
"""
from __future__ import annotations

import math
from math import dist
from typing import Any, List

from ...description.shapes import Cylinder, Sphere
from ...engine.drive_commands import JointServo, PidGains
from ...engine.wrench_laws import BodyDrag
from ...geometry import ZERO3, add, norm, scale
from ..base import Plugin
from ..context import Joint
from ..finite_messages import subscribe_finite
from ..time_out import TimeOut
from .wheels import apply_torque

_KIND = "prius_msgs/Control"
_HERTZ = 100.0
_RADIUS = 0.3                 # m, of wheels without a round collision
_PATIENCE = 0.3               # s, for the next command
_WHEEL_TURN = 7.85            # rad: the steering wheel at full lock
_MOST_STEERING = 0.8727       # rad, of a front wheel
_STEERING_EFFORT, _STEERING_WHEEL_EFFORT = 5000.0, 10.0   # N m
_MILES_AN_HOUR = 2.23694      # in 1 m/s
_CREEP_ENDS = 7.0             # miles/h: below, the car creeps; above, it brakes a little
_GEARS = {1: 0.0, 2: 1.0, 3: -1.0}   # prius_msgs/Control: neutral, forward, reverse


class PriusHybrid(Plugin):
    """Follows prius_msgs/Control on the topic `prius`: throttle, brake, steering and gear."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        context.use_namespace(p.text("robotNamespace"))
        self._front = self._joints("front_{}_wheel")
        self._back = self._joints("back_{}_wheel")
        self._steering = self._joints("front_{}_wheel_steering")
        self._steering_wheel = context.joint(p.text("steering_wheel"))
        self._radius = self._wheel_radius()
        self._torques = p.number("front_torque", 0.0), p.number("back_torque", 2000.0)
        self._brakes = p.number("front_brake_torque", 2000.0), p.number("back_brake_torque", 2000.0)
        self._most_speed = p.number("max_speed", 10.0)
        self._most_steering = min(_MOST_STEERING, p.number("max_steer", 0.6))
        self._gains = [self._gains_of(f"{side}wheel_steering") for side in ("fl", "fr")]
        chassis = p.text("chassis")
        self._chassis = context.link(chassis)
        self._half_track_by_base = self._geometry()
        drag = p.number("chassis_aero_force_gain", 1.0)
        self._law = BodyDrag((drag,) * 3, ZERO3, ZERO3, math.inf)
        self._time_out = TimeOut(context, _PATIENCE)
        subscribe_finite(context, "prius", _KIND, self._receive, queue=10)
        self.reset()
        context.every(_HERTZ, self._drive)

    def reset(self) -> None:
        self._throttle = self._brake = self._steer = 0.0
        self._hand_brake, self._gear = 1.0, 1.0
        self.context.set_wrench_law(self._chassis.name, self._law)
        self._drive()

    def _joints(self, element: str) -> List[Joint]:
        """The left and the right joint that the elements of a name with a gap name."""
        names = [element.format(side) for side in ("left", "right")]
        return [self.context.joint(self.context.parameters.text(name)) for name in names]

    def _gains_of(self, loop: str) -> PidGains:
        p, i, d = (self.context.parameters.number(f"{loop}_{term}_gain", 0.0) for term in "pid")
        return PidGains(p, i, d)

    def _wheel_radius(self) -> float:
        """Of the round collision of a front wheel, m."""
        wheel = self._front[0].child
        shapes = [collision.geometry for link in self.context.description.links
                  if link.name == wheel for collision in link.collisions]
        return next((shape.radius for shape in shapes if isinstance(shape, (Cylinder, Sphere))),
                    _RADIUS)

    def _geometry(self) -> float:
        """Half the distance of the front wheels, in units of the wheelbase."""
        left, right, back_left, back_right = (
            self.context.link(joint.child).pose.position for joint in (*self._front, *self._back))
        front, back = scale(add(left, right), 0.5), scale(add(back_left, back_right), 0.5)
        return dist(left, right) / 2.0 / dist(front, back)

    def _receive(self, message: Any) -> None:
        self._throttle = max(0.0, min(1.0, message.throttle))
        self._brake = max(0.0, min(1.0, message.brake))
        self._steer = max(-1.0, min(1.0, message.steer))
        self._gear = _GEARS.get(message.shift_gears, self._gear)
        if self._throttle > 0.0:
            self._hand_brake = 0.0
        self._time_out.begin()

    def _drive(self) -> None:
        if self._time_out.is_over:
            self._throttle = self._brake = self._steer = 0.0
        self._turn_wheels()
        creep = _creep(norm(self._chassis.twist.linear) * _MILES_AN_HOUR)
        throttle = max(self._throttle, creep)
        brake = self._brake + self._hand_brake
        if self._gear != 0.0:
            brake = max(brake, -creep - self._throttle)
        brake = min(1.0, brake)
        for wheels, torque, most in zip((self._front, self._back), self._torques, self._brakes):
            for wheel in wheels:
                apply_torque(wheel, self._gear * throttle * torque, brake * most,
                             self._most_speed / self._radius)

    def _turn_wheels(self) -> None:
        """Steer so that the axes of all wheels meet in a point (Ackermann)."""
        self._steering_wheel.set_servo(JointServo(
            0, "effort", target=self._steer * _WHEEL_TURN, gains=PidGains(100.0, 0.0, 10.0),
            most_effort=_STEERING_WHEEL_EFFORT))
        tangent = math.tan(self._steer * self._most_steering)
        for joint, gains, side in zip(self._steering, self._gains, (-1.0, 1.0)):
            angle = math.atan2(tangent, 1.0 + side * self._half_track_by_base * tangent)
            joint.set_servo(JointServo(0, "effort", target=angle, gains=gains,
                                       most_effort=_STEERING_EFFORT))


def _creep(speed: float) -> float:
    """The throttle of a car whose pedal is free, by its speed in miles/h; below 0 it brakes."""
    if speed <= _CREEP_ENDS:
        return 0.1 * (1.0 - speed / _CREEP_ENDS)
    return max(-0.025, 0.025 * (_CREEP_ENDS - speed))
