"""libgazebo_ros_skid_steer_drive.so: four driven wheels that skid, odometry of the world.

Parameters, defaults, topics and laws are those of gazebo_plugins.
"""
from __future__ import annotations

from .odometry import heading_velocity
from .velocity_drive import VelocityDrive

_CORNERS = ("leftFront", "rightFront", "leftRear", "rightRear")


class SkidSteerDrive(VelocityDrive):
    def load(self) -> None:
        context, p = self.enter_namespace()
        self._separation = p.positive("wheelSeparation", 0.4)
        self._radius = p.positive("wheelDiameter", 0.15) / 2.0
        self._torque = p.number("torque", 5.0)
        self._joints = [context.joint(p.text(f"{corner}Joint", _default(corner)))
                        for corner in _CORNERS]
        unsure = (p.number("covariance_x", 1e-4), p.number("covariance_y", 1e-4), 1e12, 1e12,
                  1e12, p.number("covariance_yaw", 1e-2))
        self._odometer = self.make_odometer(unsure, unsure)
        self._broadcasts = p.flag("broadcastTF", False)
        hertz = p.number("updateRate", 100.0)
        self.follow_commands(hertz)
        self.reset()
        context.observe(hertz, self.publish, self._odometer.topics, transforms=self._broadcasts)

    def publish(self) -> None:
        pose = self.context.pose
        if self._broadcasts:
            self._odometer.transform(pose)
        x, y, _ = pose.position
        self._odometer.publish(pose._replace(position=(x, y, 0.0)),
                               heading_velocity(pose, self.context.twist))

    def _drive(self) -> None:
        for joint, speed in zip(self._joints, 2 * self._command.wheel_speeds(self._separation)):
            joint.drive(speed / self._radius, self._torque)


def _default(corner: str) -> str:
    """`left_front_joint` of leftFront."""
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter
                   for letter in corner) + "_joint"
