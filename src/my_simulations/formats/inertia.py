"""Inertia of rigidly joined bodies, and substitutes for impossible inertia of links.

Gazebo loads links with impossible inertia: ODE cannot invert the tensor and uses 1 kg m^2 about
each axis (`dBodySetMass`); so does this module. Zeros are treated as omitted values and replaced by
better ones: those of the collision shapes, or the least that a body can have. Examples: the
furniture of Care-O-bot has all-zero tensors, and some files give the moment about one axis only.
"""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, List, Optional, Tuple

from ..description.model import Inertial, Link
from ..description.shapes import Box, Collision, Cylinder, Geometry, Sphere
from ..description.validate import is_positive_definite, tensor_text
from ..geometry import Pose, Quat, Vec3, compose, rotate, scale, subtract, transform
from .xml.source import Source

_LEAST = 1e-3
"""Smallest ratio of two principal moments: that of a rod a hundred times as long as wide."""


def usable_inertia(link: Link, source: Source, element: Any) -> Inertial:
    """The inertia of a dynamic link; one that cannot be simulated is replaced, with a warning."""
    inertial = link.inertial
    better = complete_inertia(inertial, link.collisions)
    if better is not None:
        source.warn("inertia-zero", f"the inertia of link {link.name!r} {better[1]}", element)
        return better[0]
    if is_positive_definite(inertial) or inertial.mass <= 0:
        return inertial
    source.tolerate("inertia-not-positive", f"the inertia of link {link.name!r} is not positive"
                    " definite; 1 kg m^2 about each axis is used, as by ODE:"
                    f" {tensor_text(inertial)}", element,
                    "a body's principal moments of inertia are all above 0")
    return replace(inertial, ixx=1.0, iyy=1.0, izz=1.0, ixy=0.0, ixz=0.0, iyz=0.0)


def complete_inertia(inertial: Inertial, collisions: List[Collision],
                     ) -> Optional[Tuple[Inertial, str]]:
    """Fill in omitted values of an inertia; return it and a phrase for the warning.

    Returns None if no value is omitted, or if the omitted values cannot be estimated.
    """
    if is_zero(inertial):
        better = with_tensor_of_shapes(inertial, collisions)
        return None if better is None else (better, "is zero; that of its shapes is used")
    return _raise_moments(inertial)


def _raise_moments(i: Inertial) -> Optional[Tuple[Inertial, str]]:
    """Replace zero moments by the least value that is possible beside the other moments.

    No principal moment exceeds the sum of the two others.
    """
    moments = (i.ixx, i.iyy, i.izz)
    least, middle, largest = sorted(moments)
    if least != 0 or largest <= 0 or i.mass <= 0 or any((i.ixy, i.ixz, i.iyz)):
        return None
    value = largest / 2 if middle == 0 else max(largest - middle, _LEAST * largest)
    x, y, z = (moment or value for moment in moments)
    names = " and ".join(name for name, was in zip(("ixx", "iyy", "izz"), moments) if was == 0)
    return replace(i, ixx=x, iyy=y, izz=z), (
        f"has {names} 0, which no body has; {value:g} kg m^2 is used")


def is_zero(inertial: Inertial) -> bool:
    """True for a body with a mass and an all-zero tensor."""
    i = inertial
    return i.mass > 0 and not any((i.ixx, i.iyy, i.izz, i.ixy, i.ixz, i.iyz))


def with_tensor_of_shapes(inertial: Inertial, collisions: List[Collision]) -> Optional[Inertial]:
    """The same mass and centre of mass, with the tensor of the collision shapes at uniform density.

    Returns None if no collision is a box, sphere or cylinder.
    """
    total = solid_inertial(inertial.mass, collisions)
    if total is not None:
        total.pose = inertial.pose._replace(orientation=total.pose.orientation)
    return total


def solid_inertial(mass: float, collisions: List[Collision]) -> Optional[Inertial]:
    """The inertial of the collision shapes at uniform density with a mass (kg) in all.

    Returns None if no collision is a box, sphere or cylinder.
    """
    solids = [(collision, solid) for collision in collisions
              for solid in [solid_moments(collision.geometry)] if solid is not None]
    volume = sum(solid[0] for _, solid in solids)
    if not volume > 0:
        return None
    total: Optional[Inertial] = None
    for collision, (own, (x, y, z)) in solids:
        share = mass * own / volume
        part = Inertial(share, ixx=share * x, iyy=share * y, izz=share * z)
        total = combine_inertia(total, part, collision.pose)
    return total


def solid_moments(geometry: Geometry) -> Optional[Tuple[float, Tuple[float, float, float]]]:
    """Volume (m^3) and principal moments of 1 kg (kg m^2) of a solid shape about its centre."""
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


Matrix = Tuple[Vec3, Vec3, Vec3]


def combine_inertia(a: Optional[Inertial], b: Optional[Inertial],
                    b_pose: Pose) -> Optional[Inertial]:
    """Add the inertia of two rigidly joined bodies, in the link frame of `a`.

    Args:
        a: inertial of the first body; None or mass 0 for no mass.
        b: inertial of the second body, likewise.
        b_pose: pose of the link frame of `b` in that of `a`.

    Returns:
        The combined inertial; its tensor is about the common centre of mass, in the axes of the
        link frame of `a`.
    """
    if b is None or b.mass <= 0:
        return a
    centre_b = transform(b_pose, b.pose.position)
    tensor_b = _rotate_tensor(_tensor(b), compose(b_pose, b.pose).orientation)
    if a is None or a.mass <= 0:
        return _inertial(b.mass, centre_b, tensor_b)
    mass = a.mass + b.mass
    centre = (
        (a.mass * a.pose.position[0] + b.mass * centre_b[0]) / mass,
        (a.mass * a.pose.position[1] + b.mass * centre_b[1]) / mass,
        (a.mass * a.pose.position[2] + b.mass * centre_b[2]) / mass,
    )
    tensor_a = _rotate_tensor(_tensor(a), a.pose.orientation)
    total = _sum(
        _shift_tensor(tensor_a, a.mass, subtract(a.pose.position, centre)),
        _shift_tensor(tensor_b, b.mass, subtract(centre_b, centre)),
    )
    return _inertial(mass, centre, total)


def _tensor(i: Inertial) -> Matrix:
    return ((i.ixx, i.ixy, i.ixz), (i.ixy, i.iyy, i.iyz), (i.ixz, i.iyz, i.izz))


def _inertial(mass: float, centre: Vec3, t: Matrix) -> Inertial:
    return Inertial(mass, Pose(centre), t[0][0], t[0][1], t[0][2], t[1][1], t[1][2], t[2][2])


def _rotate_tensor(t: Matrix, q: Quat) -> Matrix:
    """R t R^T, as R applied to the columns, then to the rows; `t` is symmetric."""
    once = tuple(rotate(q, row) for row in t)
    columns = tuple((once[0][k], once[1][k], once[2][k]) for k in range(3))
    x, y, z = (rotate(q, column) for column in columns)
    return (x, y, z)


def _shift_tensor(t: Matrix, mass: float, d: Vec3) -> Matrix:
    """The tensor about a point that lies -d from the centre of mass (Steiner)."""
    square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    rows = []
    for k in range(3):
        own = scale(d, -d[k])
        row = [t[k][j] + mass * (own[j] + (square if j == k else 0.0)) for j in range(3)]
        rows.append((row[0], row[1], row[2]))
    return (rows[0], rows[1], rows[2])


def _sum(a: Matrix, b: Matrix) -> Matrix:
    x, y, z = (
        (a[k][0] + b[k][0], a[k][1] + b[k][1], a[k][2] + b[k][2]) for k in range(3)
    )
    return (x, y, z)
