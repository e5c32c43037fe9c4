"""Flattens nested models into one model with scoped link names.

In Gazebo a nested link is called `outer::inner::link`, and `inner::link` inside the outer model.
The engine supports flat models only.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, List, Optional

from ..geometry import compose
from .model import WORLD, Joint, JointAxis, Link, Model


def flatten_model(model: Model) -> Model:
    """Merge nested models into the outer one; all link poses are in its frame.

    Its `guide` is the original model, for `unflatten_model`.
    """
    if not model.models:
        return model
    links: List[Link] = list(model.links)
    joints: List[Joint] = list(model.joints)
    for nested in model.models:
        inner = flatten_model(nested)
        links += [_move_link(link, nested, model) for link in inner.links]
        joints += [_scope_joint(joint, nested.name) for joint in inner.joints]
    return replace(model, links=links, joints=joints, models=[], guide=model)


def _move_link(link: Link, nested: Model, outer: Model) -> Link:
    """The link of a nested model; static ones inside a dynamic model become kinematic links.

    What it says of self-collision is what its own model does (Gazebo, Link::Load).
    """
    own = link.self_collide
    if own is None and nested.self_collide != outer.self_collide:
        own = nested.self_collide
    return replace(
        link, name=f"{nested.name}::{link.name}", pose=compose(nested.pose, link.pose),
        kinematic=link.kinematic or (nested.static and not outer.static), self_collide=own)


def _scope_joint(joint: Joint, scope: str) -> Joint:
    return rename_joint(joint, lambda name: f"{scope}::{name}")


def rename_joint(joint: Joint, new: Callable[[str], str]) -> Joint:
    """Rename a joint and the links and joints that it refers to."""
    def link(name: str) -> str:
        return new(name) if name and name != WORLD else name

    def axis(one: Optional[JointAxis]) -> Optional[JointAxis]:
        if one is None or one.mimic is None:
            return one
        return replace(one, mimic=replace(one.mimic, joint=new(one.mimic.joint)))

    return replace(joint, name=new(joint.name), parent=link(joint.parent), child=link(joint.child),
                   gearbox_reference=link(joint.gearbox_reference), axis=axis(joint.axis),
                   axis2=axis(joint.axis2))
