"""Wheels that stand on both their edges, and rods that lie on both their ends.

Bullet finds one point a step where a lying cylinder meets a floor, at one edge or the other: a base
on wide wheels under equal efforts yawed by 13 degrees in 1 s. So the cylinder of a wheel is built
from a thin disc at each end and a body between them that is a little smaller.

A rod without joints lay on one end and the other in turns, for ever: put down from 1 mm it sank 4
to 6 mm into the floor while overlaps were parted without velocity. So it is built alike, a capsule
with balls at its ends. ODE finds both ends of either.
"""
from __future__ import annotations

from dataclasses import replace
from typing import List, Sequence

from ...description.model import Link
from ...description.shapes import Capsule, Collision, Cylinder, Geometry, Sphere
from ...geometry import Pose, compose, cross, dot, inverse, norm, rotate
from ..body_plan import TreeLink
from .rolling_contacts import axis_of

_DISC = 2e-3       # m, its width
_SMALLER = 2e-4    # m, the radius of what lies between
_NARROWEST = 8e-3  # m: a narrower wheel yaws by less than one sees
_ALIGNED = 2e-3    # of the joint's axis across that of the cylinder: files say 1.57 or 3.14159
_CENTRED = 1e-5    # m between the two
_ROD = 6.0         # whole length by radius: a shorter one stands more often than it lies
_SHARE = 0.05      # of the radius of a thin rod, by which what lies between is smaller
_INSET = 1e-4      # m, of its faces: a rod that stands does so on a disc alone


def with_rims(node: TreeLink, collisions: Sequence[Collision], most: int) -> List[Collision]:
    """The collisions of a link of a tree; of a wheel its cylinder in three pieces.

    `most`: as many collisions the link may have.
    """
    found: List[Collision] = []
    for n, collision in enumerate(collisions):
        room = most - len(found) - (len(collisions) - n - 1)
        found += _pieces(collision) if room >= 3 and _is_wheel(node, collision) else [collision]
    return found


def with_ends(link: Link, most: int) -> List[Collision]:
    """The collisions of a link without joints; of a rod its cylinders and capsules in pieces.

    `most`: as many collisions the link may have.
    """
    if 3 * len(link.collisions) > most or axis_of(link) is None:
        return link.collisions
    return [piece for collision in link.collisions for piece in _rod(collision)]


def _rod(collision: Collision) -> List[Collision]:
    """A long cylinder as two discs and what lies between, a long capsule as two balls and that."""
    shape = collision.geometry
    if not isinstance(shape, (Capsule, Cylinder)):
        return [collision]
    whole = shape.length + (2.0 * shape.radius if isinstance(shape, Capsule) else 0.0)
    if whole < _ROD * shape.radius:
        return [collision]
    radius = shape.radius - min(_SMALLER, _SHARE * shape.radius)
    if isinstance(shape, Capsule):
        return _with(collision, Sphere(shape.radius), shape.length / 2.0,
                     replace(shape, radius=radius))
    width = min(_DISC, _SHARE * shape.length)
    return _with(collision, replace(shape, length=width), (shape.length - width) / 2.0,
                 replace(shape, radius=radius,
                         length=shape.length - 2.0 * min(_INSET, width / 4.0)))


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
    return _with(collision, replace(shape, length=_DISC), (shape.length - _DISC) / 2.0,
                 replace(shape, radius=shape.radius - _SMALLER))


def _with(collision: Collision, end: Geometry, z: float, between: Geometry) -> List[Collision]:
    """A collision as an end at `z` and one at -`z`, m along its axis, and what lies between."""
    return [replace(collision, geometry=end, pose=compose(collision.pose, Pose((0.0, 0.0, at))))
            for at in (-z, z)] + [replace(collision, geometry=between)]
