"""How the weight of a base is shared by the edges of its wheels, where they slide.

Four wide wheels stand on eight edges of a level floor. How much each carries is not determined for
rigid bodies, and the solver keeps whichever solution it began with: the inner edges on the right
and the outer ones on the left, say, which turned a Husky at 1.08 rad/s. Real wheels, and contacts
of Gazebo with their `kp`, are a little soft: where all give way alike, the load is linear in where
an edge is. It has the same sum and the same moments. With it, and Coulomb's law at each edge, the
Husky turns at 1.36 rad/s.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Optional, Sequence, Tuple

from ...description.model import Link
from ...description.shapes import Cylinder
from ...geometry import Vec3, conjugate, cross, dot, norm, rotate, scale
from .bodies import Part
from .link_states import motion

Contact = Tuple[Any, ...]  # as PyBullet tells them

_NEAR = 1e-4   # m: an edge nearer to the floor than this carries its share
_LYING = 0.02  # of the axle along the normal of the floor: a wheel that is tilted has one edge
_LEVEL = 1e-3  # m, and of the normal: floors that differ by more are several


@dataclass
class _Edge:
    """Contacts of one edge of a wheel: their place in the plane of the floor, and their load."""

    wheel: int
    contacts: List[Contact]
    x: float = 0.0
    y: float = 0.0
    load: float = 0.0


def axle_of(part: Part, link: Link) -> Optional[Vec3]:
    """The axis of the only collision of a link, a cylinder, in PyBullet's frame; else None."""
    if len(link.collisions) != 1 or not isinstance(link.collisions[0].geometry, Cylinder):
        return None
    along = rotate(link.collisions[0].pose.orientation, (0.0, 0.0, 1.0))
    return rotate(conjugate(part.link_from_com.orientation), along)


def carrying(contacts: Sequence[Contact]) -> List[Contact]:
    """Those of a link's contacts that carry something."""
    return [contact for contact in contacts if contact[9] > 0.0 and contact[8] <= 0.0]


def shared(uid: int, wheels: Sequence[Tuple[int, Vec3, Sequence[Contact]]]) -> List[List[Contact]]:
    """The contacts that carry each wheel of a body, with the loads of edges that give way alike.

    Args:
        wheels: of each PyBullet's index, the axle in its frame, and all its contacts.

    Where the wheels do not stand on one plane, or an edge would be pulled down, loads stay.
    """
    found = [carrying(contacts) for _, _, contacts in wheels]
    normal = next((contact[7] for contacts in found for contact in contacts), None)
    if normal is None:
        return found
    edges: List[_Edge] = []
    for n, (index, axle, contacts) in enumerate(wheels):
        centre, turn, _, _ = motion(uid, index)
        axis = rotate(turn, axle)
        if abs(dot(axis, normal)) > _LYING:
            return found
        edges += _edges(n, centre, axis, contacts)
    if not _spread(edges, normal):
        return found
    made: List[List[Contact]] = [[] for _ in wheels]
    for edge in edges:
        part = edge.load / len(edge.contacts)
        made[edge.wheel] += [(*contact[:9], part, *contact[10:]) for contact in edge.contacts]
    return made


def _edges(wheel: int, centre: Vec3, axis: Vec3, contacts: Sequence[Contact]) -> List[_Edge]:
    sides: Tuple[List[Contact], List[Contact]] = ([], [])
    for contact in contacts:
        if contact[8] < _NEAR:
            (x, y, z), (u, v, w), (a, b, c) = contact[5], centre, axis
            sides[(x - u) * a + (y - v) * b + (z - w) * c > 0.0].append(contact)
    return [_Edge(wheel, side) for side in sides if side]


def _spread(edges: List[_Edge], normal: Vec3) -> bool:
    """Give each edge its load; False where that cannot be said."""
    along = cross(normal, (0.0, 0.0, 1.0) if abs(normal[2]) < 0.9 else (0.0, 1.0, 0.0))
    along = scale(along, 1.0 / norm(along))
    aside, height = cross(normal, along), dot(edges[0].contacts[0][5], normal)
    total = x_load = y_load = 0.0
    for edge in edges:
        for contact in edge.contacts:
            at, load = contact[5], contact[9]
            if (abs(dot(at, normal) - height) > _LEVEL
                    or dot(contact[7], normal) < 1.0 - _LEVEL):
                return False
            x, y = dot(at, along), dot(at, aside)
            edge.x, edge.y = edge.x + x, edge.y + y
            total, x_load, y_load = total + load, x_load + load * x, y_load + load * y
        edge.x, edge.y = edge.x / len(edge.contacts), edge.y / len(edge.contacts)
    count = len(edges)
    x0, y0 = sum(edge.x for edge in edges) / count, sum(edge.y for edge in edges) / count
    xx = xy = yy = 0.0
    for edge in edges:
        edge.x, edge.y = edge.x - x0, edge.y - y0
        xx, xy, yy = xx + edge.x ** 2, xy + edge.x * edge.y, yy + edge.y ** 2
    x_load, y_load = x_load - total * x0, y_load - total * y0
    span = xx * yy - xy * xy
    if span <= 1e-9 * (xx + yy) ** 2:
        return False
    p, q = (yy * x_load - xy * y_load) / span, (xx * y_load - xy * x_load) / span
    for edge in edges:
        edge.load = total / count + p * edge.x + q * edge.y
    return all(edge.load > 0.0 for edge in edges)
