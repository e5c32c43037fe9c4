"""What can be put into the world: Gazebo's simple shapes, and what a text or a file describes."""
from __future__ import annotations

import os
import re
from dataclasses import replace
from typing import Collection, Dict, List, Optional, Sequence, Tuple, Union

from ...appearance.palette import SHAPE_COLORS
from ...description.flatten import flatten_model
from ...description.light import Light
from ...description.model import Inertial, Link, Model
from ...description.model_group import group_of, with_group
from ...description.shapes import (
    Box,
    Collision,
    Cylinder,
    Geometry,
    Material,
    MeshTable,
    Sphere,
    Visual,
)
from ...description.validate import validate
from ...description.world import World
from ...errors import CommandError, InputError, Issue, errors_of
from ...formats.mesh.loading import collision_meshes
from ...formats.reading import parse_world, read_entity, read_file
from ...geometry import Pose, Vec3
from ...resources.resolver import Resolver, ResourceNotFoundError
from ...simulator.simulator import Simulator
from .model_parts import free_name

Entity = Union[Model, Light]

_NAMED = re.compile(r"<(model|light|robot)\s[^>]*?\bname\s*=\s*(['\"])(.{1,100}?)\2")

_SHAPES: Dict[str, Tuple[Geometry, Vec3]] = {
    "box": (Box((1.0, 1.0, 1.0)), (1 / 6, 1 / 6, 1 / 6)),
    "sphere": (Sphere(0.5), (0.1, 0.1, 0.1)),
    "cylinder": (Cylinder(0.5, 1.0), (7 / 48, 7 / 48, 0.125)),
}


def simple_shape(shape: str) -> Model:
    """Gazebo's unit box, sphere or cylinder of 1 kg in a color, standing on the ground."""
    geometry, (ixx, iyy, izz) = _SHAPES[shape]
    link = Link("link", inertial=Inertial(1.0, ixx=ixx, iyy=iyy, izz=izz),
                collisions=[Collision("collision", geometry)],
                visuals=[Visual("visual", geometry, material=shape_material(shape))])
    return Model(f"unit_{shape}", Pose((0.0, 0.0, 0.5)), links=[link])


def shape_material(shape: str) -> Material:
    """The color of a shape that the editor inserts; files, cameras and the view have it alike."""
    color = SHAPE_COLORS[shape]
    return Material(ambient=color, diffuse=color)


def entity_of_text(text: str, resolver: Resolver, source: Optional[str] = None,
                   ) -> Tuple[Entity, List[Issue]]:
    """The model or light of a document. Raises InputError when it cannot be used as it is.

    `source` is the name of the file that the text is from; issues name it.
    """
    entity, issues = read_entity(text, resolver, _file_name(source) or _inserted(text))
    return _usable(entity, issues)


def entity_of_uri(uri: str, resolver: Resolver) -> Tuple[Entity, List[Issue]]:
    """The model or light a URI names, with the URI. Raises CommandError, InputError."""
    try:
        path = resolver.model_file(uri)
    except ResourceNotFoundError as missing:
        raise CommandError(str(missing)) from missing
    entity, issues = read_file(path, resolver)
    entity, issues = _usable(entity, issues)
    return (replace(entity, uri=uri) if isinstance(entity, Model) else entity), issues


def entities_of_text(text: str, resolver: Resolver, source: Optional[str] = None,
                     ) -> Tuple[List[Entity], List[Issue]]:
    """All models and lights of what was copied or of a file: a world, or one of them alone."""
    if "<world" not in text:
        entity, issues = entity_of_text(text, resolver, source)
        return [entity], issues
    world, issues = parse_world(text, resolver, _file_name(source) or "<clipboard>")
    if errors_of(issues):
        raise InputError(issues)
    return [*world.models, *world.lights], issues


def _file_name(source: Optional[str]) -> str:
    """The name alone: it says where a text is from, and opens no folder of this machine."""
    return os.path.basename((source or "").replace("\\", "/"))


def _inserted(text: str) -> str:
    """Where issues about a text without a file are: its first model or light, by name."""
    found = _NAMED.search(text)
    return f"<inserted {found.group(1)} {found.group(3)}>" if found else "<inserted text>"


def _usable(entity: Entity, issues: List[Issue]) -> Tuple[Entity, List[Issue]]:
    if errors_of(issues):
        raise InputError(issues)
    return entity, [issue for issue in issues if issue not in errors_of(issues)]


def check_meshes(model: Model) -> Tuple[MeshTable, List[Issue]]:
    """Load the collision meshes of a model; return them and warnings about the model.

    Raises InputError: the model cannot be simulated.
    """
    found = validate(model)
    if errors_of(found):
        raise InputError(found)
    meshes, issues = collision_meshes(flatten_model(model))
    if errors_of(issues):
        raise InputError(issues)
    return meshes, issues


def used_names(simulator: Simulator) -> Collection[str]:
    """Names of all models and lights."""
    return {*simulator.models.names(), *(light.name for light in simulator.lights.all())}


def with_new_groups(entities: Sequence[Entity], taken: Collection[str]) -> List[Entity]:
    """Copies in groups of their own: those of one group in a group with a free name.

    A copy of one member of a group is in none.
    """
    groups = [group_of(one) for one in entities]
    names = {group: free_name(group, taken) if groups.count(group) > 1 else ""
             for group in groups if group}
    return [with_group(one, names[group]) if group else one
            for one, group in zip(entities, groups)]


def world_of(models: List[Model], lights: List[Light]) -> World:
    """A world that carries copies."""
    return World("clipboard", models=models, lights=lights)
