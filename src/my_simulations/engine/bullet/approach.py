"""Compute extents and approach speeds of bodies."""
from __future__ import annotations

from math import dist
from typing import Optional, Tuple

import pybullet

from ...geometry import Vec3, add, cross, dot, norm, subtract
from .bodies import Body

_SAME = 1e-9  # m/s, or share: rounding errors of a velocity


def extent(body: Body) -> Tuple[Vec3, Vec3]:
    """Return the lowest and highest corner of the axis-aligned bounding box of a body."""
    boxes = [pybullet.getAABB(body.uid, part.index) for part in body.colliders]
    low = (min(box[0][0] for box in boxes), min(box[0][1] for box in boxes),
           min(box[0][2] for box in boxes))
    high = (max(box[1][0] for box in boxes), max(box[1][1] for box in boxes),
            max(box[1][2] for box in boxes))
    return low, high


def approach(uid: int, other: Optional[int], place: Vec3, normal: Vec3) -> float:
    """Return the approach speed of two bodies at a point, m/s; `other` None: a static one."""
    speed = -dot(_velocity_at(uid, place), normal)
    return speed if other is None else speed + dot(_velocity_at(other, place), normal)


def _velocity_at(uid: int, place: Vec3) -> Vec3:
    """Return the velocity of a point of a body, m/s, without joint rates."""
    linear, angular = pybullet.getBaseVelocity(uid)
    lever = subtract(place, pybullet.getBasePositionAndOrientation(uid)[0])
    return add(linear, cross(angular, lever))


def speed_of(uid: int) -> float:
    """Return the linear speed of the base of a body, m/s."""
    linear: Vec3 = pybullet.getBaseVelocity(uid)[0]
    return norm(linear)


def flies(body: Body, before: Vec3, now: Vec3, pull: Vec3) -> bool:
    """Whether only gravity has changed the velocity of a rigid body, from `before` to `now`, m/s.

    `pull`: velocity that gravity adds in this time, m/s.
    """
    alone = add(before, pull) if body.parts[0].gravity else before
    return dist(now, alone) <= _SAME * (1.0 + norm(alone))
