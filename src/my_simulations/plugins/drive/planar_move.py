"""libgazebo_ros_planar_move.so: a model that follows a planar velocity command.

Parameters, defaults, topics and laws are those of gazebo_plugins: before every step the model gets
the velocity of the last command, its vertical velocity included, which is 0.
"""
from __future__ import annotations

import math
from typing import Tuple

from ...geometry import Pose, Twist, rpy_from_quat
from .odometry import heading_velocity
from .velocity_drive import VelocityDrive


class PlanarMove(VelocityDrive):
    """Moves a model in its own x and y, and about the vertical."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._odometer = self.make_odometer()
        timeout = p.number("cmdTimeout", -1.0)
        self.follow_commands(100.0 if timeout < 0.0 else 0.0,
                             timeout=timeout if timeout >= 0.0 else None)
        self._last: Tuple[int, Pose] = (context.now_ns, context.pose)
        hertz = p.number("odometryRate", 20.0)
        if hertz > 0.0:
            context.observe(hertz, self.publish, self._odometer.topics, transforms=True,
                            resume=self.clock_set)
        self._drive()

    def clock_set(self) -> None:
        """Compute velocities from the present time and pose on."""
        super().clock_set()
        self._last = (self.context.now_ns, self.context.pose)

    def _drive(self) -> None:
        """Pass the command to the engine, which applies it in every step."""
        self.context.set_planar_velocity(self._command.x, self._command.y, self._command.yaw)

    def publish(self) -> None:
        """Publish odometry: where the model is, and how fast it went since the last time."""
        (before_ns, before), pose = self._last, self.context.pose
        self._last = (self.context.now_ns, pose)
        dt = (self.context.now_ns - before_ns) * 1e-9
        self._odometer.transform(pose)
        if dt <= 0.0:
            return
        linear = tuple((a - b) / dt for a, b in zip(pose.position, before.position))
        turned = math.remainder(rpy_from_quat(pose.orientation)[2]
                                - rpy_from_quat(before.orientation)[2], 2.0 * math.pi)
        yaw = self._command.yaw if abs(self._command.yaw) > math.pi / dt else turned / dt
        x, y, _ = pose.position
        self._odometer.publish(pose._replace(position=(x, y, 0.0)), heading_velocity(
            pose, Twist((linear[0], linear[1], 0.0), (0.0, 0.0, yaw))))
