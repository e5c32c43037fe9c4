"""Mass and inertia of links from their collision shapes, which count as solid."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import List, Optional, Union

from ...description.model import Inertial
from ...description.shapes import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Mesh,
    Polyline,
    Sphere,
)
from ...errors import CommandError
from ...formats.combined_inertia import combined_inertia
from ...formats.mesh.loading import load_mesh, load_solid
from ...geometry import Pose

WATER = 1000.0
"""kg/m^3."""


def inertial_of(collisions: List[Collision], *, density: Optional[float] = None,
                mass: Optional[float] = None) -> Inertial:
    """The inertial of a link with these shapes of one density; overlaps count twice.

    Args:
        collisions: the shapes; planes and terrains have no volume and do not count.
        density: kg/m^3; None for that which gives `mass`.
        mass: kg.

    Raises:
        CommandError: no shape has a volume, or the density is out of range.
        InputError: a mesh cannot be read.
    """
    solids = [(_solid(one.geometry), one.pose) for one in collisions]
    volume = sum(solid.mass for solid, _ in solids if solid is not None)
    if not volume > 0.0:
        raise CommandError("the link has no collision with a volume to compute the inertia from")
    if density is None:
        density = (1.0 if mass is None else mass) / volume
    if not 0.0 < density < 1e6:
        raise CommandError(f"the density must be between 0 and 1e6 kg/m^3, is {density:g}")
    total: Optional[Inertial] = None
    for solid, pose in solids:
        if solid is not None:
            total = combined_inertia(total, _times(solid, density), pose)
    assert total is not None
    return total


def _times(i: Inertial, factor: float) -> Inertial:
    return replace(i, mass=i.mass * factor, ixx=i.ixx * factor, iyy=i.iyy * factor,
                   izz=i.izz * factor, ixy=i.ixy * factor, ixz=i.ixz * factor,
                   iyz=i.iyz * factor)


def _solid(geometry: Geometry) -> Optional[Inertial]:
    """Of density 1 kg/m^3, in the frame of the shape; None for what has no volume."""
    if isinstance(geometry, Box):
        x, y, z = geometry.size
        return _diagonal(x * y * z, (y * y + z * z) / 12, (x * x + z * z) / 12,
                         (x * x + y * y) / 12)
    if isinstance(geometry, (Sphere, Ellipsoid)):
        a, b, c = ((geometry.radius,) * 3 if isinstance(geometry, Sphere) else geometry.radii)
        return _diagonal(4 / 3 * math.pi * a * b * c, (b * b + c * c) / 5, (a * a + c * c) / 5,
                         (a * a + b * b) / 5)
    if isinstance(geometry, Cylinder):
        r, h = geometry.radius, geometry.length
        side = (3 * r * r + h * h) / 12
        return _diagonal(math.pi * r * r * h, side, side, r * r / 2)
    if isinstance(geometry, Capsule):
        return _capsule(geometry.radius, geometry.length)
    if isinstance(geometry, Cone):
        return _cone(geometry.radius, geometry.length)
    if isinstance(geometry, (Mesh, Polyline)):
        return _mesh(geometry)
    return None


def _diagonal(volume: float, x: float, y: float, z: float) -> Inertial:
    """Of moments of 1 kg."""
    return Inertial(volume, ixx=volume * x, iyy=volume * y, izz=volume * z)


def _capsule(r: float, h: float) -> Inertial:
    """A cylinder of length h between two half balls, whose centre of mass is 3/8 r off their
    plane (parallel axis theorem).
    """
    tube, balls = math.pi * r * r * h, 4 / 3 * math.pi * r ** 3
    side = tube * (3 * r * r + h * h) / 12 + balls * (
        2 / 5 * r * r + h * h / 4 + 3 / 8 * h * r)
    return Inertial(tube + balls, ixx=side, iyy=side,
                    izz=tube * r * r / 2 + balls * 2 / 5 * r * r)


def _cone(r: float, h: float) -> Inertial:
    """Point up, its frame half-way up; the centre of mass is a quarter of the height above its
    base.
    """
    volume = math.pi * r * r * h / 3
    side = volume * (3 / 20 * r * r + 3 / 80 * h * h)
    return Inertial(volume, Pose((0.0, 0.0, -h / 4)), ixx=side, iyy=side,
                    izz=volume * 3 / 10 * r * r)


def _mesh(geometry: Union[Mesh, Polyline]) -> Inertial:
    """Of the solid; of its convex hull where the surface is not closed."""
    import trimesh

    data = load_mesh(geometry) if isinstance(geometry, Mesh) else load_solid(geometry)
    solid = trimesh.Trimesh(data.vertices, data.triangles, process=True)
    if not solid.is_watertight or solid.volume <= 0.0:
        solid = solid.convex_hull
    x, y, z = (float(part) for part in solid.center_mass)
    moments = solid.moment_inertia
    return Inertial(float(solid.volume), Pose((x, y, z)),
                    ixx=float(moments[0][0]), iyy=float(moments[1][1]), izz=float(moments[2][2]),
                    ixy=float(moments[0][1]), ixz=float(moments[0][2]), iyz=float(moments[1][2]))
