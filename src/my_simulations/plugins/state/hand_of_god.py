"""libgazebo_ros_hand_of_god.so: a critically damped spring pulls a link to a tf frame.

Parameters, defaults, frames and law are those of gazebo_plugins: the link goes to the frame
`FRAME_desired` in `world`, and `FRAME_actual` is its pose. Gravity does not act on it.
"""
from __future__ import annotations

import math

from ...geometry import (
    Pose,
    Quat,
    Vec3,
    add,
    conjugate,
    multiply,
    normalised,
    rotate,
    scale,
    subtract,
)
from ..base import Plugin
from ..context import PluginError
from ..parameters import namespace_or
from ..transforms import Transforms


class HandOfGod(Plugin):
    """Pulls the link `<linkName>`."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        context.use_namespace(namespace_or(p, ""))
        name = p.text("linkName")
        if not name:
            raise PluginError("it has no <linkName>")
        self._link = context.link(name)
        self._frame = p.text("frameId", "hog")
        self._stiffness = (max(0.0, p.number("kl", 200.0)), max(0.0, p.number("ka", 200.0)))
        inertial = self._link.inertial
        self._damping = (2.0 * math.sqrt(self._stiffness[0] * inertial.mass),
                         2.0 * math.sqrt(self._stiffness[1] * inertial.ixx))
        self._transforms = Transforms(context)
        self._told = False
        context.every(0.0, self.update)

    def update(self) -> None:
        lift = scale(self.context.gravity, -self._link.inertial.mass)
        wanted = self._transforms.look_up("world", f"{self._frame}_desired")
        if wanted is None:
            if not self._told:
                self._told = True
                self.context.warn(f"there is no tf frame {self._frame}_desired in world yet")
            self.context.set_wrench(self._link.name, lift, (0.0, 0.0, 0.0))
            return
        pose, twist = self._link.pose, self._link.twist
        (kl, ka), (cl, ca) = self._stiffness, self._damping
        force = subtract(scale(subtract(wanted.position, pose.position), kl),
                         scale(twist.linear, cl))
        back = multiply(conjugate(pose.orientation), wanted.orientation)
        torque = subtract(scale(logarithm(back), ka),
                          scale(rotate(conjugate(pose.orientation), twist.angular), ca))
        self.context.set_wrench(self._link.name, add(force, lift), rotate(pose.orientation, torque))
        self.context.transform("world", f"{self._frame}_actual",
                               Pose(pose.position, pose.orientation))


def logarithm(turn: Quat) -> Vec3:
    """Half the rotation vector (rad), the short way; what ignition's Quaternion::Log gives."""
    x, y, z, w = normalised(turn)
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    size = math.sqrt(x * x + y * y + z * z)
    share = math.atan2(size, w) / size if size > 1e-12 else 1.0
    return (x * share, y * share, z * share)
