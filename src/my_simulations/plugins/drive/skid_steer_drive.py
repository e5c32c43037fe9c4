"""libgazebo_ros_skid_steer_drive.so: four driven wheels that skid, odometry of the world.

Parameters, defaults, topics and laws are those of gazebo_plugins.
"""
from __future__ import annotations

from ..base import Plugin
from ..stepwise_change import StepwiseChange
from .odometry import Odometer, in_base
from .wheels import VelocityCommand

_CORNERS = ("leftFront", "rightFront", "leftRear", "rightRear")


class SkidSteerDrive(Plugin):
    def load(self) -> None:
        context, p = self.enter_namespace()
        self._separation = p.positive("wheelSeparation", 0.4)
        self._radius = p.positive("wheelDiameter", 0.15) / 2.0
        self._torque = p.number("torque", 5.0)
        self._joints = [context.joint(p.text(f"{corner}Joint", _default(corner)))
                        for corner in _CORNERS]
        unsure = (p.number("covariance_x", 1e-4), p.number("covariance_y", 1e-4), 1e12, 1e12,
                  1e12, p.number("covariance_yaw", 1e-2))
        self._odometer = Odometer(context, p.text("odometryTopic", "odom"),
                                  p.text("odometryFrame", "odom"),
                                  p.text("robotBaseFrame", "base_footprint"), unsure, unsure)
        self._broadcasts = p.flag("broadcastTF", False)
        hertz = p.number("updateRate", 100.0)
        self._change = StepwiseChange(context, hertz, self._follow)
        self._command = VelocityCommand(context, p.text("commandTopic", "cmd_vel"),
                                        change=self._change)
        self.reset()
        context.observe(hertz, self.publish, self._odometer.topics, transforms=self._broadcasts)

    def reset(self) -> None:
        self._command.stop()
        self._change.end()
        self._drive()

    def publish(self) -> None:
        pose = self.context.pose
        if self._broadcasts:
            self._odometer.transform(pose)
        x, y, _ = pose.position
        self._odometer.publish(pose._replace(position=(x, y, 0.0)),
                               in_base(pose, self.context.twist))

    def _follow(self, dt: float) -> bool:
        self._drive()
        return True

    def _drive(self) -> None:
        turn = self._command.yaw * self._separation / 2.0
        for n, joint in enumerate(self._joints):
            speed = self._command.x + (turn if n % 2 else -turn)
            joint.drive(speed / self._radius, self._torque)


def _default(corner: str) -> str:
    """`left_front_joint` of leftFront."""
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter
                   for letter in corner) + "_joint"
