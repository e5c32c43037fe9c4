"""Distribute the weight of a base over the edges of its sliding wheels.

Four wide wheels stand on a level floor on eight edges. For rigid bodies the load of each edge is
statically indeterminate, and the solver keeps the solution with which it began. Such a solution
loaded the inner edges on the right and the outer ones on the left; a Husky then turned at 1.08
rad/s. Real wheels, and Gazebo's contacts with `kp`, are compliant: with equal stiffness at all
edges, the load is a linear function of the position. It has the same sum and the same moments. With
this load, and Coulomb's law at each edge, the Husky turns at 1.36 rad/s.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional, Sequence, Tuple

from ...description.model import Link
from ...description.shapes import Cylinder
from ...geometry import Vec3, conjugate, cross, dot, norm, rotate, scale
from .bodies import Part
from .contact_points import DISTANCE, LOAD, NORMAL, PLACE, ContactPoint
from .link_states import Motion

Loads = Tuple[List[ContactPoint], List[float]]
_Plane = Tuple[Vec3, Vec3, Vec3, float]  # two directions in it, its normal, its height along it

_NEAR = 1e-4   # m: an edge closer to the floor carries a load
_LYING = 0.02  # of the axle along the floor normal: a wheel tilted more has one edge
_LEVEL = 1e-3  # m: floors with a larger height difference are not one plane
_ALIKE = 0.999  # cosine: floors with a smaller one between their normals, likewise


@dataclass
class _Edge:
    """Contacts of one edge of a wheel, and their mean position in the floor plane, m."""

    wheel: int
    contacts: List[ContactPoint]
    x: float
    y: float


def axle_of(part: Part, link: Link) -> Optional[Vec3]:
    """Return the axis of a link's only collision if it is a cylinder, in PyBullet's frame."""
    if len(link.collisions) != 1 or not isinstance(link.collisions[0].geometry, Cylinder):
        return None
    along = rotate(link.collisions[0].pose.orientation, (0.0, 0.0, 1.0))
    return rotate(conjugate(part.link_from_com.orientation), along)


def carrying(contacts: Sequence[ContactPoint]) -> Loads:
    """Return the contacts of a link that carry a load, and their loads, N."""
    kept = [contact for contact in contacts if contact[LOAD] > 0.0 and contact[DISTANCE] <= 0.0]
    return kept, [contact[LOAD] for contact in kept]


def shared(wheels: Sequence[Tuple[Motion, Optional[Vec3], Sequence[ContactPoint]]]) -> List[Loads]:
    """Return the loaded contacts of each wheel of a body, with loads for equally stiff edges.

    Args:
        wheels: the motion, the axle in PyBullet's frame, and all contacts of each wheel; other
            links, as casters, have no axle.

    If the wheels do not stand on one plane, or a load would be negative, Bullet's loads stay.
    """
    found = [carrying(contacts) for _, _, contacts in wheels]
    first = next((contacts[0] for contacts, _ in found if contacts), None)
    if first is None:
        return found
    normal = first[NORMAL]
    along = cross(normal, (0.0, 0.0, 1.0) if abs(normal[2]) < 0.9 else (0.0, 1.0, 0.0))
    along = scale(along, 1.0 / norm(along))
    plane = (along, cross(normal, along), normal, dot(first[PLACE], normal))
    edges: List[_Edge] = []
    moments = [0.0, 0.0, 0.0]
    for n, (motion, axle, contacts) in enumerate(wheels):
        axis = None if axle is None else rotate(motion.orientation, axle)
        if axis is not None and abs(dot(axis, normal)) > _LYING:
            return found
        own = _edges(n, motion.position, axis, contacts, plane, moments)
        if own is None:
            return found
        edges += own
    loads = _spread(edges, *moments)
    if loads is None:
        return found
    made: List[Loads] = [([], []) for _ in wheels]
    for edge, load in zip(edges, loads):
        kept, parts = made[edge.wheel]
        kept += edge.contacts
        parts += [load / len(edge.contacts)] * len(edge.contacts)
    return made


def _edges(wheel: int, centre: Vec3, axis: Optional[Vec3], contacts: Sequence[ContactPoint],
           plane: _Plane, moments: List[float]) -> Optional[List[_Edge]]:
    """Return the edges of a wheel, or None off the plane; add its loads to `moments`.

    Without an axis, each contact is an edge.
    """
    (tx, ty, tz), (sx, sy, sz), (nx, ny, nz), height = plane
    (u, v, w), (a, b, c) = centre, axis or centre
    count = 2 if axis is not None else len(contacts)
    sides: List[List[ContactPoint]] = [[] for _ in range(count)]
    xs, ys = [0.0] * count, [0.0] * count
    for n, contact in enumerate(contacts):
        if contact[DISTANCE] >= _NEAR:
            continue
        (x, y, z), (p, q, r), load = contact[PLACE], contact[NORMAL], contact[LOAD]
        if abs(x * nx + y * ny + z * nz - height) > _LEVEL or p * nx + q * ny + r * nz < _ALIKE:
            return None
        side = n if axis is None else int((x - u) * a + (y - v) * b + (z - w) * c > 0.0)
        sides[side].append(contact)
        along, aside = x * tx + y * ty + z * tz, x * sx + y * sy + z * sz
        xs[side] += along
        ys[side] += aside
        moments[0] += load
        moments[1] += load * along
        moments[2] += load * aside
    return [_Edge(wheel, side, x / len(side), y / len(side))
            for side, x, y in zip(sides, xs, ys) if side]


def _spread(edges: List[_Edge], total: float, x_load: float, y_load: float,
            ) -> Optional[List[float]]:
    """Return the load of each edge, linear in x and y; None if there is no positive solution."""
    count = len(edges)
    x0 = y0 = xx = xy = yy = 0.0
    for edge in edges:
        x, y = edge.x, edge.y
        x0, y0, xx, xy, yy = x0 + x, y0 + y, xx + x * x, xy + x * y, yy + y * y
    x0, y0 = x0 / count, y0 / count
    xx, xy, yy = xx - count * x0 * x0, xy - count * x0 * y0, yy - count * y0 * y0
    x_load, y_load = x_load - total * x0, y_load - total * y0
    span = xx * yy - xy * xy
    if span <= 1e-9 * (xx + yy) ** 2:
        return None
    p, q = (yy * x_load - xy * y_load) / span, (xx * y_load - xy * x_load) / span
    mean = total / count - p * x0 - q * y0
    loads = [mean + p * edge.x + q * edge.y for edge in edges]
    return loads if min(loads) > 0.0 else None
