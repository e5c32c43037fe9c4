"""Compute extents and motions of bodies that approach others."""
from __future__ import annotations

from math import dist
from typing import AbstractSet, Dict, Sequence, Tuple

import pybullet

from ...geometry import Vec3, add, dot, norm
from ..body_plan import BASE
from .bodies import Body
from .link_states import AT_REST, Motion, motion

_SAME = 1e-9  # m/s, or share: rounding errors of a velocity


class Motions:
    """The motions of bodies between two steps, each read once.

    Args:
        moving: PyBullet's numbers of the bodies that move; all others are at rest.
    """

    def __init__(self, moving: AbstractSet[int]) -> None:
        self._moving = moving
        self._read: Dict[int, Motion] = {}

    def clear(self) -> None:
        """Read all motions again, as after a step."""
        self._read.clear()

    def forget(self, uid: int) -> None:
        """Read the motion of one body again, after it was set."""
        self._read.pop(uid, None)

    def of(self, uid: int) -> Motion:
        """Return the motion of the base of a body; `AT_REST` for a static one."""
        found = self._read.get(uid)
        if found is None:
            found = self._read[uid] = motion(uid, BASE) if uid in self._moving else AT_REST
        return found


def extent(body: Body) -> Tuple[Vec3, Vec3]:
    """Return the lowest and highest corner of the axis-aligned bounding box of a body."""
    return hull([pybullet.getAABB(body.uid, part.index) for part in body.colliders])


def hull(boxes: Sequence[Tuple[Vec3, Vec3]]) -> Tuple[Vec3, Vec3]:
    """Return the lowest and highest corner of the box around axis-aligned boxes."""
    if len(boxes) == 1:
        low, high = boxes[0]
        return low, high
    lows, highs = zip(*boxes)
    x, y, z = map(min, zip(*lows))
    u, v, w = map(max, zip(*highs))
    return (x, y, z), (u, v, w)


def flies(body: Body, before: Vec3, now: Vec3, pull: Vec3) -> bool:
    """Whether only gravity has changed the velocity of a rigid body, from `before` to `now`, m/s.

    `pull`: velocity that gravity adds in this time, m/s.
    """
    alone = add(before, pull) if body.parts[0].link.gravity else before
    return dist(now, alone) <= _SAME * (1.0 + norm(alone))


def tumbles(angular: Vec3, gravity: Vec3, least: float) -> bool:
    """Whether a body turns over at `least` rad/s; rotation about the vertical does not count."""
    pull = norm(gravity)
    about = dot(angular, gravity) / pull if pull > 0.0 else 0.0
    return dot(angular, angular) - about * about > least * least
