"""How fast, and from where, one body comes nearer to another."""
from __future__ import annotations

from math import dist
from typing import Optional, Tuple

import pybullet

from ...geometry import Vec3, add, cross, dot, norm, subtract
from .bodies import Body

_SAME = 1e-9  # m/s, or share: as rounding changes a velocity


def extent(body: Body) -> Tuple[Vec3, Vec3]:
    """The lowest and highest corner of a box along the world's axes about a body."""
    boxes = [pybullet.getAABB(body.uid, part.index) for part in body.colliders]
    low = (min(box[0][0] for box in boxes), min(box[0][1] for box in boxes),
           min(box[0][2] for box in boxes))
    high = (max(box[1][0] for box in boxes), max(box[1][1] for box in boxes),
            max(box[1][2] for box in boxes))
    return low, high


def approach(uid: int, other: Optional[int], place: Vec3, normal: Vec3) -> float:
    """How fast a body comes nearer to another at a place, m/s; None: what does not move."""
    speed = -dot(_velocity_at(uid, place), normal)
    return speed if other is None else speed + dot(_velocity_at(other, place), normal)


def _velocity_at(uid: int, place: Vec3) -> Vec3:
    """Of a point of a body, as if joints stood still."""
    linear, angular = pybullet.getBaseVelocity(uid)
    lever = subtract(place, pybullet.getBasePositionAndOrientation(uid)[0])
    return add(linear, cross(angular, lever))


def speed_of(uid: int) -> float:
    """Of the base of a body, m/s."""
    linear: Vec3 = pybullet.getBaseVelocity(uid)[0]
    return norm(linear)


def flies(body: Body, before: Vec3, now: Vec3, pull: Vec3) -> bool:
    """Whether a rigid body met nothing: nothing but gravity has changed its velocity, m/s.

    `pull`: what gravity gives in this time, m/s.
    """
    alone = add(before, pull) if body.parts[0].gravity else before
    return dist(now, alone) <= _SAME * (1.0 + norm(alone))
