"""Distribute the weight of a base over the edges of its sliding wheels.

Four wide wheels stand on a level floor on eight edges. For rigid bodies the load of each edge is
statically indeterminate, and the solver keeps the solution with which it began. Such a solution
loaded the inner edges on the right and the outer ones on the left; a Husky then turned at 1.08
rad/s. Real wheels, and Gazebo's contacts with `kp`, are compliant: with equal stiffness at all
edges, the load is a linear function of the position. It has the same sum and the same moments. With
this load, and Coulomb's law at each edge, the Husky turns at 1.36 rad/s.
"""
from __future__ import annotations

from math import hypot
from typing import List, Optional, Sequence, Tuple

from ...description.model import Link
from ...description.shapes import Box, Cylinder
from ...geometry import (
    Vec3,
    add,
    compose,
    conjugate,
    cross,
    dot,
    inverse,
    norm,
    rotate,
    scale,
)
from .bodies import Part
from .contact_points import DISTANCE, LOAD, NORMAL, OTHER_BODY, OTHER_POINT, POINT, ContactPoint
from .link_states import Motion

Loads = Tuple[List[ContactPoint], List[float]]
Corners = Tuple[Vec3, ...]
Wheel = Tuple[Motion, Optional[Vec3], Corners, Sequence[ContactPoint]]
"""Motion, axle in PyBullet's frame, corners of a box, m, in that frame, and all contacts. Other
links, as casters, have no axle."""
_Edges = Tuple[List[Tuple[int, List[ContactPoint]]], List[float], List[float], float, float, float]
"""Each edge's wheel and contacts; mean positions along two directions of the plane, m; the sums of
the loads, N, and of loads times positions, N m."""

NEAR = 1e-4
"""m: an edge closer to the floor carries a load."""

_TILTED = 0.02     # of the axle along the floor normal: a wheel tilted more has one edge
_LEVEL = 1e-3      # m: floors with a larger height difference are not one plane
_ASIDE = 1e-3      # m: loads whose centre is further from a line of edges are not on it
_PARALLEL = 0.999  # cosine: floors with a smaller one between their normals, likewise


def axle_of(part: Part, link: Link) -> Optional[Vec3]:
    """Return the axis of a link's only collision if it is a cylinder, in PyBullet's frame."""
    if len(link.collisions) != 1 or not isinstance(link.collisions[0].geometry, Cylinder):
        return None
    along = rotate(link.collisions[0].pose.orientation, (0.0, 0.0, 1.0))
    return rotate(conjugate(part.link_from_com.orientation), along)


def corners_of(part: Part, link: Link) -> Corners:
    """Return the corners of a link's only collision if it is a box, m, in PyBullet's frame."""
    if len(link.collisions) != 1 or not isinstance(link.collisions[0].geometry, Box):
        return ()
    x, y, z = scale(link.collisions[0].geometry.size, 0.5)
    at = compose(inverse(part.link_from_com), link.collisions[0].pose)
    return tuple(add(at.position, rotate(at.orientation, (i * x, j * y, k * z)))
                 for i in (-1, 1) for j in (-1, 1) for k in (-1, 1))


def loaded_contacts(contacts: Sequence[ContactPoint]) -> Loads:
    """Return the contacts of a link that carry a load, and their loads, N."""
    kept = [contact for contact in contacts if contact[LOAD] > 0.0 and contact[DISTANCE] <= 0.0]
    return kept, [contact[LOAD] for contact in kept]


def distribute_loads(wheels: Sequence[Wheel]) -> List[Loads]:
    """Return the loaded contacts of each wheel of a body, with the loads of equally stiff edges.

    If the wheels do not stand on one plane, or a load would be negative, Bullet's loads stay.
    """
    edges = _edges(wheels)
    loads = None if edges is None else _spread(*edges[1:])
    if edges is None or loads is None:
        return [loaded_contacts(contacts) for _, _, _, contacts in wheels]
    made: List[Loads] = [([], []) for _ in wheels]
    for (wheel, contacts), load in zip(edges[0], loads):
        kept, parts = made[wheel]
        if load > 0.0:
            kept += contacts
            parts += [load / len(contacts)] * len(contacts)
    return made


def _edges(wheels: Sequence[Wheel]) -> Optional[_Edges]:
    """Return the edges on the plane of the first loaded contact; None if a wheel is not on it.

    Without an axle, each corner or contact is an edge. It is called in many steps, so vectors are
    written out.
    """
    first = next((contact for _, _, _, contacts in wheels for contact in contacts
                  if contact[LOAD] > 0.0 and contact[DISTANCE] <= 0.0), None)
    if first is None:
        return None
    nx, ny, nz = normal = first[NORMAL]
    along = cross(normal, (0.0, 0.0, 1.0) if abs(nz) < 0.9 else (0.0, 1.0, 0.0))
    tx, ty, tz = along = scale(along, 1.0 / norm(along))
    sx, sy, sz = cross(normal, along)
    height = dot(first[POINT], normal)
    edges: List[Tuple[int, List[ContactPoint]]] = []
    xs: List[float] = []
    ys: List[float] = []
    total = x_load = y_load = 0.0
    for n, (motion, axle, corners, contacts) in enumerate(wheels):
        if axle is not None:
            a, b, c = rotate(motion.orientation, axle)
            if abs(a * nx + b * ny + c * nz) > _TILTED:
                return None
            u, v, w = motion.position
        sides: Tuple[List[ContactPoint], List[ContactPoint]] = ([], [])
        sums = [0.0, 0.0, 0.0, 0.0]
        for contact in contacts:
            if contact[DISTANCE] >= NEAR:
                continue
            (x, y, z), (p, q, r), load = contact[POINT], contact[NORMAL], contact[LOAD]
            if (abs(x * nx + y * ny + z * nz - height) > _LEVEL
                    or p * nx + q * ny + r * nz < _PARALLEL):
                return None
            ahead, aside = x * tx + y * ty + z * tz, x * sx + y * sy + z * sz
            total, x_load, y_load = total + load, x_load + load * ahead, y_load + load * aside
            if axle is None:
                continue
            side = (x - u) * a + (y - v) * b + (z - w) * c > 0.0
            sides[side].append(contact)
            sums[side] += ahead
            sums[2 + side] += aside
        for contact in _touching_points(motion, corners, contacts) if axle is None else ():
            x, y, z = contact[POINT]
            edges.append((n, [contact]))
            xs.append(x * tx + y * ty + z * tz)
            ys.append(x * sx + y * sy + z * sz)
        for side, touching in enumerate(sides):
            if touching:
                edges.append((n, touching))
                xs.append(sums[side] / len(touching))
                ys.append(sums[2 + side] / len(touching))
    return edges, xs, ys, total, x_load, y_load


def _touching_points(motion: Motion, corners: Corners, contacts: Sequence[ContactPoint],
                     ) -> List[ContactPoint]:
    """Return a contact at each corner of a box on a floor; of another link, its contacts.

    Bullet drops corners that are above the floor by any amount, and loads the others by chance.
    """
    near = [contact for contact in contacts if contact[DISTANCE] < NEAR]
    # Contacts with one body follow each other.
    if not corners or not near or near[0][OTHER_BODY] != near[-1][OTHER_BODY]:
        return near
    first, (i, j, k), turn = near[0], motion.position, motion.orientation
    (a, b, c), (u, v, w) = rotate(conjugate(turn), first[NORMAL]), first[NORMAL]
    p, q, r = first[OTHER_POINT]
    highest = (p - i) * u + (q - j) * v + (r - k) * w + NEAR
    found: List[ContactPoint] = []
    for corner in corners:
        x, y, z = corner
        if x * a + y * b + z * c < highest:
            x, y, z = rotate(turn, corner)
            found.append((*first[:POINT], (i + x, j + y, k + z), *first[POINT + 1:]))
    return found or near


def _spread(xs: List[float], ys: List[float], total: float, x_load: float, y_load: float,
            ) -> Optional[List[float]]:
    """Return the load of each edge, linear in x and y, at least 0; None if there is no solution.

    Edges that would be pulled down carry nothing.
    """
    loads = _linear(xs, ys, total, x_load, y_load)
    if loads is None or min(loads) >= 0.0:
        return loads
    kept = [n for n, load in enumerate(loads) if load > 0.0]
    rest = _spread([xs[n] for n in kept], [ys[n] for n in kept], total, x_load, y_load)
    if rest is None:
        return None
    found = dict(zip(kept, rest))
    return [found.get(n, 0.0) for n in range(len(xs))]


def _linear(xs: List[float], ys: List[float], total: float, x_load: float, y_load: float,
            ) -> Optional[List[float]]:
    """Return the load of each edge, linear in x and y; None if there is no solution."""
    count = len(xs)
    x0 = y0 = xx = xy = yy = 0.0
    for x, y in zip(xs, ys):
        x0, y0, xx, xy, yy = x0 + x, y0 + y, xx + x * x, xy + x * y, yy + y * y
    x0, y0 = x0 / count, y0 / count
    xx, xy, yy = xx - count * x0 * x0, xy - count * x0 * y0, yy - count * y0 * y0
    x_load, y_load = x_load - total * x0, y_load - total * y0
    span, size = xx * yy - xy * xy, xx + yy
    if span > 1e-9 * size ** 2:
        p, q = (yy * x_load - xy * y_load) / span, (xx * y_load - xy * x_load) / span
    elif size > 0.0:   # all on one line, as the edges of two wheels on one axle
        p, q = x_load / size, y_load / size
        if hypot(xx * p + xy * q - x_load, xy * p + yy * q - y_load) > _ASIDE * total:
            return None
    else:
        return None
    mean = total / count - p * x0 - q * y0
    return [mean + p * x + q * y for x, y in zip(xs, ys)]
