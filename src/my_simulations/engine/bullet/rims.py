"""Divide wheels and rods into pieces, so that both ends have contacts.

Bullet finds one contact point per step between a lying cylinder and a floor, at one end or the
other (doc/dev/contacts.md, "Wheels"). So the cylinder of a wheel, or of a rod without joints,
consists of a thin disc at each end and a slightly smaller cylinder between; a capsule has a sphere
at each end. ODE finds contacts at both ends of either shape.
"""
from __future__ import annotations

from dataclasses import replace
from typing import List, Sequence

from ...description.model import Link
from ...description.shapes import Capsule, Collision, Cylinder, Geometry, Sphere
from ...geometry import Pose, compose, cross, dot, inverse, norm, rotate
from ..body_plan import TreeLink
from .rolling_contacts import axis_of

_DISC = 2e-3       # m, width of a disc
_SMALLER = 2e-4    # m, by which the radius of the middle piece is smaller
_NARROWEST = 8e-3  # m: a narrower wheel causes no visible yaw
_ALIGNED = 2e-3    # sine between the axes of joint and cylinder: files have 1.57 or 3.14159
_CENTRED = 1e-5    # m between the two axes
_ROD = 6.0         # whole length / radius: a shorter cylinder stands more often than it lies
_SHARE = 0.05      # of the radius of a thin rod, by which the middle piece is smaller
_INSET = 1e-4      # m, of the middle piece's faces: an upright rod stands on a disc only


def with_rims(node: TreeLink, collisions: Sequence[Collision], most: int) -> List[Collision]:
    """Return the collisions of a link of a tree, with cylinders of wheels in three pieces.

    `most`: largest number of collisions of the link.
    """
    found: List[Collision] = []
    for n, collision in enumerate(collisions):
        room = most - len(found) - (len(collisions) - n - 1)
        found += _pieces(collision) if room >= 3 and _is_wheel(node, collision) else [collision]
    return found


def with_ends(link: Link, most: int) -> List[Collision]:
    """Return the collisions of a link without joints, with those of rods in three pieces.

    `most`: largest number of collisions of the link.
    """
    if 3 * len(link.collisions) > most or axis_of(link) is None:
        return link.collisions
    return [piece for collision in link.collisions for piece in _rod(collision)]


def _rod(collision: Collision) -> List[Collision]:
    """Divide a long cylinder into two discs and a middle piece, a capsule with spheres."""
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
    """Replace a collision by ends at `z` and -`z`, m along its axis, and a middle piece."""
    return [replace(collision, geometry=end, pose=compose(collision.pose, Pose((0.0, 0.0, at))))
            for at in (-z, z)] + [replace(collision, geometry=between)]
