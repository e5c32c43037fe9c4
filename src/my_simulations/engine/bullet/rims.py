"""Wheels that stand on both their edges.

Bullet finds one point a step where a lying cylinder meets a floor, at one edge or the other: a base
on wide wheels under equal efforts yawed by 13 degrees in 1 s. So the cylinder of a wheel is built
from a thin disc at each end and a body between them that is a little smaller.
"""
from __future__ import annotations

from dataclasses import replace
from typing import List, Sequence

from ...description.shapes import Collision, Cylinder
from ...geometry import Pose, compose, cross, dot, inverse, norm, rotate
from ..body_plan import TreeLink

_DISC = 2e-3       # m, its width
_SMALLER = 2e-4    # m, the radius of what lies between
_NARROWEST = 8e-3  # m: a narrower wheel yaws by less than one sees
_ALIGNED = 2e-3      # of the joint's axis across that of the cylinder: files say 1.57, or 3.14159 / 2
_CENTRED = 1e-5    # m between the two


def with_rims(node: TreeLink, collisions: Sequence[Collision], most: int) -> List[Collision]:
    """The collisions of a link of a tree; of a wheel its cylinder in three pieces.

    `most`: as many collisions the link may have.
    """
    found: List[Collision] = []
    for n, collision in enumerate(collisions):
        room = most - len(found) - (len(collisions) - n - 1)
        found += _pieces(collision) if room >= 3 and _is_wheel(node, collision) else [collision]
    return found


def _is_wheel(node: TreeLink, collision: Collision) -> bool:
    """Whether a collision is a cylinder that turns about its own axis."""
    shape = collision.geometry
    if (not isinstance(shape, Cylinder) or node.kind != "revolute" or node.axis is None
            or shape.length < _NARROWEST or shape.radius <= 10 * _SMALLER):
        return False
    at = compose(inverse(node.link_from_frame), collision.pose)
    axis = rotate(at.orientation, (0.0, 0.0, 1.0))
    along = dot(at.position, node.axis)
    x, y, z = (p - along * a for p, a in zip(at.position, node.axis))
    return norm(cross(axis, node.axis)) < _ALIGNED and norm((x, y, z)) < _CENTRED


def _pieces(collision: Collision) -> List[Collision]:
    shape = collision.geometry
    assert isinstance(shape, Cylinder)
    ends = (shape.length - _DISC) / 2.0
    discs = [replace(collision, geometry=replace(shape, length=_DISC),
                     pose=compose(collision.pose, Pose((0.0, 0.0, z)))) for z in (-ends, ends)]
    return discs + [replace(collision, geometry=replace(shape, radius=shape.radius - _SMALLER))]
