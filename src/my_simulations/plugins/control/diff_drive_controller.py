"""diff_drive_controller: wheels on two sides, odometry of their turning."""
from __future__ import annotations

from typing import List, Tuple

from ...geometry import norm, subtract
from ..context import PluginError
from .base_controller import BaseController, Planar
from .hardware import VELOCITY, HardwareJoint


class DiffDriveController(BaseController):
    """Wheels `left_wheel` and `right_wheel`: a joint each, or several."""

    def load_wheels(self) -> None:
        """Two sides with as many wheels."""
        s = self.settings
        names = [s.texts("left_wheel"), s.texts("right_wheel")]
        if len(names[0]) != len(names[1]):
            raise PluginError(f"{self.name} has {len(names[0])} left and {len(names[1])} right"
                              " wheels")
        self._sides = [[self.take(VELOCITY, name) for name in side] for side in names]
        self._read_geometry(names[0][0], names[1][0])

    def _read_geometry(self, left: str, right: str) -> None:
        s = self.settings
        separation, radius = s.number("wheel_separation", 0.0), s.number("wheel_radius", 0.0)
        joints = [self.context.joint(name).spec for name in (left, right)]
        if s.get("wheel_separation") is None:
            separation = norm(subtract(self.place(joints[0]), self.place(joints[1])))
        if s.get("wheel_radius") is None:
            radius = self.radius_of(joints[0])
        both = s.number("wheel_radius_multiplier", 0.0)
        self._separation = separation * s.number("wheel_separation_multiplier", 1.0)
        self._radii = tuple(radius * (both if s.get("wheel_radius_multiplier") is not None else
                                      s.number(f"{side}_wheel_radius_multiplier", 1.0))
                            for side in ("left", "right"))
        self.positive(wheel_separation=self._separation, wheel_radius=min(self._radii))

    def drive(self, velocity: Planar) -> None:
        """Drive each wheel so that it rolls without slip."""
        x, _, yaw = velocity
        for side, radius, sign in zip(self._sides, self._radii, (-1.0, 1.0)):
            for wheel in side:
                wheel.command((x + sign * yaw * self._separation / 2.0) / radius)

    def begin_count(self) -> None:
        """Store the present joint positions as the start of the odometry."""
        self._turned = self._wheel_ways()

    def _wheel_ways(self) -> Tuple[float, float]:
        left, right = (radius * _mean(side) for side, radius in zip(self._sides, self._radii))
        return left, right

    def way(self, dt: float) -> Planar:
        """Return the motion of the base from the rotation of the wheels."""
        if self.open_loop:
            return self.last[0] * dt, 0.0, self.last[2] * dt
        before, self._turned = self._turned, self._wheel_ways()
        left, right = (a - b for a, b in zip(self._turned, before))
        return (left + right) / 2.0, 0.0, (right - left) / self._separation


def _mean(wheels: List[HardwareJoint]) -> float:
    return sum(wheel.position for wheel in wheels) / len(wheels)
