"""Centre of mass and inertia of a link from its collision shapes, at uniform density."""
from __future__ import annotations

import math
from typing import Optional, Tuple

from ...description.model import Inertial, Link
from ...description.shapes import (
    SOLIDS,
    Capsule,
    Cone,
    Ellipsoid,
    Geometry,
    MeshData,
    MeshTable,
    mesh_key,
)
from ...errors import CommandError
from ...formats.combined_inertia import combined_inertia
from ...formats.default_inertia import solid_moments
from ...geometry import Pose

Solid = Tuple[float, Inertial]
"""Volume, m^3, and the inertial of 1 kg of it."""


def of_shapes(link: Link, meshes: MeshTable) -> Inertial:
    """The link's mass with centre and tensor of its collision shapes.

    Args:
        link: its collisions may overlap; each counts.
        meshes: what its meshes look like, by key. One that is not closed counts as its hull.

    Raises:
        CommandError: no collision has a volume.
    """
    solids = [(collision, solid) for collision in link.collisions
              for solid in [_solid(collision.geometry, meshes)] if solid is not None]
    volume = sum(solid[0] for _, solid in solids)
    if not volume > 0.0:
        raise CommandError(f"link {link.name!r} has no collision with a volume")
    total: Optional[Inertial] = None
    for collision, (own, unit) in solids:
        total = combined_inertia(total, _weighing(unit, link.inertial.mass * own / volume),
                                 collision.pose)
    assert total is not None
    return total


def _weighing(i: Inertial, mass: float) -> Inertial:
    return Inertial(mass, i.pose, ixx=i.ixx * mass, iyy=i.iyy * mass, izz=i.izz * mass,
                    ixy=i.ixy * mass, ixz=i.ixz * mass, iyz=i.iyz * mass)


def _solid(geometry: Geometry, meshes: MeshTable) -> Optional[Solid]:
    if isinstance(geometry, SOLIDS):
        data = meshes.get(mesh_key(geometry))
        return None if data is None else _of_mesh(data)
    found = solid_moments(geometry) or _round(geometry)
    if found is None:
        return None
    volume, (x, y, z) = found
    height = geometry.length / 4 - geometry.length / 2 if isinstance(geometry, Cone) else 0.0
    return volume, Inertial(1.0, Pose((0.0, 0.0, height)), ixx=x, iyy=y, izz=z)


def _round(geometry: Geometry) -> Optional[Tuple[float, Tuple[float, float, float]]]:
    """Volume and principal moments of 1 kg about the centre of mass."""
    if isinstance(geometry, Ellipsoid):
        x, y, z = geometry.radii
        return 4 / 3 * math.pi * x * y * z, ((y * y + z * z) / 5, (x * x + z * z) / 5,
                                             (x * x + y * y) / 5)
    if isinstance(geometry, Cone):
        r, h = geometry.radius, geometry.length
        side = 3 / 80 * (4 * r * r + h * h)
        return math.pi * r * r * h / 3, (side, side, 0.3 * r * r)
    if isinstance(geometry, Capsule):
        r, h = geometry.radius, geometry.length
        barrel, ball = math.pi * r * r * h, 4 / 3 * math.pi * r ** 3
        volume = barrel + ball
        # Each half ball has its centre of mass 3/8 r beyond the end of the barrel.
        side = (barrel * (r * r / 4 + h * h / 12)
                + ball * (0.4 * r * r + h * h / 4 + 3 / 8 * h * r)) / volume
        return volume, (side, side, (barrel * r * r / 2 + ball * 0.4 * r * r) / volume)
    return None


def _of_mesh(data: MeshData) -> Optional[Solid]:
    import trimesh

    solid = trimesh.Trimesh(data.vertices, data.triangles, process=True)
    if not solid.is_watertight or solid.volume <= 0.0:
        solid = solid.convex_hull
    volume = float(solid.volume)
    if not volume > 0.0:
        return None
    x, y, z = (float(part) for part in solid.center_mass)
    i = solid.moment_inertia / volume
    return volume, Inertial(1.0, Pose((x, y, z)), ixx=float(i[0][0]), iyy=float(i[1][1]),
                            izz=float(i[2][2]), ixy=float(i[0][1]), ixz=float(i[0][2]),
                            iyz=float(i[1][2]))
