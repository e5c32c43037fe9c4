"""libgazebo_ros_hand_of_god.so: a critically damped spring pulls a link to a tf frame.

Parameters, defaults, frames and law (`PoseSpring`) are those of gazebo_plugins: the link goes to
the frame `FRAME_desired` in `world`, and `FRAME_actual` is its pose. Gravity does not act on it.
"""
from __future__ import annotations

import math
from typing import Optional

from ...engine.wrench_laws import PoseSpring
from ...geometry import ZERO3, Pose, scale
from ..base import Plugin
from ..call_slot import CallSlot
from ..transforms import Transforms


class HandOfGod(Plugin):
    """Pulls the link `<linkName>`; only changes of the wanted pose cost a synchronization."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(self.required_text("linkName"))
        self._frame = p.text("frameId", "hog")
        self._stiffness = (max(0.0, p.number("kl", 200.0)), max(0.0, p.number("ka", 200.0)))
        inertial = self._link.inertial
        self._damping = (2.0 * math.sqrt(self._stiffness[0] * inertial.mass),
                         2.0 * math.sqrt(self._stiffness[1] * inertial.ixx))
        self._wanted: Optional[Pose] = None
        self._publishing = CallSlot()
        self._transforms = Transforms(context, self._follow)
        self.update()
        context.on_world_change(self.update)
        context.once(context.now_ns, self._report_missing)

    def reset(self) -> None:
        """The pull ended with the reset."""
        self.update()

    def update(self) -> None:
        """Pull towards the wanted pose, against the present gravity."""
        lift = scale(self.context.gravity, -self._link.inertial.mass)
        if self._wanted is None:
            self.context.set_wrench(self._link.name, lift, ZERO3)
        else:
            self.context.set_wrench_law(self._link.name, PoseSpring(
                self._wanted, self._stiffness, self._damping, lift))

    def _follow(self) -> None:
        """Look up the wanted pose after tf has changed."""
        wanted = self._transforms.look_up("world", f"{self._frame}_desired")
        if wanted == self._wanted:
            return
        self._wanted = wanted
        self.update()
        if not self._publishing.is_active:
            self._publishing.set(self.context.observe(0.0, self._publish, transforms=True))

    def _publish(self) -> None:
        if self._wanted is not None:
            self.context.transform("world", f"{self._frame}_actual", self._link.pose)

    def _report_missing(self) -> None:
        if self._wanted is None:
            self.context.warn(f"there is no tf frame {self._frame}_desired in world yet")
