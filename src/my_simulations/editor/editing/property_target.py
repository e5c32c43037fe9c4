"""Which object of the description a property belongs to, and its change as an operation."""
from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, List, Optional, Tuple

from ...appearance.gazebo_materials import BUILT_IN as MATERIALS
from ...description.compare import BUILT_IN
from ...description.model import Joint, Link, Model
from ...description.scoped_names import split_scoped
from ...description.shapes import Collision, Heightmap, ImageMap, Mesh, Visual
from ...description.surroundings import GuiCamera, SphericalCoordinates
from ...errors import CommandError
from ...resources.resolver import Resolver, ResourceNotFoundError
from ...simulator.operations import (
    EditJoint,
    EditLight,
    EditModel,
    Operation,
    SetPhysics,
    SetPoses,
    SetWorldField,
)
from ...simulator.scene import WORLD_FIELDS
from ...simulator.simulator import Simulator
from .inserts import check_meshes
from .property_path import with_value
from .sensor_edits import sensor_of, with_sensor_value

_NEW = {"gui_camera": GuiCamera, "spherical_coordinates": SphericalCoordinates}
_PART = re.compile(r"(collision|visual):(.+)\Z", re.DOTALL)


def property_change(world: Simulator, resolver: Resolver, target: str, path: str,
                    value: Any) -> Operation:
    """The operation that sets a property.

    Args:
        world: what it is for.
        resolver: finds files that a geometry names.
        target: "" for the world; a model or light; `model::link`, `model::joint`,
            `model::link::collision`, `model::link::visual` (`…::collision:NAME` and
            `…::visual:NAME` where both have one name).
        path: see `fields.with_value`.
        value: JSON.

    Raises CommandError, InputError.
    """
    if not target:
        return _of_world(world, path, value)
    if is_of_light(world, target):
        _refuse_name(path)
        return EditLight(target, with_value(world.lights.get(target), path, value))
    owner, rest = split_target(world, target)
    if sensor_of(rest):
        return _make_operation(owner, with_sensor_value(owner, rest, path, value, resolver))
    if not rest:
        return _of_model(owner, path, value)
    joint = next((one for one in owner.joints if one.name == rest), None)
    if joint is not None and all(link.name != rest for link in owner.links):
        return _of_joint(owner, joint, path, value)
    _refuse_name(path)
    links = _links_with(owner, rest, path, value, resolver)
    return _make_operation(owner, replace(owner, links=links))


def is_of_light(world: Simulator, name: str) -> bool:
    """Whether a name means a light; a model and a light of one name: it means the model.

    SDF before 1.7 allows such names (Gazebo behaviour).
    """
    return not world.models.has(name) and any(light.name == name for light in world.lights.all())


def split_target(world: Simulator, target: str) -> Tuple[Model, str]:
    """The model a scoped name begins with, and what follows. Raises UnknownEntityError."""
    model, rest = split_scoped(target, world.models.has)
    return (world.models.get(model), rest) if model else (world.models.get(target), "")


def _of_world(world: Simulator, path: str, value: Any) -> Operation:
    name, _, rest = path.partition(".")
    if name == "physics":
        return SetPhysics(with_value(replace(world.world, physics=world.physics.settings), path,
                                     value).physics, world.physics.gravity)
    if name == "gravity":
        holder = with_value(replace(world.world, gravity=world.physics.gravity), path, value)
        return SetPhysics(world.physics.settings, holder.gravity)
    if name not in WORLD_FIELDS:
        raise CommandError(f"unknown world property {path!r}; known: physics, gravity, "
                           + ", ".join(WORLD_FIELDS))
    holder = world.world
    if rest and getattr(holder, name) is None and name in _NEW:
        holder = replace(holder, **{name: _NEW[name]()})
    return SetWorldField(name, getattr(with_value(holder, path, value), name))


def _of_model(model: Model, path: str, value: Any) -> Operation:
    _refuse_name(path)
    if path == "pose":
        return SetPoses({model.name: with_value(model, "pose", value).pose})
    return _make_operation(model, with_value(model, path, value))


def _of_joint(owner: Model, joint: Joint, path: str, value: Any) -> Operation:
    _refuse_name(path)
    changed = with_value(joint, path, value)
    model = replace(owner, joints=[changed if one is joint else one for one in owner.joints])
    check_meshes(model)
    return EditJoint(owner.name, changed)


def _make_operation(old: Model, new: Model) -> Operation:
    meshes, _ = check_meshes(new)
    return EditModel(old.name, new, meshes)


def _links_with(owner: Model, rest: str, path: str, value: Any, resolver: Resolver) -> List[Link]:
    """The model's links, one of them with the property changed in it or in a part of it."""
    for n, link in enumerate(owner.links):
        if link.name == rest:
            changed = with_value(link, path, value)
        elif rest.startswith(link.name + "::"):
            found = _with_part(link, rest[len(link.name) + 2:], path, value, resolver)
            if found is None:
                continue
            changed = found
        else:
            continue
        return [*owner.links[:n], changed, *owner.links[n + 1:]]
    raise CommandError(f"model {owner.name!r} has no link, joint, collision or visual {rest!r}")


def _with_part(link: Link, name: str, path: str, value: Any, resolver: Resolver) -> Optional[Link]:
    exact = _PART.match(name)
    kind, name = (exact.group(1), exact.group(2)) if exact else ("", name)
    for n, collision in enumerate(link.collisions):
        if collision.name == name and kind != "visual":
            if not kind and path.split(".")[0] not in Collision.__dataclass_fields__:
                continue  # a visual of the same name is meant
            changed = _resolve_shape_file(with_value(collision, path, value), resolver)
            return replace(link, collisions=_replaced_at(link.collisions, n, changed))
    for n, visual in enumerate(link.visuals):
        if visual.name == name and kind != "collision":
            shown = _resolve_shape_file(_set_visual_property(visual, path, value), resolver)
            return replace(link, visuals=_replaced_at(link.visuals, n, shown))
    return None


def _replaced_at(items: List[Any], at: int, item: Any) -> List[Any]:
    return [*items[:at], item, *items[at + 1:]]


def _set_visual_property(visual: Visual, path: str, value: Any) -> Visual:
    """A visual with a property changed; `material.name` is the script's, as the page shows it."""
    if path != "material.name":
        return with_value(visual, path, value)
    changed = with_value(visual, "material.script_name", value)
    assert changed.material is not None
    paint = replace(changed.material, ambient=None, diffuse=None, specular=None, emissive=None)
    if value in MATERIALS and not paint.script_uris:
        paint = replace(paint, script_uris=[BUILT_IN])
    return replace(changed, material=paint)


def _resolve_shape_file(part: Any, resolver: Resolver) -> Any:
    """A collision or visual whose shape names a file, with the file found."""
    shape = part.geometry
    if not isinstance(shape, (Mesh, Heightmap, ImageMap)) or not shape.uri:
        return part
    try:
        path = resolver.resolve(shape.uri)
    except ResourceNotFoundError as missing:
        if shape.path:  # relative to a file that is not known any more
            return part
        raise CommandError(str(missing)) from missing
    return replace(part, geometry=replace(shape, path=path))


def _refuse_name(path: str) -> None:
    if path == "name":
        raise CommandError("only models and lights can be renamed, by the operation `rename`")
