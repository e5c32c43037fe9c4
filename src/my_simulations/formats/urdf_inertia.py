"""An inertia for links whose file gives a mass and a tensor of zeros.

Care-O-bot's furniture is written so. No body has such a tensor; what the author left open is taken
from the shapes.
"""
from __future__ import annotations

import math
from typing import List, Optional, Tuple

from ..description.model import Inertial
from ..description.shapes import Box, Collision, Cylinder, Geometry, Sphere
from .urdf_lump import merged


def is_zero(inertial: Inertial) -> bool:
    """True for a body with a mass and nothing but zeros in its tensor."""
    i = inertial
    return i.mass > 0 and not any((i.ixx, i.iyy, i.izz, i.ixy, i.ixz, i.iyz))


def of_shapes(inertial: Inertial, collisions: List[Collision]) -> Optional[Inertial]:
    """The same mass and centre, with the tensor of the shapes at one density.

    Returns:
        None where there is no box, sphere or cylinder among the collisions.
    """
    solids = [(collision, solid) for collision in collisions
              for solid in [_solid(collision.geometry)] if solid is not None]
    volume = sum(solid[0] for _, solid in solids)
    if not volume > 0:
        return None
    total: Optional[Inertial] = None
    for collision, (own, (x, y, z)) in solids:
        mass = inertial.mass * own / volume
        part = Inertial(mass, ixx=mass * x, iyy=mass * y, izz=mass * z)
        total = merged(total, part, collision.pose)
    assert total is not None
    total.pose = inertial.pose._replace(orientation=total.pose.orientation)
    return total


def _solid(geometry: Geometry) -> Optional[Tuple[float, Tuple[float, float, float]]]:
    """(volume, principal moments of 1 kg) of a solid shape about its centre."""
    if isinstance(geometry, Box):
        x, y, z = geometry.size
        return x * y * z, ((y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12)
    if isinstance(geometry, Sphere):
        moment = 0.4 * geometry.radius ** 2
        return 4 / 3 * math.pi * geometry.radius ** 3, (moment, moment, moment)
    if isinstance(geometry, Cylinder):
        r, h = geometry.radius, geometry.length
        side = (3 * r * r + h * h) / 12
        return math.pi * r * r * h, (side, side, r * r / 2)
    return None
