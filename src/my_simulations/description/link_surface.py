"""Which of a link's surfaces counts, where only one can.

Gazebo keeps a surface for each collision; PyBullet has one friction for each link.
"""
from __future__ import annotations

import math
from typing import Optional

from ..geometry import conjugate, rotate
from .model import Link
from .shapes import Box, Collision, Cylinder, Sphere, Surface


def dominant_collision(link: Link) -> Optional[Collision]:
    """Return the collision whose friction and restitution apply to the whole link; None without
    any.

    The first one; where others have another friction, the one that reaches lowest: a robot's base
    stands on its caster, whatever else was lumped into it.
    """
    if not link.collisions:
        return None
    first = link.collisions[0]
    if all(friction_coefficient(one.surface) == friction_coefficient(first.surface)
           for one in link.collisions):
        return first
    return min(link.collisions, key=_lowest)


def friction_coefficient(surface: Surface) -> float:
    """Return the coefficient for contact pairs: the larger one of direction-dependent friction."""
    return max(surface.mu, surface.mu2) if is_direction_dependent(surface) else surface.mu


def is_direction_dependent(surface: Surface) -> bool:
    """Return whether mu and mu2 differ; without fdir1, mu applies in all directions."""
    return surface.mu != surface.mu2 and any(surface.fdir1)


def _lowest(collision: Collision) -> float:
    """How far up a shape begins, about, m in the link's frame."""
    shape, (position, turn) = collision.geometry, collision.pose
    up = rotate(conjugate(turn), (0.0, 0.0, 1.0))
    if isinstance(shape, Sphere):
        reach = shape.radius
    elif isinstance(shape, Box):
        reach = sum(abs(u) * size / 2.0 for u, size in zip(up, shape.size))
    elif isinstance(shape, Cylinder):
        reach = (abs(up[2]) * shape.length / 2.0
                 + math.sqrt(max(0.0, 1.0 - up[2] * up[2])) * shape.radius)
    else:
        reach = 0.0
    return position[2] - reach
