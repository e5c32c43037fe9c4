"""libgazebo_ros_ackerman.so: four driven wheels, of which the front ones are steered (LIMO).

Parameters, defaults, topics and lengths are those of limo_gazebo_sim: controllers of ros_control
steer the wheels by their `command` topics. Where it differs: the wheels on both sides roll by their
distances from the centre of the turn (original: by 0.4 of the track); a turn on the spot leaves the
wheels straight; `<leftHingeJoint>` and `<rightHingeJoint>` are not used, as there.
"""
from __future__ import annotations

import math

from ..frames import data_message
from .skid_steer_drive import SkidSteerDrive

_WHEEL_BASE, _TRACK = 0.2, 0.172   # m
_MOST_ANGLE = math.radians(30.0)
_COMMANDS = ("limo_fl_steering_hinge_controller/command",
             "limo_fr_steering_hinge_controller/command")


class LimoAckermann(SkidSteerDrive):
    """`angular.z` of a command is the yaw rate."""

    def load(self) -> None:
        self._steers = [self.context.publish(name, "std_msgs/Float64", 50) for name in _COMMANDS]
        super().load()

    def _drive(self) -> None:
        speed, yaw = self._command.x, self._command.yaw
        angle = math.atan2(abs(yaw) * _WHEEL_BASE, abs(speed)) if speed else 0.0
        slope = math.copysign(math.tan(min(angle, _MOST_ANGLE)), yaw) / _WHEEL_BASE
        for side, steer in zip((0.5, -0.5), self._steers):
            # The radius of the circle of a wheel is 1 / slope less its distance to the left.
            share = 1.0 - slope * side * _TRACK
            turned = math.atan(slope * _WHEEL_BASE / share)
            turned = max(-_MOST_ANGLE, min(_MOST_ANGLE, turned))
            front, rear = self._joints[0 if side > 0.0 else 1::2]
            front.drive(speed * share / math.cos(turned) / self._radius, self._torque)
            rear.drive(speed * share / self._radius, self._torque)
            steer.publish(data_message(self.context, "std_msgs/Float64", turned))
