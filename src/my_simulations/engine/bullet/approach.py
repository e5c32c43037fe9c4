"""Compute extents and approach speeds of bodies."""
from __future__ import annotations

from math import dist
from typing import Optional, Tuple

import pybullet

from ...geometry import Vec3, add, dot, norm
from ..body_plan import BASE
from .bodies import Body
from .link_states import motion

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
    speed = -dot(motion(uid, BASE).velocity_at(place), normal)
    return speed if other is None else speed + dot(motion(other, BASE).velocity_at(place), normal)


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
