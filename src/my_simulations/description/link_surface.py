"""Which of a link's surfaces counts, where only one can.

Gazebo keeps a surface for each collision; PyBullet has one friction for each link.
"""
from __future__ import annotations

import math
from typing import Optional

from ..geometry import conjugate, rotate
from .model import Link
from .shapes import Box, Collision, Cylinder, Sphere, Surface


def counting_collision(link: Link) -> Optional[Collision]:
    """The collision whose friction and restitution hold for the whole link; None without any.

    The first one; where others have another friction, the one that reaches lowest: a robot's base
    stands on its caster, whatever else was lumped into it.
    """
    if not link.collisions:
        return None
    first = link.collisions[0]
    if all(coefficient(one.surface) == coefficient(first.surface) for one in link.collisions):
        return first
    return min(link.collisions, key=_lowest)


def coefficient(surface: Surface) -> float:
    """The coefficient that counts in pairs: the larger one where both have a direction."""
    return max(surface.mu, surface.mu2) if directed(surface) else surface.mu


def directed(surface: Surface) -> bool:
    """Whether mu and mu2 differ by direction; without fdir1 mu holds in all of them."""
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
