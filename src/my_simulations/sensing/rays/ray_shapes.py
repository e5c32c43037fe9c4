"""Shapes as Embree's geometries."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Sequence, Tuple

import numpy as np

from ...description.shapes import Capsule, Ellipsoid, Geometry, Sphere
from ...geometry import Pose
from ..poses import matrix
from ..tessellation import side_count, triangles_of, truncated_cone
from .embree import FLOAT3, FLOAT4, INDEX, SPHERES, TRIANGLES, UINT3, VERTEX


@dataclass(frozen=True)
class RayShape:
    """A collision or a visual: what rays meet, where it is on its link, and how bright it is.

    `endless`: a plane has no rim; `double_sided`: rays meet its faces from behind, too.
    """

    geometry: Geometry
    pose: Pose
    retro: float
    endless: bool = False
    double_sided: bool = True


def buffers_of(shape: RayShape) -> "List[Tuple[int, Tuple[Tuple[int, int, np.ndarray], ...]]]":
    """The Embree geometries of a shape, in the link frame: kind, and (use, format, rows) of each.

    Raises InputError: a mesh or its like cannot be read.
    """
    frame, solid = matrix(shape.pose), shape.geometry
    if isinstance(solid, Sphere):
        return [_sphere_buffers(frame, [(0.0, 0.0, 0.0, solid.radius)])]
    if isinstance(solid, Capsule):
        side = truncated_cone(solid.radius, solid.radius, solid.length, side_count(solid.radius))
        half = solid.length / 2
        return [triangle_buffers(frame, side.vertices, side.triangles),
                _sphere_buffers(frame, [(0, 0, -half, solid.radius), (0, 0, half, solid.radius)])]
    if isinstance(solid, Ellipsoid) and len(set(solid.radii)) == 1:
        return [_sphere_buffers(frame, [(0.0, 0.0, 0.0, solid.radii[0])])]
    surface = triangles_of(solid)
    return [] if surface is None else [triangle_buffers(frame, surface.vertices, surface.triangles)]


def _sphere_buffers(frame: np.ndarray, balls: Sequence[Tuple[float, float, float, float]],
             ) -> "Tuple[int, Tuple[Tuple[int, int, np.ndarray], ...]]":
    table = np.array(balls, dtype=np.float64)
    table[:, :3] = table[:, :3] @ frame[:3, :3].T + frame[:3, 3]
    return SPHERES, ((VERTEX, FLOAT4, np.ascontiguousarray(table, dtype=np.float32)),)


def triangle_buffers(frame: np.ndarray, vertices: np.ndarray, triangles: np.ndarray,
               ) -> "Tuple[int, Tuple[Tuple[int, int, np.ndarray], ...]]":
    """The vertices (n, 3), m, and triangles (m, 3) of a surface at a frame (4, 4) on its link."""
    placed = vertices @ frame[:3, :3].T + frame[:3, 3]
    return TRIANGLES, ((VERTEX, FLOAT3, np.ascontiguousarray(placed, dtype=np.float32)),
                       (INDEX, UINT3, np.ascontiguousarray(triangles, dtype=np.uint32)))
