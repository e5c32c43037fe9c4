"""The inertia of two bodies that are rigidly joined (parallel axis theorem)."""
from __future__ import annotations

from typing import Optional, Tuple

from ..description.model import Inertial
from ..geometry import Pose, Quat, Vec3, compose, rotate, scale, subtract, transform

Matrix = Tuple[Vec3, Vec3, Vec3]


def combined_inertia(a: Optional[Inertial], b: Optional[Inertial],
                     b_pose: Pose) -> Optional[Inertial]:
    """The inertia of two rigidly joined bodies, in the link frame of `a`.

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
        _shifted(tensor_a, a.mass, subtract(a.pose.position, centre)),
        _shifted(tensor_b, b.mass, subtract(centre_b, centre)),
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


def _shifted(t: Matrix, mass: float, d: Vec3) -> Matrix:
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
