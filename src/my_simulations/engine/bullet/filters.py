"""Which surfaces meet: SDF's collide_bitmask and collide_without_contact.

A pair collides when its masks have a bit in common (Gazebo, ODEPhysics::Collide); a surface that
collides without contact gives and takes no forces. PyBullet filters by link, so a link whose
collisions differ takes all bits of its collisions. The pairs are told one by one, because what else
collides is a matter of groups that others set.
"""
from __future__ import annotations

from typing import Dict, Tuple

import pybullet

from ...description.model import Link
from .bodies import Body, Part

EVERY_BIT = 65535

Node = Tuple[int, int]  # body uid, link index


class Filters:
    """Keeps pairs apart that must not meet."""

    def __init__(self) -> None:
        self._masks: Dict[Node, int] = {}
        self._special = 0

    def add(self, body: Body, part: Part, link: Link) -> None:
        """Know a link, and part it from those it must not meet."""
        mask = _mask(link)
        for uid in body.uids:
            node = (uid, part.index)
            if mask != EVERY_BIT or self._special:
                for other, its_mask in self._masks.items():
                    if other[0] != uid and not mask & its_mask:
                        pybullet.setCollisionFilterPair(uid, other[0], part.index, other[1], 0)
            self._masks[node] = mask
            self._special += mask != EVERY_BIT

    def forget(self, body: Body) -> None:
        """A body is gone."""
        gone = set(body.uids)
        for node in [node for node in self._masks if node[0] in gone]:
            self._special -= self._masks.pop(node) != EVERY_BIT

    def clear(self) -> None:
        """All bodies are gone."""
        self._masks.clear()
        self._special = 0


def _mask(link: Link) -> int:
    mask = 0
    for collision in link.collisions:
        if not collision.surface.collide_without_contact:
            mask |= collision.surface.collide_bitmask & EVERY_BIT
    return mask if link.collisions else EVERY_BIT
