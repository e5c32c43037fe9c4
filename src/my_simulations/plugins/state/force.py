"""libgazebo_ros_force.so: a wrench on a link, from a topic."""
from __future__ import annotations

from typing import Any

from ...geometry import ZERO3, Vec3
from ..base import Plugin
from ..finite_messages import subscribe_finite


class Force(Plugin):
    """The last geometry_msgs/Wrench acts in every step, world axes, at the centre of mass."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        topic = self.required_text("topicName")
        self._body = context.link(p.text("bodyName")).name
        self._force: Vec3 = ZERO3
        self._torque: Vec3 = ZERO3
        subscribe_finite(context, topic, "geometry_msgs/Wrench", self._receive)

    def reset(self) -> None:
        """Keep the wrench after a reset, as in Gazebo."""
        self._act()

    def _receive(self, message: Any) -> None:
        force, torque = message.force, message.torque
        self._force = (force.x, force.y, force.z)
        self._torque = (torque.x, torque.y, torque.z)
        self._act()

    def _act(self) -> None:
        self.context.set_wrench(self._body, self._force, self._torque)
