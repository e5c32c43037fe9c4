"""diff_drive_controller: wheels on two sides, odometry of their turning.

Parameters, topics, limits and the integration are those of ros_controllers. Updates come 100 times
a second of sim time, or as often as `controlPeriod` says; ramps are exact to that.
"""
from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Any, Deque, List, Optional, Tuple

from ...description.model import Joint as JointSpec
from ...description.shapes import Cylinder, Sphere
from ...geometry import Vec3, norm, subtract, transform
from ..context import PluginError
from ..drive.odometry import diagonal, fill_pose, planar
from .controller import Controller
from .hardware import VELOCITY, HardwareJoint
from .settings import Settings

_UPDATE_HZ = 100.0
_ORIGINAL_HZ = 1000.0


@dataclass(frozen=True)
class SpeedLimits:
    """Limits of one velocity: (least, greatest), or None; m/s or rad/s, and per s, and per s^2."""

    velocity: Optional[Tuple[float, float]] = None
    acceleration: Optional[Tuple[float, float]] = None
    jerk: Optional[Tuple[float, float]] = None

    def limited(self, wanted: float, last: float, before: float, dt: float) -> float:
        """A velocity within the limits, after `last`, and `before` that."""
        if self.jerk is not None:
            change = 2.0 * dt * dt
            wanted = last + (last - before) + _clamped(
                wanted - last - (last - before), self.jerk[0] * change, self.jerk[1] * change)
        if self.acceleration is not None:
            wanted = last + _clamped(wanted - last, self.acceleration[0] * dt,
                                     self.acceleration[1] * dt)
        if self.velocity is not None:
            wanted = _clamped(wanted, *self.velocity)
        return wanted


def speed_limits(settings: Settings, path: str) -> SpeedLimits:
    """Of `linear/x` or `angular/z`."""
    found: List[Optional[Tuple[float, float]]] = []
    for kind in ("velocity", "acceleration", "jerk"):
        most = settings.number(f"{path}/max_{kind}", 0.0)
        pair = (settings.number(f"{path}/min_{kind}", -most), most)
        found.append(pair if settings.flag(f"{path}/has_{kind}_limits", False) else None)
    return SpeedLimits(*found)


class DiffDriveController(Controller):
    """Wheels `left_wheel` and `right_wheel`: a joint each, or several."""

    def load(self) -> None:
        """Read parameters; take the wheels; offer topics."""
        s = self.settings
        names = [s.texts("left_wheel"), s.texts("right_wheel")]
        if len(names[0]) != len(names[1]):
            raise PluginError(f"{self.name} has {len(names[0])} left and {len(names[1])} right"
                              " wheels")
        self._sides = [[self.take(VELOCITY, name) for name in side] for side in names]
        self._read_geometry(names[0][0], names[1][0])
        self._publish_hz = s.number("publish_rate", 50.0)
        self._open_loop = s.flag("open_loop", False)
        self._timeout = s.number("cmd_vel_timeout", 0.5)
        self._limits = (speed_limits(s, "linear/x"), speed_limits(s, "angular/z"))
        self._hertz = 1.0 / self.period if self.period else max(_UPDATE_HZ, self._publish_hz)
        window = s.number("velocity_rolling_window_size", 10.0) * self._hertz / _ORIGINAL_HZ
        self._window = max(1, round(window))
        self._frames = (s.text("odom_frame_id", "odom"), s.text("base_frame_id", "base_link"))
        self._broadcasts = s.flag("enable_odom_tf", True)
        self._covariances = [diagonal(tuple(s.numbers(f"{what}_covariance_diagonal", 6,
                                                      [0.0] * 6))) for what in ("pose", "twist")]
        self._odom = self.publish("odom", "nav_msgs/Odometry", 100)
        self._limited = self.publish("cmd_vel_out", "geometry_msgs/TwistStamped", 100) \
            if s.flag("publish_cmd", False) else None
        self._command = (0.0, 0.0)
        self._heard_ns: Optional[int] = None
        self.subscribe("cmd_vel", "geometry_msgs/Twist", self._hear)
        self._pose = (0.0, 0.0, 0.0)

    def start(self) -> None:
        """Stand; count from here."""
        self._heard_ns, self._command = None, (0.0, 0.0)
        self._last = self._before = (0.0, 0.0)
        self._velocities: Deque[Tuple[float, float]] = deque(maxlen=self._window)
        self._turned = self._wheel_ways()
        self._now_ns = self.context.now_ns
        self._drive(0.0, 0.0)
        self.every(self._hertz, self._update)
        if self._publish_hz > 0.0:
            self.every(self._publish_hz, self._tell)

    def stop(self) -> None:
        """Stand."""
        self._drive(0.0, 0.0)

    def _read_geometry(self, left: str, right: str) -> None:
        s = self.settings
        separation, radius = s.number("wheel_separation", 0.0), s.number("wheel_radius", 0.0)
        joints = [self.context.joint(name).spec for name in (left, right)]
        if s.get("wheel_separation") is None:
            separation = norm(subtract(self._place(joints[0]), self._place(joints[1])))
        if s.get("wheel_radius") is None:
            radius = self._radius_of(joints[0])
        both = s.number("wheel_radius_multiplier", 0.0)
        self._separation = separation * s.number("wheel_separation_multiplier", 1.0)
        self._radii = tuple(radius * (both if s.get("wheel_radius_multiplier") is not None else
                                      s.number(f"{side}_wheel_radius_multiplier", 1.0))
                            for side in ("left", "right"))
        if self._separation <= 0.0 or min(self._radii) <= 0.0:
            raise PluginError(f"{self.name}: wheels are {self._separation:g} m apart, with a radius"
                              f" of {min(self._radii):g} m; both must be positive")

    def _place(self, joint: JointSpec) -> Vec3:
        for link in self.context.description.links:
            if link.name == joint.child:
                return transform(link.pose, joint.pose.position)
        raise PluginError(f"joint '{joint.name}' has no child link")

    def _radius_of(self, joint: JointSpec) -> float:
        for link in self.context.description.links:
            if link.name == joint.child:
                for collision in link.collisions:
                    if isinstance(collision.geometry, (Cylinder, Sphere)):
                        return collision.geometry.radius
        raise PluginError(f"the wheel of joint '{joint.name}' is no cylinder or sphere: set"
                          f" {self.name}/wheel_radius")

    def _hear(self, message: Any) -> None:
        speeds = (float(message.linear.x), float(message.angular.z))
        if all(map(math.isfinite, speeds)):
            self._command, self._heard_ns = speeds, self.context.now_ns

    def _update(self) -> None:
        """Odometry first, then the command, as the original."""
        now = self.context.now_ns
        dt = (now - self._now_ns) * 1e-9
        self._now_ns = now
        if dt <= 0.0:
            return
        self._count(dt)
        wanted = self._command
        if self._heard_ns is None or (now - self._heard_ns) * 1e-9 > self._timeout:
            wanted = (0.0, 0.0)
        x, yaw = (limits.limited(new, last, before, dt) for limits, new, last, before in zip(
            self._limits, wanted, self._last, self._before))
        self._before, self._last = self._last, (x, yaw)
        self._drive(x, yaw)
        if self._limited is not None:
            message = self.context.message("geometry_msgs/TwistStamped")
            message.header.stamp = self.context.stamp()
            message.twist.linear.x, message.twist.angular.z = x, yaw
            self._limited.publish(message)

    def _drive(self, x: float, yaw: float) -> None:
        for side, radius, sign in zip(self._sides, self._radii, (-1.0, 1.0)):
            for wheel in side:
                wheel.command((x + sign * yaw * self._separation / 2.0) / radius)

    def _wheel_ways(self) -> Tuple[float, float]:
        left, right = (radius * _mean(side) for side, radius in zip(self._sides, self._radii))
        return left, right

    def _count(self, dt: float) -> None:
        """Integrate an arc, exactly."""
        if self._open_loop:
            way, turn = self._last[0] * dt, self._last[1] * dt
        else:
            before, self._turned = self._turned, self._wheel_ways()
            left, right = (a - b for a, b in zip(self._turned, before))
            way, turn = (left + right) / 2.0, (right - left) / self._separation
        x, y, yaw = self._pose
        half = turn / 2.0
        chord = way * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        self._pose = (x + chord * math.cos(yaw + half), y + chord * math.sin(yaw + half),
                      yaw + turn)
        self._velocities.append((way / dt, turn / dt))

    def _tell(self) -> None:
        pose = planar(*self._pose)
        if self._broadcasts:
            self.context.transform(*self._frames, pose)
        if not self._odom.wanted:
            return
        message = self.context.message("nav_msgs/Odometry")
        message.header.stamp = self.context.stamp()
        message.header.frame_id, message.child_frame_id = self._frames
        fill_pose(message.pose.pose, pose)
        message.pose.covariance, message.twist.covariance = map(list, self._covariances)
        count = max(1, len(self._velocities))
        message.twist.twist.linear.x = sum(one for one, _ in self._velocities) / count
        message.twist.twist.angular.z = sum(one for _, one in self._velocities) / count
        self._odom.publish(message)


def _mean(wheels: List[HardwareJoint]) -> float:
    return sum(wheel.position for wheel in wheels) / len(wheels)


def _clamped(value: float, least: float, most: float) -> float:
    return max(least, min(most, value))
