"""Restores nested models from scoped link names: the inverse of `flatten`."""
from __future__ import annotations

from dataclasses import replace
from typing import Dict, List, Optional, Sequence

from ..geometry import IDENTITY, Pose, compose, inverse
from .flatten import flatten_model, rename_joint
from .model import WORLD, Joint, Link, Model
from .scoped_names import SCOPE


def unflatten_model(flat: Model) -> Model:
    """Restore a nested model for every scope in the link names of a flat model.

    Args:
        flat: a result of `flatten_model`, possibly edited. Links and joints are taken from it;
            poses, plugins and kept XML of nested models from its `guide`. Without a guide, nested
            models are at the origin of the outer model.
    """
    guide = flat.guide or Model("")
    if not guide.models and not any(SCOPE in link.name for link in flat.links):
        return flat
    whole = _gather_parts(flat, flat.links, flat.joints, guide, IDENTITY)
    return replace(whole, guide=None)


def _gather_parts(model: Model, links: Sequence[Link], joints: Sequence[Joint], guide: Model,
                  above: Pose) -> Model:
    """Add these links and joints to `model`, with names relative to it.

    `above`: pose of its frame in the outermost model, whose frame the link poses are in.
    """
    known = {link.name: link for link in guide.links}
    own: List[Link] = []
    inner: Dict[str, List[Link]] = {}
    for link in links:
        head, scope, rest = link.name.partition(SCOPE)
        if scope:
            inner.setdefault(head, []).append(replace(link, name=rest))
        else:
            before = known.get(link.name)
            kinematic = before.kinematic if guide.static and before else link.kinematic
            collides = link.self_collide
            if before and before.self_collide is None and collides == guide.self_collide:
                collides = None
            own.append(replace(link, pose=_pose(link, before, above), kinematic=kinematic,
                               self_collide=collides))
    theirs: Dict[str, List[Joint]] = {}
    ours: List[Joint] = []
    for joint in joints:
        head = joint.name.partition(SCOPE)[0]
        if head in inner and _lies_in(joint, head):
            theirs.setdefault(head, []).append(_seen_from_inside(joint, head))
        else:
            ours.append(joint)
    guides = {nested.name: nested for nested in guide.models}
    models = []
    for name, some in inner.items():
        nested = guides.get(name, Model(name))
        models.append(_gather_parts(nested, some, theirs.get(name, []), nested,
                                    compose(above, nested.pose)))
    models += [nested for nested in guide.models
               if nested.name not in inner and not flatten_model(nested).links]
    return replace(model, links=own, joints=ours, models=models)


def _pose(link: Link, known: Optional[Link], above: Pose) -> Pose:
    if above == IDENTITY:
        return link.pose
    if known is not None and compose(above, known.pose) == link.pose:
        return known.pose  # keep the exact digits
    return compose(inverse(above), link.pose)


def _lies_in(joint: Joint, scope: str) -> bool:
    return all(name.startswith(scope + SCOPE) or name == WORLD
               for name in (joint.parent, joint.child)) and SCOPE in joint.name


def _seen_from_inside(joint: Joint, scope: str) -> Joint:
    inside = scope + SCOPE
    return rename_joint(joint, lambda name: name[len(inside):] if name.startswith(inside) else name)
