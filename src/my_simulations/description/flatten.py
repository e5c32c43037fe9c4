"""A model with nested models as one model with scoped link names.

Gazebo names a nested link `outer::inner::link`; inside the outer model it is `inner::link`. The
engine knows flat models only.
"""
from __future__ import annotations

from dataclasses import replace
from typing import List

from ..geometry import compose
from .model import WORLD, Joint, Link, Model


def flattened(model: Model) -> Model:
    """The same model without nested ones; poses of their links in the outer model's frame.

    Its `guide` is the model itself, for the way back.
    """
    if not model.models:
        return model
    links: List[Link] = list(model.links)
    joints: List[Joint] = list(model.joints)
    for nested in model.models:
        inner = flattened(nested)
        links += [_moved(link, nested, model.static) for link in inner.links]
        joints += [_scoped(joint, nested.name) for joint in inner.joints]
    return replace(model, links=links, joints=joints, models=[], guide=model)


def _moved(link: Link, nested: Model, static: bool) -> Link:
    """The link of a nested model; a static one in one that moves stands as kinematic links do."""
    return replace(
        link, name=f"{nested.name}::{link.name}", pose=compose(nested.pose, link.pose),
        kinematic=link.kinematic or (nested.static and not static))


def _scoped(joint: Joint, scope: str) -> Joint:
    parent = joint.parent if joint.parent == WORLD else f"{scope}::{joint.parent}"
    return replace(joint, name=f"{scope}::{joint.name}", parent=parent,
                   child=f"{scope}::{joint.child}")
