"""Shapes as triangles, in the frame of the shape; for rays and for pictures."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import List, Optional, Tuple

import numpy as np

from ..description.shapes import (
    SOLIDS,
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Plane,
    Sphere,
)
from ..geometry import Pose, Vec3, conjugate, cross, norm, rotate, scale

RAY_ERROR = 5e-5
"""m that a round surface may lie off where rays meet it."""


@dataclass(frozen=True)
class Triangles:
    """A surface: `vertices` float64 (n, 3) m, `triangles` int32 (m, 3), the rest per vertex.

    Attributes:
        normals: (n, 3), outwards.
        uv: (n, 2) texture coordinates, v upwards in the picture.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    normals: Optional[np.ndarray] = None
    uv: Optional[np.ndarray] = None


def side_count(radius: float, error: float = RAY_ERROR) -> int:
    """Return how many sides a polygon needs to stay within `error` (m) of its circle.

    The corners lie as far outside as the middles of the sides inside.
    """
    needed = math.pi * math.sqrt(max(radius, 1e-6) / (4.0 * error))
    return int(min(max(math.ceil(needed / 4.0) * 4, 64), 1024))


def triangles_of(shape: Geometry, round_sides: int = 0) -> Optional[Triangles]:
    """The surface of a shape; None for one that has none.

    `round_sides`: of circles; 0 for as many as rays need. Raises InputError: a mesh, terrain, map
    image or polygon that cannot be read.
    """
    if isinstance(shape, Box):
        return box(shape.size)
    if isinstance(shape, Sphere):
        return ellipsoid((shape.radius,) * 3, round_sides or side_count(shape.radius))
    if isinstance(shape, Ellipsoid):
        return ellipsoid(shape.radii, round_sides or side_count(max(shape.radii)))
    if isinstance(shape, Cylinder):
        return truncated_cone(shape.radius, shape.radius, shape.length,
                              round_sides or side_count(shape.radius))
    if isinstance(shape, Cone):
        return truncated_cone(shape.radius, 0.0, shape.length,
                              round_sides or side_count(shape.radius))
    if isinstance(shape, Capsule):
        return capsule(shape.radius, shape.length, round_sides or side_count(shape.radius))
    if isinstance(shape, Plane):
        return plane(shape.normal, shape.size)
    if isinstance(shape, SOLIDS):
        from ..formats.mesh.loading import load_solid  # not before there is a mesh

        data = load_solid(shape)
        return Triangles(data.vertices, data.triangles)
    return None


def box(size: Vec3) -> Triangles:
    """Return the surface of a box with four corners per face."""
    vertices, normals, uv = [], [], []
    for axis in range(3):
        for sign in (1.0, -1.0):
            first, second = (axis + 1) % 3, (axis + 2) % 3
            for a, b in ((-sign, -1.0), (sign, -1.0), (sign, 1.0), (-sign, 1.0)):
                corner, normal = [0.0] * 3, [0.0] * 3
                corner[axis], corner[first], corner[second] = sign, a, b
                normal[axis] = sign
                vertices.append([half * edge / 2 for half, edge in zip(corner, size)])
                normals.append(normal)
            uv += _face_uv(axis)
    quads = np.arange(24).reshape(6, 4)
    return Triangles(np.array(vertices), _of_quads(quads), np.array(normals), np.array(uv))


def _face_uv(axis: int) -> List[Tuple[float, float]]:
    """A whole picture a face, upright on the sides; the faces' corners begin elsewhere on y."""
    upright = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    return [upright[(n + 3) % 4] for n in range(4)] if axis == 1 else upright


def repeated_uv(vertices: np.ndarray, normals: np.ndarray, pose: Pose, size: float) -> np.ndarray:
    """Texture coordinates of a box for pictures of one size, upright on the sides.

    They begin at the origin of the link, so that the pictures of the parts of a wall meet.

    Args:
        vertices: of the box, m in its own frame.
        normals: of the faces, at each vertex.
        pose: of the box in the link.
        size: edge of a picture, m.
    """
    start = rotate(conjugate(pose.orientation), pose.position)
    x, y, z = (vertices + np.array(start)).T
    along_x, along_y = normals[:, 0], normals[:, 1]
    on_top = np.abs(normals[:, 2]) > 0.5
    u = np.where(on_top, x, along_x * y - along_y * x)
    v = np.where(on_top, normals[:, 2] * y, z)
    return np.column_stack([u, v]) / size


def _of_quads(quads: np.ndarray) -> np.ndarray:
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)


def plane(normal: Vec3, size: Tuple[float, float]) -> Triangles:
    """A rectangle about the origin."""
    up = scale(normal, 1.0 / (norm(normal) or 1.0))
    along: Vec3 = (1.0, 0.0, 0.0) if abs(up[0]) < 0.9 else (0.0, 1.0, 0.0)
    side = cross(up, along)
    side = scale(side, 1.0 / norm(side))
    along = cross(side, up)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
    vertices = (corners[:, :1] * np.array(along) * size[0] / 2
                + corners[:, 1:] * np.array(side) * size[1] / 2)
    return Triangles(vertices, _of_quads(np.arange(4).reshape(1, 4)),
                     np.tile(np.array(up), (4, 1)), (corners + 1) / 2)


def _ring(count: int) -> np.ndarray:
    angles = np.linspace(0.0, 2.0 * math.pi, count + 1)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    circle[-1] = circle[0]  # to the last bit: rays must not slip through the seam
    return circle


def _compute_widening(count: int) -> float:
    """By how much a circle's corners lie outside, so that its sides are right on average."""
    return 2.0 / (1.0 + math.cos(math.pi / count))


def truncated_cone(bottom: float, top: float, length: float, count: int) -> Triangles:
    """Return the surface of a cylinder, cone or truncated cone about z, with its end faces.

    `bottom`, `top`: radii (m); the origin is half-way up.
    """
    circle, wide = _ring(count), _compute_widening(count)
    slope = np.array([length, bottom - top]) / (math.hypot(length, bottom - top) or 1.0)
    sides_at = np.linspace(0.0, 1.0, count + 1)
    outwards = np.column_stack([circle * slope[0], np.full(count + 1, slope[1])])
    vertices, normals, uv = [], [], []
    for radius, z, v in ((bottom, -length / 2, 0.0), (top, length / 2, 1.0)):
        vertices.append(np.column_stack([circle * radius * wide, np.full(count + 1, z)]))
        normals.append(outwards)
        uv.append(np.column_stack([sides_at, np.full(count + 1, v)]))
    n = np.arange(count)
    quads = np.stack([n, n + 1, n + count + 2, n + count + 1], axis=1)
    triangles = [_of_quads(quads)]
    first = 2 * (count + 1)
    for radius, z, sign in ((bottom, -length / 2, -1.0), (top, length / 2, 1.0)):
        if radius <= 0:
            continue
        rim = np.column_stack([circle[:-1] * radius * wide, np.full(count, z)])
        vertices.append(np.vstack([[[0.0, 0.0, z]], rim]))
        normals.append(np.tile([0.0, 0.0, sign], (count + 1, 1)))
        uv.append(np.vstack([[[0.5, 0.5]], circle[:-1] / 2 + 0.5]))
        lid = np.stack([np.full(count, first), first + 1 + n, first + 1 + (n + 1) % count], axis=1)
        triangles.append((lid if sign > 0 else lid[:, ::-1]).astype(np.int32))
        first += count + 1
    return Triangles(np.concatenate(vertices), np.concatenate(triangles), np.concatenate(normals),
                     np.concatenate(uv))


def ellipsoid(radii: Vec3, count: int) -> Triangles:
    """Return the surface of an ellipsoid with `count` meridians."""
    return _revolve(np.linspace(-math.pi / 2, math.pi / 2, count // 2 + 1), np.array(radii), 0.0,
                    count)


def capsule(radius: float, length: float, count: int) -> Triangles:
    """Return the surface of a cylinder along z with a hemisphere at each end."""
    half = np.linspace(0.0, math.pi / 2, count // 4 + 1)
    return _revolve(np.concatenate([-half[::-1], half]), np.full(3, radius), length, count)


def _revolve(latitudes: np.ndarray, radii: np.ndarray, length: float, count: int) -> Triangles:
    circle, levels = _ring(count), len(latitudes)
    across = np.cos(latitudes)
    across[np.abs(latitudes) > math.pi / 2 - 1e-9] = 0.0  # nor through the poles
    unit = np.concatenate([
        np.column_stack([circle * wide, np.full(count + 1, math.sin(latitude))])
        for wide, latitude in zip(across, latitudes)])
    ends = np.repeat(np.where(np.arange(levels) < levels / 2, -0.5, 0.5), count + 1) * length
    vertices = unit * radii
    vertices[:, 2] += ends
    normals = unit / radii
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    uv = np.column_stack([np.tile(np.linspace(0, 1, count + 1), levels),
                          np.repeat(np.linspace(0, 1, levels), count + 1)])
    level, n = np.meshgrid(np.arange(levels - 1), np.arange(count), indexing="ij")
    at = (level * (count + 1) + n).ravel()
    quads = np.stack([at, at + 1, at + count + 2, at + count + 1], axis=1)
    return Triangles(vertices, _of_quads(quads), normals, uv)
