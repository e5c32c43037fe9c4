"""Mass properties and bounds of solids, for tests of the shipped models."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Sequence, Tuple

import numpy as np
import trimesh

from my_simulations.description.shapes import Mesh
from my_simulations.formats.mesh.loading import load_mesh
from my_simulations.geometry import Pose, rotate

Matrix = np.ndarray


@dataclass
class Solid:
    """A solid of density 1: centre of mass and inertia about it, in the frame of `pose`."""

    kind: str
    size: Tuple[float, ...]
    pose: Pose
    volume: float
    centre: Matrix
    inertia: Matrix
    corners: Matrix


def box(size: Sequence[float], pose: Pose) -> Solid:
    a, b, c = size
    volume = a * b * c
    inertia = np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) * volume / 12
    return _solid("box", tuple(size), pose, volume, inertia, (a / 2, b / 2, c / 2))


def sphere(radius: float, pose: Pose) -> Solid:
    volume = 4 / 3 * np.pi * radius ** 3
    inertia = np.eye(3) * 0.4 * volume * radius ** 2
    return _solid("sphere", (radius,), pose, volume, inertia, (radius,) * 3)


def cylinder(radius: float, length: float, pose: Pose) -> Solid:
    volume = np.pi * radius ** 2 * length
    across = volume / 12 * (3 * radius ** 2 + length ** 2)
    inertia = np.diag([across, across, volume / 2 * radius ** 2])
    return _solid("cylinder", (radius, length), pose, volume, inertia,
                  (radius, radius, length / 2))


def mesh(file: Mesh, pose: Pose) -> Solid:
    """A closed mesh."""
    data = load_mesh(file)
    made = trimesh.Trimesh(data.vertices, data.triangles, process=False)
    turn = _matrix(pose)
    place = np.array(pose.position)
    return Solid("mesh", (), pose, made.volume, turn @ made.center_mass + place,
                 turn @ made.moment_inertia @ turn.T, data.vertices @ turn.T + place)


def compound(solids: Sequence[Solid], mass: float) -> Tuple[Matrix, Matrix]:
    """Centre of mass and inertia about it of solids of one density with `mass` in all."""
    density = mass / sum(s.volume for s in solids)
    centre = sum(s.volume * s.centre for s in solids) * density / mass
    inertia = sum(density * (s.inertia + s.volume * _steiner(s.centre - centre)) for s in solids)
    return centre, inertia


def bounds(solid: Solid) -> Tuple[Matrix, Matrix]:
    """The lower and upper corner of the axis-aligned bounding box."""
    if solid.kind == "sphere":
        reach = np.full(3, solid.size[0])
        return solid.centre - reach, solid.centre + reach
    if solid.kind == "cylinder":
        axis = _matrix(solid.pose)[:, 2]
        reach = solid.size[0] * np.sqrt(np.maximum(0, 1 - axis ** 2)) \
            + solid.size[1] / 2 * np.abs(axis)
        return solid.centre - reach, solid.centre + reach
    return solid.corners.min(0), solid.corners.max(0)


def overlap_depth(one: Solid, other: Solid) -> float:
    """How deep two solids may overlap, by separating axes of their faces; at most 0 when apart.

    Never too small: cylinders and spheres count with their whole extent along each axis.
    """
    axes: List[Matrix] = [*np.eye(3), *_matrix(one.pose).T, *_matrix(other.pose).T]
    depths = []
    for axis in axes:
        (low_a, high_a), (low_b, high_b) = _extent(one, axis), _extent(other, axis)
        depths.append(min(high_a, high_b) - max(low_a, low_b))
        if depths[-1] <= 0.0:
            break
    return float(min(depths))


def _extent(solid: Solid, axis: Matrix) -> Tuple[float, float]:
    middle = float(solid.centre @ axis)
    if solid.kind == "sphere":
        return middle - solid.size[0], middle + solid.size[0]
    if solid.kind == "cylinder":
        along = abs(float(_matrix(solid.pose)[:, 2] @ axis))
        reach = solid.size[1] / 2 * along + solid.size[0] * max(0.0, 1 - along ** 2) ** 0.5
        return middle - reach, middle + reach
    reached = solid.corners @ axis
    return float(reached.min()), float(reached.max())


def _solid(kind, size, pose, volume, inertia, half) -> Solid:
    turn = _matrix(pose)
    corners = np.array([[i * half[0], j * half[1], k * half[2]]
                        for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    centre = np.array(pose.position)
    return Solid(kind, size, pose, float(volume), centre, turn @ inertia @ turn.T,
                 corners @ turn.T + centre)


def _matrix(pose: Pose) -> Matrix:
    return np.array([rotate(pose.orientation, axis)
                     for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]).T


def _steiner(offset: Matrix) -> Matrix:
    return np.eye(3) * float(offset @ offset) - np.outer(offset, offset)
