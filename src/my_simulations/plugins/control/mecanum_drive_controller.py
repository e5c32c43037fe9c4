"""mecanum_drive_controller and PAL's omni_drive_controller: wheels with rollers at 45 degrees.

Joints, parameters, topics and laws of the first are those of the package of that name for ROS 1.
The odometry is on `odom`, and on `odomTopic` as in the original. Joints and parameters of the
second are those of omni_base_controller_configuration; its source is not public, and limits of
`space` have no effect.
"""
from __future__ import annotations

import math
from typing import List, Sequence, Tuple

from ...description.model import Joint
from ..context import PluginError, Publication
from .base_controller import BaseController, Planar
from .hardware import VELOCITY

_CORNERS = ("front_left", "back_left", "back_right", "front_right")
_UNEQUAL = 1e-3  # m, between radii


class MecanumDriveController(BaseController):
    """Joints `front_left_wheel_joint`, `back_left_wheel_joint` and those on the right."""

    smooths = False
    goes_sideways = True

    def load_wheels(self) -> None:
        s = self.settings
        self.counted = [self.claim_joint(VELOCITY, s.text(self.wheel_parameter(corner)))
                        for corner in _CORNERS]
        joints = [self.context.joint(wheel.name).spec for wheel in self.counted]
        if s.get("wheel_radius") is not None:
            self._radius = s.number("wheel_radius", 0.0)
        else:
            rollers = s.flag("use_realigned_roller_joints", False)
            radii = [self.radius_of(joint, rollers) for joint in joints]
            if max(radii) - min(radii) > _UNEQUAL:
                raise PluginError(f"{self.name}: the wheels' radii are not equal:"
                                  f" {', '.join(f'{one:g} m' for one in radii)}")
            self._radius = radii[0]
        self._radius *= s.number("wheel_radius_multiplier", 1.0)
        along, across = self._separations(joints)
        self._arm = (along * s.number("axis_separation_multiplier", 1.0)
                     + across * s.number("wheel_separation_multiplier", 1.0)) / 2.0
        self.positive(wheel_radius=self._radius, wheel_separation=self._arm)
        self._offset = tuple(s.number(f"base_frame_offset/{axis}", 0.0)
                             for axis in ("x", "y", "theta"))
        self._more = self.publish("odomTopic", "nav_msgs/Odometry", 100)

    def wheel_parameter(self, corner: str) -> str:
        """Return the name of the parameter that names the joint of a wheel."""
        return f"{corner}_wheel_joint"

    def _separations(self, joints: Sequence[Joint]) -> Tuple[float, float]:
        """Of the axles, and of the wheels of an axle, m."""
        s = self.settings
        if s.get("wheel_separation_x") is not None or s.get("wheel_separation_y") is not None:
            return s.number("wheel_separation_x", 0.0), s.number("wheel_separation_y", 0.0)
        places = [self.joint_location(joint) for joint in joints]
        xs, ys = ([place[axis] for place in places] for axis in (0, 1))
        return (xs[0] - xs[1] - xs[2] + xs[3]) / 2.0, (ys[0] + ys[1] - ys[2] - ys[3]) / 2.0

    def drive(self, velocity: Planar) -> None:
        """Drive each wheel by the velocity along its diagonal; its rollers turn freely."""
        x, y, yaw = velocity
        ox, oy, turn = self._offset
        c, s = math.cos(turn), math.sin(turn)
        x, y = c * x - s * y + oy * yaw, s * x + c * y - ox * yaw
        for wheel, side, way in zip(self.counted, (-1.0, -1.0, 1.0, 1.0), (-1.0, 1.0, -1.0, 1.0)):
            wheel.command((x + way * y + side * self._arm * yaw) / self._radius)

    def displacement(self, dt: float) -> Planar:
        """Return the motion of the base from the rotation of four wheels, by least squares."""
        a, b, c, d = (turn * self._radius / 4.0 for turn in self.count_rotations())
        x, y, yaw = a + b + c + d, -a + b - c + d, (-a - b + c + d) / self._arm
        ox, oy, turn = self._offset
        x, y = x - oy * yaw, y + ox * yaw
        cosine, sine = math.cos(turn), math.sin(turn)
        return cosine * x + sine * y, -sine * x + cosine * y, yaw

    def more_topics(self) -> List[Publication]:
        return [self._more]

    def publish_more(self) -> None:
        """Publish the odometry on its second topic."""
        if self._more.wanted:
            self._more.publish(self._odometry())


class OmniDriveController(MecanumDriveController):
    """Joints `left_front_wheel`, `left_back_wheel` and those on the right."""

    def wheel_parameter(self, corner: str) -> str:
        """Return the name of the parameter that names the joint of a wheel."""
        end, side = corner.split("_")
        return f"{side}_{end}_wheel"
