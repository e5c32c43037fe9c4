"""Apply the weight of rigid bodies that are tied to other models as a velocity.

Bullet's constraints between a rigid body and an articulated one compare the velocities of both, but
omit what forces will add to that of the rigid body in the step. The constraint then yields until
its position correction balances the force: by 5 a dt^2 for an acceleration a, which is 1.2 mm for
the weight at steps of 5 ms. Fingers that press the body hold it against this.
"""
from __future__ import annotations

from typing import Callable, List

import pybullet

from ...geometry import Vec3, add, scale
from ..body_plan import BASE
from .bodies import Body
from .link_states import read_com_pose
from .step_helper import FAR, StepHelper


class CarriedWeight(StepHelper):
    """Acts on all rigid bodies that joints tie to other models or to the world.

    Args:
        carried: returns these bodies.
    """

    def __init__(self, carried: Callable[[], List[Body]]) -> None:
        self._carried = carried

    def due(self, step: int) -> int:
        """Each step, when a body is tied."""
        return step if self._carried() else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Add the velocity of the weight in a step of `dt` s, and a force against the weight."""
        for body in self._carried():
            part = body.parts[0]
            if part.link.gravity:
                add_velocity(body, scale(gravity, dt))
                pybullet.applyExternalForce(body.uid, BASE, scale(gravity, -part.mass),
                                            read_com_pose(body.uid, BASE)[0], pybullet.WORLD_FRAME)


def add_velocity(body: Body, change: Vec3) -> None:
    """Add to the velocity of a rigid body, m/s."""
    linear, angular = pybullet.getBaseVelocity(body.uid)
    pybullet.resetBaseVelocity(body.uid, add(linear, change), angular)
