"""Set which links collide, with Bullet's collision groups and masks.

Two links collide if each one's group shares a bit with the other's mask. The groups hold a link's
collide_bitmask (SDF, surface/contact), shifted, and what it is made of; the masks what it meets.
Links made of boxes meet a large box below each plane, and all others meet the plane
(doc/dev/contacts.md, "Floors").
"""
from __future__ import annotations

from typing import NamedTuple

import pybullet

from ...description.model import Link
from ...description.shapes import Box, Empty

EVERYTHING = 0xffff
"""The default collide_bitmask of a surface."""

BOTH = 0
"""PyBullet's collisionFilterMode for this rule; by default one matching side is enough."""

_BOXES, _OTHERS = 1, 2
_SHIFT = 8


class Filter(NamedTuple):
    """Collision group and mask of a link."""

    group: int
    mask: int

    def set(self, uid: int, index: int) -> None:
        """Set group and mask of a link. Bullet then drops the contact points of the link."""
        pybullet.setCollisionFilterGroupMask(uid, index, self.group, self.mask)


NOTHING = Filter(0, 0)
"""Filter of a rigid link without collisions; with another Bullet keeps a pair for any two."""


def moving(link: Link, role: str = "") -> Filter:
    """Return the filter of a moving link; `role`: `Recipe.role` of its shape."""
    if role == "empty":
        return NOTHING
    bits = _bits(link) << _SHIFT
    are_boxes = all(isinstance(c.geometry, (Box, Empty)) for c in link.collisions)
    return Filter(bits | (_BOXES if are_boxes else _OTHERS), bits)


def static(link: Link, role: str = "") -> Filter:
    """Return the filter of a static link; `role`: `Recipe.role` of its shape."""
    if role == "empty":
        return NOTHING
    meets = {"plane": _OTHERS, "floor": _BOXES}.get(role, _BOXES | _OTHERS)
    return Filter(_bits(link) << _SHIFT, meets)


def _bits(link: Link) -> int:
    """The collide_bitmask of a link: PyBullet filters by link, so all bits of its collisions.

    A surface that collides without contact gives and takes no forces (Gazebo, ODEPhysics).
    """
    bits = 0
    for collision in link.collisions:
        if not collision.surface.collide_without_contact:
            bits |= collision.surface.collide_bitmask & EVERYTHING
    return bits if link.collisions else EVERYTHING


def ignore(one: int, other: int, index: int, other_index: int, ignored: bool) -> None:
    """Disable collisions of two links, or enable them again.

    Bullet keeps this when the bodies are removed, and gives their numbers to the next ones.
    """
    pybullet.setCollisionFilterPair(one, other, index, other_index, int(not ignored))
