"""libInitialVelocityPlugin.so: a model that begins with a velocity.

Parameters are those of Gazebo: `<linear>` m/s and `<angular>` rad/s, world axes.
"""
from __future__ import annotations

from ...geometry import Twist
from ..base import Plugin


class InitialVelocity(Plugin):
    """Sets the velocity of all links when the model comes, and after a reset."""

    def load(self) -> None:
        p = self.context.parameters
        self._twist = Twist(p.vector("linear"), p.vector("angular"))
        self.reset()

    def reset(self) -> None:
        self.context.move(self.context.pose, self._twist)
