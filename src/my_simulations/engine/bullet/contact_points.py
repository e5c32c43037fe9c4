"""Names for the fields of the tuples that PyBullet returns for contact points and closest points.

`contact[LOAD]` is read faster than an attribute: some helpers read all contacts of a body in each
step. Positions, normals and directions are in world axes.
"""
from __future__ import annotations

from typing import Any, Tuple

from ...geometry import Vec3, add, scale

ContactPoint = Tuple[Any, ...]
"""As `pybullet.getContactPoints` and `pybullet.getClosestPoints` return it."""

LinkKey = Tuple[int, int]
"""PyBullet's numbers of a body and of one of its links."""

BODY, OTHER_BODY, LINK, OTHER_LINK = 1, 2, 3, 4
"""PyBullet's numbers; in a query for one body, `BODY` is that body."""
POINT, OTHER_POINT = 5, 6
"""The points on the surfaces of the two bodies, m."""
NORMAL = 7
"""From the other body to the body, of length 1."""
DISTANCE = 8
"""Between the surfaces, m; below 0 for an overlap. Bullet solves only overlaps."""
LOAD = 9
"""Normal force in the last step in which the surfaces overlapped, N."""
FRICTION, DIRECTION, FRICTION_2, DIRECTION_2 = 10, 11, 12, 13
"""Friction in two directions, N, and these directions."""


def friction_force(contact: ContactPoint) -> Vec3:
    """Return the friction on the body, N."""
    return add(scale(contact[DIRECTION], contact[FRICTION]),
               scale(contact[DIRECTION_2], contact[FRICTION_2]))
