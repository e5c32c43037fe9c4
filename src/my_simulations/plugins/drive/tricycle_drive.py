"""libgazebo_ros_tricycle_drive.so: one driven and steered wheel, two wheels that are counted.

Parameters, defaults, topics and laws are those of gazebo_plugins. Where it differs: wheel frames
are those of the links; which encoder wheel is on the left is seen from where it is (the original
subtracts the right one from the left one, and its own robot has the names the other way round);
the acceleration acts where the wheel gets faster, the deceleration where it gets slower; a steering
speed steers to the angle, and not to the speed of the wheel; a servo of the engine holds the angle,
so `<steeringAngleTolerance>` has no effect.
"""
from __future__ import annotations

import math
from typing import Tuple

from ...engine.drive_commands import JointServo
from ...geometry import inverse, transform
from ..context import Joint
from .odometry import WheelCounter
from .velocity_drive import OdometryDrive

_MOST_STEERING = math.pi / 2.0
_SAME_ANGLE = 1e-6   # rad


class TricycleDrive(OdometryDrive):
    """`linear.x` of a command is the speed of the driven wheel, `angular.z` the steering angle."""

    def load(self) -> None:
        context, p = self.enter_namespace(self.context.model)
        self._radius = p.positive("actuatedWheelDiameter", 0.15) / 2.0
        self._torque = p.number("wheelTorque", 5.0)
        self._acceleration = p.number("wheelAcceleration", 0.0)
        self._deceleration = p.number("wheelDeceleration", self._acceleration)
        self._speed_tolerance = p.number("wheelSpeedTolerance", 0.01)
        self._steering_speed = p.number("steeringSpeed", 0.0)
        self._encoder = p.choice("odometrySource", {"encoder": True, "world": False}, False)
        self._steering = context.joint(p.text("steeringJoint", "front_steering_joint"))
        self._wheel = context.joint(p.text("actuatedWheelJoint", "front_wheel_joint"))
        left = context.joint(p.text("encoderWheelLeftJoint", "left_wheel_joint"))
        right = context.joint(p.text("encoderWheelRightJoint", "right_wheel_joint"))
        self._counter = WheelCounter(*self._by_side(left, right),
                                     p.positive("encoderWheelDiameter", 0.15) / 2.0,
                                     p.positive("encoderWheelSeparation", 0.5))
        self._odometer = self.make_odometer(base="base_link")
        self.offer_wheels((self._steering, self._wheel, left, right), with_motion=True)
        hertz = p.number("updateRate", 100.0)
        self.follow_commands(hertz)
        self.reset()
        context.observe(hertz, self.publish, self.topics, transforms=True,
                        remembers=self._encoder)

    def _by_side(self, left: Joint, right: Joint) -> Tuple[Joint, Joint]:
        """The wheel further to the left first."""
        back = inverse(self.context.pose)
        one, other = (transform(back, self.context.link(joint.child).pose.position)[1]
                      for joint in (left, right))
        return (left, right) if one >= other else (right, left)

    def _drive(self) -> None:
        """Stop the wheel, and turn the steering to 0."""
        self._wheel.drive(0.0, self._torque)
        self._change.begin()

    def _follow(self, dt: float) -> bool:
        """Approach the command; return whether motor and servo have reached it."""
        self._steer(max(-_MOST_STEERING, min(_MOST_STEERING, self._command.yaw)))
        wanted, present = self._command.x / self._radius, self._wheel.velocity
        rate = self._compute_wheel_rate(wanted, present, dt)
        self._wheel.drive(rate, self._torque)
        return rate == wanted

    def _compute_wheel_rate(self, wanted: float, present: float, dt: float) -> float:
        """The rate of the wheel after `dt` s, rad/s."""
        if self._acceleration > 0.0:
            slower = abs(wanted) < abs(present) and wanted * present >= 0.0
            most = (self._deceleration if slower else self._acceleration) * dt
            if abs(wanted - present) > max(most, self._speed_tolerance):
                return present + math.copysign(most, wanted - present)
        return wanted

    def _steer(self, wanted: float) -> None:
        """With a steering speed the motor turns; without one the wheel is turned at once."""
        if self._steering_speed > 0.0:
            self._steering.set_servo(JointServo(
                0, "position", target=wanted, most_rate=self._steering_speed,
                most_effort=self._torque))
            return
        self._steering.set_servo(JointServo(0, "position", target=wanted))
        if abs(wanted - self._steering.position) > _SAME_ANGLE:
            self.context.set_joint_positions({self._steering.name: wanted})
