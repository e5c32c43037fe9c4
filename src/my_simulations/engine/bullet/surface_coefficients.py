"""What PyBullet stores for a surface so that pairs come out as Gazebo's.

PyBullet multiplies the coefficients of the two surfaces; Gazebo takes the smaller one. As stored
here, pairs of moving surfaces with mu 1 (the default) and static ones are exact; `friction` mends
the others.
"""
from __future__ import annotations

import math

from ...description.model import Link
from ...description.shapes import Box, Collision, Cylinder, Sphere, Surface
from ...geometry import conjugate, rotate

NEVER_BOUNCES = 1e4
"""A bounce threshold from here on (SDF's default is 100000 m/s) means no restitution."""


def of_link(link: Link) -> Surface:
    """The surface of a link: PyBullet knows one a link.

    The first collision's is taken; where others have another friction, that of the collision which
    reaches lowest: a robot's base stands on its caster, whatever else was lumped into it.
    """
    if not link.collisions:
        return Surface()
    first = link.collisions[0]
    if all(coefficient(one.surface) == coefficient(first.surface) for one in link.collisions):
        return first.surface
    return min(link.collisions, key=_lowest).surface


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


def coefficient(surface: Surface) -> float:
    """The coefficient that counts in pairs: the larger one where both have a direction."""
    return max(surface.mu, surface.mu2) if directed(surface) else surface.mu


def friction(surface: Surface, static: bool) -> float:
    """The lateral friction to store."""
    return min(coefficient(surface), 1.0) if static else coefficient(surface)


def restitution(surface: Surface) -> float:
    """The restitution to store: 0 unless the surface can reach its threshold."""
    return surface.restitution if surface.bounce_threshold < NEVER_BOUNCES else 0.0


def directed(surface: Surface) -> bool:
    """Whether mu and mu2 differ by direction; without fdir1 mu holds in all of them."""
    return surface.mu != surface.mu2 and any(surface.fdir1)
