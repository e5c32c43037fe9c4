"""libgazebo_ros_force_based_move.so (hector): forces on the base make it follow a velocity command.

Parameters, defaults, topics and laws are those of hector_gazebo_plugins and of its copies
(librobotnik_force_based_move.so, libridgeback_ros_force_based_move.so, libwpr_plugin.so,
libnexus_ros_force_based_move.so), which differ in their watchdogs, gains and limits: in every step
a force along x and y of the base, and a torque about its vertical, in proportion to its velocity
error, which the engine computes. Odometry is the true pose relative to the initial one. Where it
differs: Robotnik's robots brake when the watchdog has stopped them (original: they are put back to
one place), and continue to publish their odometry.
"""
from __future__ import annotations

import math
from typing import Optional

from ...engine.wrench_laws import VelocityForce
from ...geometry import Vec3, rpy_from_quat
from ..context import PluginError
from .odometry import planar_pose
from .velocity_drive import VelocityDrive

_STRAIGHT = 1e-4  # rad/s: at most this, a robot counts as moving straight (hector_gazebo)


class ForceBasedMove(VelocityDrive):
    """Pushes the link `<robotBaseFrame>`, or the model's first one."""

    watchdog = ("commandTimeoutDuration", 0.0)
    """Name and default of the element: seconds after which a command no longer applies."""

    never: Optional[float] = 0.0
    """The time that means never; None where any time ends, one of 0 after a single step."""

    usual_gains = (10000.0, 10000.0, 100.0)
    """Where the elements are missing: N s/m along x and y, N m s/rad about z."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        base = p.text("robotBaseFrame", "base_footprint")
        try:
            self._base = context.link(base)
        except PluginError:  # the frame of its messages alone
            self._base = context.link(context.description.links[0].name)
        self._gains = (p.number("x_velocity_p_gain", self.usual_gains[0]),
                       p.number("y_velocity_p_gain", self.usual_gains[1]),
                       p.number("yaw_velocity_p_gain", self.usual_gains[2]))
        self._odometer = self.make_odometer((1e-3, 1e-3, 1e12, 1e12, 1e12, 0.01),
                                            (1e-3, 1e-3, 1e-3, 1e12, 1e12, 0.01))
        self._broadcasts = p.flag("publishOdometryTf", True)
        self._sideways = p.flag("allowLateralMotion", True)
        self._fastest = self.fastest()
        seconds = p.number(*self.watchdog)
        self.follow_commands(0.0, timeout=None if seconds == self.never else seconds)
        self.restart_odometry()
        self._drive()
        hertz = p.number("odometryRate", 20.0)
        if hertz > 0.0:
            context.observe(hertz, self.publish, self._odometer.topics, transforms=self._broadcasts)

    def fastest(self) -> Vec3:
        """Upper limits of a command: m/s along x and y, rad/s about z."""
        return (math.inf, math.inf, math.inf)

    def restart_odometry(self) -> None:
        """Start the odometry at the pose of the robot, as in the original."""
        pose = self.context.pose
        self._start = (pose.position[0], pose.position[1], rpy_from_quat(pose.orientation)[2])

    def _drive(self) -> None:
        command = self._command
        x, y, yaw = self._fastest
        self.context.set_wrench_law(self._base.name, VelocityForce(
            self._gains, min(command.x, x), min(command.y, y) if self._sideways else 0.0,
            min(command.yaw, yaw)))

    def publish(self) -> None:
        """Publish odometry: truth, from where the robot began."""
        pose, twist = self.context.pose, self.context.twist
        x0, y0, yaw0 = self._start
        dx, dy = pose.position[0] - x0, pose.position[1] - y0
        c, s = math.cos(yaw0), math.sin(yaw0)
        yaw = rpy_from_quat(pose.orientation)[2]
        here = planar_pose(c * dx + s * dy, c * dy - s * dx, yaw - yaw0)
        if self._broadcasts:
            self._odometer.transform(here)
        c, s = math.cos(yaw), math.sin(yaw)
        vx, vy, _ = twist.linear
        turning = twist.angular[2]
        self._odometer.publish(here, (c * vx + s * vy, c * vy - s * vx, turning),
                               None if abs(turning) < _STRAIGHT else 100.0)


class RobotnikForceBasedMove(ForceBasedMove):
    """The copy in robotnik_gazebo_plugins."""

    watchdog = ("commandWatchdog", 2.0)
    never = None


class RidgebackForceBasedMove(ForceBasedMove):
    """The copy in ridgeback_gazebo_plugins."""

    watchdog = ("cmdVelTimeOut", 0.25)
    never = None


class WprForceBasedMove(ForceBasedMove):
    """The copy in wpr_simulation."""

    usual_gains = (40000.0, 30000.0, 500.0)


class NexusForceBasedMove(RidgebackForceBasedMove):
    """The copy in nexus_4wd_mecanum_gazebo, whose limit along x also applies to y."""

    usual_gains = (15.0, 15.0, 1.0)

    def fastest(self) -> Vec3:
        p = self.context.parameters
        x = p.number("max_x_velocity", 0.6)
        return (x, x, p.number("max_yaw_velocity", 0.5))
