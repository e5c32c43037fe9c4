"""ackermann_drive_controller: a rover with six driven wheels, of which four corners are steered.

Joints, parameters, topics and laws are those of the package of that name (curio,
curiosity_mars_rover): each wheel rolls about the centre of the turn that a command of speed and yaw
rate asks for; the odometry is that of the two wheels in the middle.
"""
from __future__ import annotations

import math
from typing import List, Tuple

from .base_controller import BaseController, Planar
from .hardware import POSITION, VELOCITY

_CORNERS = ("front_left", "front_right", "back_left", "back_right")
_MIDDLE = ("mid_left", "mid_right")


def compute_wheel_motion(x: float, y: float, speed: float, yaw_rate: float) -> Tuple[float, float]:
    """Return the steering angle (-pi/2..pi/2 rad) and the speed (m/s) of a rolling wheel.

    The wheel is at (x, y) of a base that moves forward at `speed` (m/s) and turns at `yaw_rate`
    (rad/s).
    """
    along, across = speed - yaw_rate * y, yaw_rate * x
    angle, size = math.atan2(across, along), math.hypot(along, across)
    if angle > math.pi / 2.0:
        return angle - math.pi, -size
    if angle < -math.pi / 2.0:
        return angle + math.pi, -size
    return angle, size


class AckermannDriveController(BaseController):
    """Joints `front_left_wheel`, `mid_left_wheel`, `front_left_steer` and so on."""

    def load_wheels(self) -> None:
        s = self.settings
        self._corners = [
            (self.claim_joint(VELOCITY, s.text(f"{name}_wheel", f"{name}_wheel_joint")),
             self.claim_joint(POSITION, s.text(f"{name}_steer", f"{name}_steer_joint")))
                         for name in _CORNERS]
        self.counted = [self.claim_joint(VELOCITY, s.text(f"{name}_wheel", f"{name}_wheel_joint"))
                        for name in _MIDDLE]
        self._radius = s.number("wheel_radius", 0.0)
        self._width = s.number("mid_wheel_lat_separation", 0.0)
        self.positive(wheel_radius=self._radius, mid_wheel_lat_separation=self._width)
        self._places: List[Tuple[float, float]] = []
        for end, sign in (("front", 1.0), ("back", -1.0)):
            x = sign * s.number(f"{end}_wheel_lon_separation", 0.0)
            half = s.number(f"{end}_wheel_lat_separation", 0.0) / 2.0
            self._places += [(x, half), (x, -half)]

    def drive(self, velocity: Planar) -> None:
        """Steer and drive the wheels about the centre of the turn."""
        speed, _, yaw_rate = velocity
        for (wheel, steer), (x, y) in zip(self._corners, self._places):
            angle, rim = compute_wheel_motion(x, y, speed, yaw_rate)
            steer.command(angle)
            wheel.command(rim / self._radius)
        for wheel, side in zip(self.counted, (0.5, -0.5)):
            wheel.command((speed - yaw_rate * side * self._width) / self._radius)

    def displacement(self, dt: float) -> Planar:
        """Return the motion of the base from the rotation of the middle wheels."""
        if self.open_loop:
            return self.last[0] * dt, 0.0, self.last[2] * dt
        left, right = (turn * self._radius for turn in self.count_rotations())
        return (left + right) / 2.0, 0.0, (right - left) / self._width
