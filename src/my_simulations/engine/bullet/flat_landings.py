"""How far a box or a cylinder must turn before it can land flat."""
from __future__ import annotations

from math import acos, asin
from typing import Tuple

from ...description.shapes import Box, Cylinder
from ...geometry import Quat, Vec3, conjugate, dot, multiply, rotate
from .bodies import Body
from .landing_points import MOST_TILT

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_AXES = {Box: (_X, _Y, _Z), Cylinder: (_Z,)}


def flat_axes(body: Body) -> Tuple[Vec3, ...]:
    """Return the normals of the flat faces of a rigid body, in its principal axes.

    Empty for a body that is not one box or one cylinder.
    """
    part = body.parts[0]
    if not body.rigid or len(part.link.collisions) != 1:
        return ()
    only = part.link.collisions[0]
    own = multiply(conjugate(part.link_from_com.orientation), only.pose.orientation)
    return tuple(rotate(own, axis) for axis in _AXES.get(type(only.geometry), ()))


def tilt_beyond_flat(axes: Tuple[Vec3, ...], turn: Quat, normal: Vec3) -> float:
    """Return the least turn, rad, with which a body lands on a face or its side; 0 if it does now.

    Args:
        axes: of `flat_axes`; a single one is that of a cylinder, which can land on its side, too.
        turn: of the principal axes.
        normal: of the surface.
    """
    if not axes:
        return 0.0
    own = rotate(conjugate(turn), normal)
    along = min(1.0, max([abs(dot(own, axis)) for axis in axes]))
    tilt = acos(along)
    return max(0.0, (tilt if len(axes) > 1 else min(tilt, asin(along))) - MOST_TILT)
