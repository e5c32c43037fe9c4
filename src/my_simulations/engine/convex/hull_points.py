"""Points whose convex hull is a given shape."""
from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from ...description.shapes import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Sphere

_ROUND = 32     # points on a circle
_SPHERE = 256   # points on a sphere


_THIN = 2.5        # times the distance: thinner hulls are not shrunk
_FARTHEST = 3.0    # times the distance: how far a sharp corner moves


def hull_points(geometry: Geometry) -> np.ndarray[Any, Any]:
    """Points (n, 3) in metres, in the shape's frame, whose hull is the shape.

    Points are on the surface, so hulls of curved shapes are slightly smaller: a sphere of 256
    points by 1 % of its radius. Raises ValueError: a shape without a hull, such as a plane.
    """
    if isinstance(geometry, Box):
        return np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * geometry.size
    if isinstance(geometry, Sphere):
        return geometry.radius * _unit_sphere()
    if isinstance(geometry, Ellipsoid):
        return _unit_sphere() * geometry.radii
    if isinstance(geometry, Cylinder):
        return np.concatenate([_circle(geometry.radius, z * geometry.length) for z in (-0.5, 0.5)])
    if isinstance(geometry, Cone):
        return np.concatenate([_circle(geometry.radius, -0.5 * geometry.length),
                               [[0.0, 0.0, 0.5 * geometry.length]]])
    if isinstance(geometry, Capsule):
        ball = geometry.radius * _unit_sphere()
        shift = np.array([0.0, 0.0, 0.5 * geometry.length])
        return np.concatenate([ball + shift, ball - shift])
    raise ValueError(f"a {type(geometry).__name__.lower()} has no hull")


def triangles_of_all_points(count: int) -> np.ndarray[Any, Any]:
    """Triangles (count, 3) that use every point, because mesh readers skip unused points."""
    ring = np.arange(count)
    return np.stack([ring, (ring + 1) % count, (ring + 2) % count], axis=1)


def shrunk(vertices: np.ndarray[Any, Any], triangles: np.ndarray[Any, Any],
           distance: float) -> np.ndarray[Any, Any]:
    """The corners of a convex solid whose faces are all moved inwards by `distance`, m.

    `triangles` (m, 3) are its surface. Corners keep their order. What is hardly thicker than twice
    the distance stays as it is.
    """
    points, same = np.unique(vertices, axis=0, return_inverse=True)
    corners = points[same.reshape(-1)[triangles]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    faces = np.flatnonzero(sizes > 1e-12 * sizes.max())
    outward = ((corners[:, 0] - points.mean(axis=0)) * normals).sum(axis=1) >= 0.0
    normals[faces] /= np.where(outward, sizes, -sizes)[faces, None]
    reach = (corners[faces, 0] * normals[faces]).sum(axis=1)
    thickness = reach - (points @ normals[faces].T).min(axis=0)
    if thickness.min() < _THIN * distance:
        return vertices
    moved = points.copy()
    at = same.reshape(-1)[triangles[faces]]
    for n in range(len(points)):
        mine = normals[faces[(at == n).any(axis=1)]]
        if len(mine):
            away = np.linalg.lstsq(mine, np.full(len(mine), -distance), rcond=1e-3)[0]
            length = max(float(np.linalg.norm(away)), 1e-12)
            moved[n] += away * min(1.0, _FARTHEST * distance / length)
    found: np.ndarray[Any, Any] = moved[same.reshape(-1)]
    return found


def _circle(radius: float, z: float) -> np.ndarray[Any, Any]:
    turns = np.linspace(0.0, 2.0 * np.pi, _ROUND, endpoint=False)
    return np.stack([radius * np.cos(turns), radius * np.sin(turns), np.full(_ROUND, z)], axis=1)


def _unit_sphere() -> np.ndarray[Any, Any]:
    """Evenly spread points (Fibonacci lattice), the poles and the axes among them."""
    steps = np.arange(_SPHERE) + 0.5
    polar, turn = np.arccos(1.0 - 2.0 * steps / _SPHERE), np.pi * (1.0 + 5.0**0.5) * steps
    lattice = np.stack([np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar),
                        np.cos(polar)], axis=1)
    return np.concatenate([lattice, np.eye(3), -np.eye(3)])
