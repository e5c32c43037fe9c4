"""Closed triangle meshes of simple solids, in metres with z up."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import List, Sequence, Tuple

import numpy as np

from my_simulations.formats.mesh.polygons import triangulate

Point = Tuple[float, float]
Vec3 = Tuple[float, float, float]
_CREASE = math.cos(math.radians(50.0))
"""Faces that meet at a smaller angle are shaded as one surface."""


@dataclass
class Mesh:
    """Vertices (n, 3) in metres and outward triangles (m, 3) that index them."""

    vertices: np.ndarray
    triangles: np.ndarray

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "Mesh":
        """The mesh, translated."""
        return Mesh(self.vertices + (x, y, z), self.triangles)

    def turned(self, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0) -> "Mesh":
        """The mesh, rotated about the origin by fixed-axis angles in radians."""
        return Mesh(self.vertices @ rotation(roll, pitch, yaw).T, self.triangles)

    def scaled(self, x: float, y: float, z: float) -> "Mesh":
        """The mesh, scaled along the axes by positive factors."""
        return Mesh(self.vertices * (x, y, z), self.triangles)

    def mirrored(self) -> "Mesh":
        """The mesh, reflected at the plane y = 0."""
        return Mesh(self.vertices * (1, -1, 1), self.triangles[:, ::-1])


def rotation(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """The matrix (3, 3) of fixed-axis angles in radians."""
    (a, b, c), (d, e, f) = np.cos((roll, pitch, yaw)), np.sin((roll, pitch, yaw))
    about_x = np.array([[1, 0, 0], [0, a, -d], [0, d, a]])
    about_y = np.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
    about_z = np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """The meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts)]),
    )


def loft(rings: Sequence[np.ndarray]) -> Mesh:
    """The solid through rings (k, 3) of equally many points, counter-clockwise seen from the last.

    The first and the last ring must be plane; they are closed by triangles.
    """
    count = len(rings[0])
    following = np.roll(np.arange(count), -1)
    triangles: List[np.ndarray] = []
    for level in range(len(rings) - 1):
        low, high = level * count, (level + 1) * count
        for i, j in zip(range(count), following):
            triangles += [
                np.array((low + i, low + j, high + j)),
                np.array((low + i, high + j, high + i)),
            ]
    mesh = Mesh(np.concatenate(rings), np.array(triangles))
    last = (len(rings) - 1) * count
    caps = np.concatenate([_cap(rings[0])[:, ::-1], _cap(rings[-1]) + last])
    return _without_slivers(Mesh(mesh.vertices, np.concatenate([mesh.triangles, caps])))


def _cap(ring: np.ndarray) -> np.ndarray:
    """Counter-clockwise triangles of a plane ring."""
    distinct = [k for k in range(len(ring)) if np.linalg.norm(ring[k] - ring[k - 1]) > 1e-9]
    if len(distinct) < 3:
        return np.zeros((0, 3), dtype=int)
    points = ring[distinct]
    normal = sum(np.cross(points[k - 1], points[k]) for k in range(len(points)))
    side = points[1] - points[0]
    across = np.cross(normal, side)
    flat = [(float(p @ side), float(p @ across)) for p in points]
    _, triangles = triangulate([flat])
    return np.array(distinct)[np.array(triangles)]


def _without_slivers(mesh: Mesh) -> Mesh:
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return Mesh(mesh.vertices, mesh.triangles[areas > 1e-10])


def level(outline: Sequence[Point], z: float) -> np.ndarray:
    """The ring (k, 3) of an outline at a height."""
    return np.array([(x, y, z) for x, y in outline], dtype=float)


def rounded(x: float, y: float, radius: float = 0.0, steps: int = 3) -> List[Point]:
    """The outline of a rectangle of these edge lengths with round corners."""
    outline = []
    for corner, (i, j) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for step in range(steps + 1):
            angle = (corner + step / steps) * math.pi / 2
            outline.append(
                (
                    i * (x / 2 - radius) + radius * math.cos(angle),
                    j * (y / 2 - radius) + radius * math.sin(angle),
                )
            )
    return outline


def block(size: Vec3, at: Vec3 = (0.0, 0.0, 0.0), bevel: float = 0.01) -> Mesh:
    """A box with bevelled edges around `at`."""
    x, y, z = size
    bevel = min(bevel, 0.45 * min(size))
    inner, outer = rounded(x - 2 * bevel, y - 2 * bevel, 0.0, 1), rounded(x, y, bevel, 1)
    return loft(
        [
            level(inner, -z / 2),
            level(outer, bevel - z / 2),
            level(outer, z / 2 - bevel),
            level(inner, z / 2),
        ]
    ).moved(*at)


def lathe(profile: Sequence[Point], sides: int = 20) -> Mesh:
    """A solid of revolution about z through (radius, height) points from bottom to top."""
    angles = np.arange(sides) * 2 * math.pi / sides
    return loft(
        [
            np.stack(
                [radius * np.cos(angles), radius * np.sin(angles), np.full(sides, height)], axis=1
            )
            for radius, height in profile
        ]
    )


def ball(radius: float, at: Vec3 = (0.0, 0.0, 0.0), sides: int = 14) -> Mesh:
    """A sphere."""
    rows = sides // 2
    return lathe(
        [
            (radius * math.sin(k * math.pi / rows), -radius * math.cos(k * math.pi / rows))
            for k in range(rows + 1)
        ],
        sides,
    ).moved(*at)


def rod(start: Vec3, end: Vec3, radius: float, end_radius: float = 0.0, sides: int = 12) -> Mesh:
    """A straight bar with plane ends, with another radius at its end if that is given."""
    length = float(np.linalg.norm(np.subtract(end, start)))
    return _along(lathe([(radius, 0.0), (end_radius or radius, length)], sides), start, end)


def limb(start: Vec3, end: Vec3, radius: float, end_radius: float, sides: int = 12) -> Mesh:
    """A bar with round ends."""
    length = float(np.linalg.norm(np.subtract(end, start)))
    below = [(radius * math.sin(a), -radius * math.cos(a)) for a in (0.0, 0.5, 1.0)]
    above = [
        (end_radius * math.cos(a), length + end_radius * math.sin(a))
        for a in (0.57, 1.07, math.pi / 2)
    ]
    return _along(lathe([*below, (radius, 0.0), (end_radius, length), *above], sides), start, end)


def _along(mesh: Mesh, start: Vec3, end: Vec3) -> Mesh:
    """A mesh along z as one that begins at `start` and points to `end`."""
    x, y, z = np.subtract(end, start)
    tilt, heading = math.atan2(math.hypot(x, y), z), math.atan2(y, x)
    return mesh.turned(0.0, tilt, heading).moved(*start)


def tube(path: Sequence[Vec3], radius: float, sides: int = 8, closed: bool = False) -> Mesh:
    """A round bar along a path, with joints at its corners."""
    points = list(path) + ([path[0]] if closed else [])
    return joined([limb(a, b, radius, radius, sides) for a, b in zip(points, points[1:])])


def plate(outline: Sequence[Point], thickness: float, bevel: float = 0.0) -> Mesh:
    """An outline (counter-clockwise) with a thickness upwards from z = 0, with bevelled edges."""
    if not bevel:
        return loft([level(outline, 0.0), level(outline, thickness)])
    small = _inset(outline, bevel)
    return loft(
        [
            level(small, 0.0),
            level(outline, bevel),
            level(outline, thickness - bevel),
            level(small, thickness),
        ]
    )


def _inset(outline: Sequence[Point], distance: float) -> List[Point]:
    """The outline with each edge shifted inwards."""
    points = np.array(outline)
    edges = np.roll(points, -1, axis=0) - points
    normals = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
    before = np.roll(normals, 1, axis=0)
    shift = (normals + before) / (1 + np.sum(normals * before, axis=1))[:, None]
    return [(float(x), float(y)) for x, y in points + distance * shift]


def standing(mesh: Mesh) -> Mesh:
    """A plate in x and y as one in x and z, with its thickness centred on y = 0."""
    turned = mesh.turned(math.pi / 2)
    middle = (turned.vertices[:, 1].min() + turned.vertices[:, 1].max()) / 2
    return turned.moved(y=-float(middle))


def corner_normals(mesh: Mesh) -> np.ndarray:
    """Unit normals (m, 3, 3) of the corners; wide faces count more than narrow ones."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    weighted = np.cross(b - a, c - a)
    unit = weighted / np.linalg.norm(weighted, axis=1)[:, None]
    places = {}
    keys = [tuple(row) for row in np.round(mesh.vertices, 6).tolist()]
    for face, corners in enumerate(mesh.triangles.tolist()):
        for corner in corners:
            places.setdefault(keys[corner], []).append(face)
    normals = np.zeros((len(mesh.triangles), 3, 3))
    for face, corners in enumerate(mesh.triangles.tolist()):
        for k, corner in enumerate(corners):
            around = np.array(places[keys[corner]])
            smooth = around[unit[around] @ unit[face] > _CREASE]
            total = weighted[smooth].sum(axis=0)
            normals[face, k] = total / np.linalg.norm(total)
    return normals
