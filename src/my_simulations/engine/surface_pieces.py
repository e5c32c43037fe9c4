"""Divide links whose collisions differ in their surfaces: PyBullet has one surface per link.

A caster that was lumped into a robot's base (fixed joints merge links in a URDF) has a friction of
its own in Gazebo. So if a link of a tree has collisions with unlike friction, those with another
friction than the first become a piece: a link of almost no mass that is fixed to it. The link of a
static body is divided into several bodies.
"""
from __future__ import annotations

from dataclasses import astuple, replace
from typing import Dict, Hashable, Iterable, List, Tuple

from ..description.link_surface import friction_coefficient
from ..description.model import Link, Model
from ..description.shapes import Collision
from .body_plan import MAX_TREE_LINKS, NO_LINK, BodyPlan, TreeLink, depth_first

Carried = Tuple[int, ...]


def in_pieces(plan: BodyPlan, model: Model) -> BodyPlan:
    """Return the plan of a tree, with a piece for each further friction of a link.

    Links stay whole if there would be more of them than Bullet can have.
    """
    links = list(plan.links)
    for n, node in enumerate(plan.links):
        groups = [] if node.index == NO_LINK else by_friction(model.links[node.index])
        if len(groups) > 1:
            links[n] = replace(node, carried=groups[0])
            links += [TreeLink(NO_LINK, n, link_from_frame=node.link_from_frame, carried=group,
                               of=node.index) for group in groups[1:]]
    if len(links) == len(plan.links) or len(links) > MAX_TREE_LINKS:
        return plan
    return replace(plan, links=depth_first(links))


def by_friction(link: Link) -> List[Carried]:
    """Return the positions of the collisions of a link, those with the same friction together."""
    return _alike(friction_coefficient(collision.surface) for collision in link.collisions)


def by_surface(link: Link) -> List[Link]:
    """Return a link for each group of its collisions that have the same surface, with these.

    A link without collisions stays as it is.
    """
    return [_with(link, group) for group in _alike(map(_surface, link.collisions))] or [link]


def _surface(collision: Collision) -> Hashable:
    """Return the surface of a collision, in the axes of the link."""
    surface = collision.surface
    return astuple(surface), collision.pose.orientation if any(surface.fdir1) else None


def _alike(keys: Iterable[Hashable]) -> List[Carried]:
    """Return the positions of equal keys together."""
    groups: Dict[Hashable, List[int]] = {}
    for n, key in enumerate(keys):
        groups.setdefault(key, []).append(n)
    return [tuple(group) for group in groups.values()]


def _with(link: Link, group: Carried) -> Link:
    return replace(link, collisions=[link.collisions[n] for n in group])


def carried_by(node: TreeLink, model: Model) -> Link:
    """The link of a tree link, with the collisions that it carries; of a piece, its owner's."""
    number = node.index if node.of is None else node.of
    link = Link("") if number == NO_LINK else model.links[number]
    return link if node.carried is None else _with(link, node.carried)
