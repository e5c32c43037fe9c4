"""Collision shapes for bodies without collisions."""
from __future__ import annotations

from typing import List

import pybullet

from ...geometry import Vec3

_COUNT = 1024
"""Different shapes; bodies share them in turn."""

_HALF_EXTENT = -1000.0
_SPREAD = 100.0
_STEPS = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
"""Steps of the additive recurrence R3, which fills a cube evenly (M. Roberts, 2018)."""


class EmptyShapes:
    """Makes shapes that touch nothing, for any number of bodies at one place.

    Bullet sorts the bounding boxes of all bodies into a tree by the distance of their centers
    (btDbvt). Boxes with one center form a list instead: a step took time proportional to the
    square of their number, 1.2 s for 4000 bodies without a shape, and 7 ms with these (measured).
    So the centers of these boxes are scattered in a cube of 100 m around the body. Their half
    extents are negative: each lower bound is 2 km above the upper one, and they overlap nothing.
    """

    def __init__(self) -> None:
        self._shapes: List[int] = []
        self._next = 0

    def take(self) -> int:
        """Return the PyBullet number of a shape; each of the next 1024 calls returns another."""
        number = self._next
        self._next = (number + 1) % _COUNT
        if number == len(self._shapes):
            self._shapes.append(pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=(_HALF_EXTENT,) * 3,
                collisionFramePosition=_offset(number)))
        return self._shapes[number]

    def forget(self) -> None:
        """Discard the shapes after a reset of the simulation."""
        self._shapes.clear()
        self._next = 0


def _offset(number: int) -> Vec3:
    x, y, z = (_SPREAD * (number * step % 1.0 - 0.5) for step in _STEPS)
    return x, y, z
