"""Divide links whose collisions differ in friction: PyBullet has one coefficient per link.

A caster that was lumped into a robot's base (fixed joints merge links in a URDF) has a friction of
its own in Gazebo. So where a link of a tree has collisions with unlike friction, those with another
friction than the first become a piece: a link of almost no mass that is fixed to it.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Dict, List, Tuple

from ..description.link_surface import coefficient
from ..description.model import Link, Model
from ..description.self_collision import self_collides
from .body_plan import MAX_TREE_LINKS, NO_LINK, BodyPlan, TreeLink, depth_first

Carried = Tuple[int, ...]


def in_pieces(plan: BodyPlan, model: Model) -> BodyPlan:
    """The plan of a tree, a piece for each further friction of a link.

    Where links of a model collide with each other they stay whole: a piece would meet its
    neighbours. So do all where there would be more links than Bullet can have.
    """
    if self_collides(model):
        return plan
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


def differs_in_friction(link: Link, model: Model) -> bool:
    """Whether a link is divided, so that it needs a tree even without joints."""
    return len(by_friction(link)) > 1 and not self_collides(model)


def by_friction(link: Link) -> List[Carried]:
    """The positions of the collisions of a link, those with the same friction together."""
    groups: Dict[float, List[int]] = {}
    for n, collision in enumerate(link.collisions):
        groups.setdefault(coefficient(collision.surface), []).append(n)
    return [tuple(group) for group in groups.values()]


def carried_by(node: TreeLink, model: Model) -> Link:
    """The link of a tree link, with the collisions that it carries; of a piece, its owner's."""
    number = node.index if node.of is None else node.of
    link = Link("") if number == NO_LINK else model.links[number]
    if node.carried is None:
        return link
    return replace(link, collisions=[link.collisions[n] for n in node.carried])
