"""libGravityCompensationPlugin.so, and the gravity compensation of other hardware.

Gazebo's plugin, and franka_gazebo's FrankaHWSim, add to the effort of each joint the effort that
carries the links. Where a joint connects them to the world, they then move as without weight: so
each link gets a force at its centre of mass that is the opposite of its weight.
"""
from __future__ import annotations

from ...description.model import WORLD, Model
from ...geometry import scale
from ..base import Plugin
from ..context import Context


class GravityCompensation:
    """Carries the links of a model from now on. For models on a joint to the world.

    Args:
        context: of a plugin of the model. Another model than such a one gets a warning only.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        links = context.description.links if _is_fixed(context.description) else []
        self._masses = {link.name: link.inertial.mass for link in links
                        if link.inertial is not None and link.gravity}
        if not links:
            context.warn("gravity is not compensated: no joint connects the model to the world")
        self.apply()
        if links:
            context.on_world_change(self.apply)

    def apply(self) -> None:
        """Apply the forces against the present gravity, also after a reset."""
        for name, mass in self._masses.items():
            self._context.set_wrench(name, scale(self._context.gravity, -mass), (0.0, 0.0, 0.0))


class GravityCompensationPlugin(Plugin):
    """Carries the links of its model. Gazebo's joint commands and their gains have no effect."""

    def load(self) -> None:
        self._compensation = GravityCompensation(self.context)

    def reset(self) -> None:
        """Forces ended with the reset."""
        self._compensation.apply()


def _is_fixed(model: Model) -> bool:
    return any(WORLD in (joint.parent, joint.child) for joint in model.joints)
