"""Models with a part more, less or under another name, as the model editor makes them.

All functions take a flattened model and return a copy. `validate` finds faults of the result as a
whole.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Collection, Dict, List, Optional, Union

from ...description.flatten import flatten_model
from ...description.model import WORLD, Joint, JointAxis, Link, Model
from ...description.shapes import Collision, Geometry, Material, Visual
from ...description.unflatten import unflatten_model
from ...errors import CommandError
from ...geometry import Vec3

SCOPE = "::"
_AXES: Dict[str, List[Vec3]] = {
    "revolute": [(0.0, 0.0, 1.0)], "continuous": [(0.0, 0.0, 1.0)],
    "prismatic": [(0.0, 0.0, 1.0)], "screw": [(0.0, 0.0, 1.0)],
    "revolute2": [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0)],
    "universal": [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)],
    "gearbox": [(0.0, 0.0, 1.0), (0.0, 0.0, 1.0)],
    "fixed": [], "ball": [],
}
"""First axes of a new joint, by its type."""


def numbered_name(wanted: str, taken: Collection[str]) -> str:
    """`wanted`_0, `wanted`_1, …: the first that is free."""
    number = 0
    while f"{wanted}_{number}" in taken:
        number += 1
    return f"{wanted}_{number}"


def free_name(wanted: str, taken: Collection[str]) -> str:
    """`wanted`, or with the first free number: name_0, name_1, … (Gazebo behaviour)."""
    return wanted if wanted not in taken else numbered_name(wanted, taken)


class FreeNames:
    """Gives out free names, each once, without a search from 0 for each of them."""

    def __init__(self, taken: Collection[str]) -> None:
        self._taken = set(taken)
        self._next: Dict[str, int] = {}

    def take(self, wanted: str) -> str:
        """Return the same name as `free_name`, which is taken from now on."""
        name, number = wanted, self._next.get(wanted, 0)
        while name in self._taken:
            name, number = f"{wanted}_{number}", number + 1
        self._next[wanted] = number
        self._taken.add(name)
        return name


def part_names(model: Model) -> List[str]:
    """Names that links, joints and nested models share."""
    return [*(link.name for link in model.links), *(joint.name for joint in model.joints),
            *nested_names(model)]


def nested_names(model: Model) -> List[str]:
    """Nested models of the outermost level."""
    return list(dict.fromkeys(link.name.partition(SCOPE)[0] for link in model.links
                              if SCOPE in link.name))


def with_shape(link: Link, geometry: Geometry, material: Optional[Material],
           part: str = "both") -> Link:
    """A link with one more shape to collide with, to look at, or both."""
    collisions, visuals = list(link.collisions), list(link.visuals)
    if part in ("both", "collision"):
        collisions.append(Collision(_free("collision", collisions), geometry))
    if part in ("both", "visual"):
        visuals.append(Visual(_free("visual", visuals), geometry, material=material))
    return replace(link, collisions=collisions, visuals=visuals)


def _free(wanted: str, parts: Union[List[Collision], List[Visual]]) -> str:
    return free_name(wanted, [part.name for part in parts])


def with_joint(model: Model, joint: Joint) -> Model:
    """The model with a joint more; one without a name is called after its child."""
    name = joint.name
    if not name:
        name = f"{joint.child}_joint".replace(SCOPE, "_")
        name = free_name(name, part_names(model))
    return replace(model, joints=[*model.joints, complete_joint(model, replace(joint, name=name))])


def with_changed_joint(model: Model, old: Joint, new: Joint) -> Model:
    """Return the model with a joint replaced; references follow a new name of the joint."""
    new = complete_joint(model, new)
    joints = [new if one is old else one for one in model.joints]
    return _rename_mimicked_joints(replace(model, joints=joints), old.name, new.name)


def complete_joint(model: Model, joint: Joint) -> Joint:
    """The joint with as many axes as its type has, and a gearbox with its reference.

    Raises CommandError.
    """
    axes = _AXES.get(joint.type)
    if axes is None:
        raise CommandError(f"unknown joint type {joint.type!r}; known: {', '.join(_AXES)}")
    if joint.parent == joint.child:
        raise CommandError(f"a joint cannot connect {joint.parent!r} to itself")
    axis, axis2 = (
        (given or JointAxis(axes[n])) if n < len(axes) else None
        for n, given in enumerate((joint.axis, joint.axis2)))
    reference = joint.gearbox_reference
    if joint.type == "gearbox" and not reference:
        reference = _reference(model, joint)
    return replace(joint, axis=axis, axis2=axis2, gearbox_reference=reference)


def _reference(model: Model, gearbox: Joint) -> str:
    """The link in which both ends of a gearbox turn (SDF spec, gearbox_reference_body)."""
    def holders(link: str) -> List[str]:
        return [one.parent for one in model.joints if one.child == link and one.axis is not None]

    for parent in holders(gearbox.parent):
        if parent in holders(gearbox.child):
            return parent
    raise CommandError("a gearbox joint connects two links that turn in the same third link: first "
                       f"connect {gearbox.parent} and {gearbox.child} to it by revolute joints")


def with_nested(model: Model, nested: Model) -> Model:
    """The model with another one in it, at its pose in the model's frame."""
    whole = unflatten_model(model)
    models = [*whole.models, replace(nested, uri="")]
    return flatten_model(replace(whole, models=models, guide=None))


def without_part(model: Model, rest: str) -> Model:
    """The model without a link, joint, nested model, collision or visual.

    Joints of a link that goes, go with it.

    Args:
        model: the model.
        rest: `LINK`, `JOINT`, `NESTED`, `LINK::collision:NAME`, `LINK::visual:NAME`.

    Raises CommandError.
    """
    if any(link.name == rest for link in model.links):
        return _without_links(model, [rest])
    if any(joint.name == rest for joint in model.joints):
        return replace(model, joints=[one for one in model.joints if one.name != rest])
    inner = [link.name for link in model.links if link.name.startswith(rest + SCOPE)]
    if inner:
        return _without_links(model, inner)
    link_name, _, part = rest.rpartition(SCOPE)
    kind, _, name = part.partition(":")
    for n, link in enumerate(model.links):
        if link.name == link_name:
            changed = _without_shape(link, kind, name)
            return replace(model, links=[*model.links[:n], changed, *model.links[n + 1:]])
    raise CommandError(f"model {model.name!r} has no part {rest!r}")


def _without_links(model: Model, names: List[str]) -> Model:
    links = [link for link in model.links if link.name not in names]
    if not links:
        raise CommandError(f"{names[0]} is the only link of {model.name}; delete the model instead")
    joints = [one for one in model.joints if one.parent not in names and one.child not in names]
    canonical = "" if model.canonical_link in names else model.canonical_link
    return replace(model, links=links, joints=joints, canonical_link=canonical)


def _without_shape(link: Link, kind: str, name: str) -> Link:
    shapes: Dict[str, Any] = {"collision": link.collisions, "visual": link.visuals}
    if not any(one.name == name for one in shapes.get(kind, [])):
        raise CommandError(f"link {link.name!r} has no {kind} {name!r}")
    kept = [one for one in shapes[kind] if one.name != name]
    return (replace(link, collisions=kept) if kind == "collision"
            else replace(link, visuals=kept))


def with_link_renamed(model: Model, old: str, to: str) -> Model:
    """The model with a link under another name; joints that refer to it follow.

    Raises CommandError.
    """
    if not to or SCOPE in to or to == WORLD:
        raise CommandError(f"{to!r} is not a valid name for a link")
    if to in part_names(model):
        raise CommandError(f"model {model.name!r} has a part {to!r} already")
    if SCOPE in old:
        raise CommandError(f"{old} belongs to a nested model, whose names stay")
    links = [replace(link, name=to) if link.name == old else link for link in model.links]
    joints = [replace(one, parent=_rename(one.parent, old, to), child=_rename(one.child, old, to),
                      gearbox_reference=_rename(one.gearbox_reference, old, to))
              for one in model.joints]
    return replace(model, links=links, joints=joints,
                   canonical_link=_rename(model.canonical_link, old, to))


def _rename(name: str, old: str, to: str) -> str:
    return to if name == old else name


def _rename_mimicked_joints(model: Model, old: str, to: str) -> Model:
    """Mimicked joints under their new name."""
    if old == to:
        return model

    def axis(one: Optional[JointAxis]) -> Optional[JointAxis]:
        if one is None or one.mimic is None or one.mimic.joint != old:
            return one
        return replace(one, mimic=replace(one.mimic, joint=to))

    return replace(model, joints=[replace(joint, axis=axis(joint.axis), axis2=axis(joint.axis2))
                                  for joint in model.joints])
