"""SDF's velocity_decay of links of articulated bodies.

Gazebo's ODE takes the share off a link's velocities in every step, and the joints then have their
say. Here the force and torque that would take it off a free link act on each of them.
"""
from __future__ import annotations

from typing import Dict, Tuple

import pybullet

from ...description.model import Link
from ...geometry import Vec3, conjugate, rotate, scale
from .bodies import Body, Part
from .link_states import motion
from .step_helper import FAR


class VelocityDecay:
    """Slows links down in every step."""

    def __init__(self) -> None:
        self._links: Dict[int, Tuple[Body, Part, float, float]] = {}

    def add(self, body: Body, part: Part, link: Link) -> None:
        """Know a link of a body; rigid bodies have Bullet's own damping."""
        shares = min(1.0, link.linear_decay), min(1.0, link.angular_decay)
        if not body.rigid and body.moves and any(shares):
            self._links[part.row] = (body, part, *shares)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        for part in body.parts:
            self._links.pop(part.row, None)

    def clear(self) -> None:
        """All bodies are gone."""
        self._links.clear()

    def due(self, step: int) -> int:
        """Each step, when a link is slowed down."""
        return step if self._links else FAR

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Do nothing after a step."""

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Act in the next step, of `dt` s."""
        for body, part, linear_share, angular_share in self._links.values():
            at, turn, linear, angular = motion(body.uid, part.index)
            if linear_share:
                pybullet.applyExternalForce(
                    body.uid, part.index, scale(linear, -linear_share * part.mass / dt), at,
                    pybullet.WORLD_FRAME)
            if angular_share:
                own = rotate(conjugate(turn), angular)
                torque = tuple(i * w for i, w in zip(part.moments, own))
                pybullet.applyExternalTorque(
                    body.uid, part.index,
                    scale(rotate(turn, (torque[0], torque[1], torque[2])), -angular_share / dt),
                    pybullet.WORLD_FRAME)
