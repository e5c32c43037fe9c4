"""Mass and inertia of links from their collision shapes, which count as solid."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import List, Optional, Tuple

from ...description.model import Inertial
from ...description.shapes import (
    Capsule,
    Collision,
    Cone,
    Ellipsoid,
    Geometry,
    Mesh,
    MeshData,
    Polyline,
)
from ...errors import CommandError
from ...formats.inertia import combine_inertia, solid_moments
from ...formats.mesh.loading import load_mesh, load_solid
from ...geometry import Pose


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
    solids = [(_unit_density_inertial(one.geometry), one.pose) for one in collisions]
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
            total = combine_inertia(total, with_density(solid, density), pose)
    assert total is not None
    return total


def with_density(i: Inertial, factor: float) -> Inertial:
    """Multiply the mass and the inertia tensor by a density."""
    return replace(i, mass=i.mass * factor, ixx=i.ixx * factor, iyy=i.iyy * factor,
                   izz=i.izz * factor, ixy=i.ixy * factor, ixz=i.ixz * factor, iyz=i.iyz * factor)


def _unit_density_inertial(geometry: Geometry) -> Optional[Inertial]:
    """Return the inertia of a shape of density 1 kg/m^3 in its frame; None without a volume."""
    known = solid_moments(geometry)
    if known is not None:
        return _diagonal(known[0], *known[1])
    if isinstance(geometry, Ellipsoid):
        a, b, c = geometry.radii
        return _diagonal(4 / 3 * math.pi * a * b * c, (b * b + c * c) / 5, (a * a + c * c) / 5,
                         (a * a + b * b) / 5)
    if isinstance(geometry, Capsule):
        return _capsule_inertial(geometry.radius, geometry.length)
    if isinstance(geometry, Cone):
        return _cone_inertial(geometry.radius, geometry.length)
    if isinstance(geometry, Mesh):
        return mesh_solid(load_mesh(geometry))[0]
    if isinstance(geometry, Polyline):
        return mesh_solid(load_solid(geometry))[0]
    return None


def _diagonal(volume: float, x: float, y: float, z: float) -> Inertial:
    """Return the inertia of a solid of density 1 kg/m^3; `x`, `y`, `z`: moments per mass."""
    return Inertial(volume, ixx=volume * x, iyy=volume * y, izz=volume * z)


def _capsule_inertial(r: float, h: float) -> Inertial:
    """Return the inertia of a capsule of density 1 kg/m^3, a cylinder of length h with end caps.

    The centre of mass of a hemisphere is 3/8 r off its plane (parallel axis theorem).
    """
    tube, balls = math.pi * r * r * h, 4 / 3 * math.pi * r ** 3
    side = tube * (3 * r * r + h * h) / 12 + balls * (
        2 / 5 * r * r + h * h / 4 + 3 / 8 * h * r)
    return Inertial(tube + balls, ixx=side, iyy=side, izz=tube * r * r / 2 + balls * 2 / 5 * r * r)


def _cone_inertial(r: float, h: float) -> Inertial:
    """Return the inertia of a cone of density 1 kg/m^3 that points along z.

    Its frame is half-way up, its centre of mass a quarter of the height above the base.
    """
    volume = math.pi * r * r * h / 3
    side = volume * (3 / 20 * r * r + 3 / 80 * h * h)
    return Inertial(volume, Pose((0.0, 0.0, -h / 4)), ixx=side, iyy=side,
                    izz=volume * 3 / 10 * r * r)


def mesh_solid(data: MeshData) -> Tuple[Optional[Inertial], bool]:
    """The inertial of a mesh as a solid of density 1 kg/m^3, and whether its surface is closed.

    An open one counts as its convex hull; None for one without a volume.
    """
    import trimesh

    solid = trimesh.Trimesh(data.vertices, data.triangles, process=True)
    closed = bool(solid.is_watertight and solid.volume > 0.0)
    if not closed:
        solid = solid.convex_hull
    if not solid.volume > 0.0:
        return None, closed
    x, y, z = (float(part) for part in solid.center_mass)
    moments = solid.moment_inertia
    return Inertial(float(solid.volume), Pose((x, y, z)),
                    ixx=float(moments[0][0]), iyy=float(moments[1][1]), izz=float(moments[2][2]),
                    ixy=float(moments[0][1]), ixz=float(moments[0][2]),
                    iyz=float(moments[1][2])), closed
