"""Objects of a list, read for an open world."""
from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import Callable, Dict, List, Sequence, Tuple

from ..description.model import Model
from ..description.shapes import MeshTable
from ..errors import InputError, Issue, error
from ..formats.mesh.loading import collision_meshes
from ..formats.reading import read_entity
from ..geometry import Pose, compose, quat_from_rpy
from ..objects.object_documents import Documents, package_finder
from ..objects.object_list import PlacedObject, groups_file, list_file, parse_objects, world_name
from ..objects.selection import Selection, parse_groups, select
from ..objects.yaml_source import read_yaml
from ..resources.package_files import PACKAGE, package_directories
from ..resources.resolver import Resolver

WorldEdit = Callable[[Model], Model]
"""Makes another model of one that is about to be spawned; `Model.pose` is its place."""

_XACRO_SECONDS = 60.0


@dataclass(frozen=True)
class PlacedModel:
    """A model of an object list; `model.pose` is its place in the world."""

    model: Model
    meshes: MeshTable


def read_objects(resolver: Resolver, names: Sequence[str], file: str, world: str
                 ) -> Tuple[List[PlacedModel], List[Issue]]:
    """Read objects of a list, through xacro where needed.

    Args:
        resolver: finds what their documents name.
        names: objects and groups of the list.
        file: the list; "" for that of the world in this package.
        world: name or file of the world.

    Returns:
        The objects, and faults and advice; an object with an error among them is not there.

    Raises:
        InputError: there is no such list, or it cannot be read.
    """
    selection, issues = selected_objects(names, file, world)
    found: List[PlacedModel] = []
    with Documents(selection.objects, package_finder(), _XACRO_SECONDS) as documents:
        for placed in selection.objects:
            try:
                issues += _read(resolver, placed, documents, found)
            except InputError as fault:
                issues += fault.issues
    return found, issues


def selected_objects(names: Sequence[str], file: str, world: str
                     ) -> Tuple[Selection, List[Issue]]:
    """The objects of a list that are named, and all faults; see `read_objects`."""
    file = file or _list_of(world)
    tree, source, issues = read_yaml(file, "/objects", angles=True)
    listing = parse_objects(tree, source, PACKAGE)
    groups, more = _groups_beside(file)
    selection = select(names, listing, groups)
    return selection, [*issues, *more, *selection.issues]


def _read(resolver: Resolver, placed: PlacedObject, documents: Documents,
          found: List[PlacedModel]) -> List[Issue]:
    document = documents.of(placed)
    entity, issues = read_entity(document.xml, resolver, document.origin)
    if not isinstance(entity, Model):
        return [*issues, error("object-not-a-model", f"{placed.name} is a light, not a model",
                               file=document.path)]
    meshes, faults = collision_meshes(entity)
    pose = compose(Pose(placed.position, quat_from_rpy(*placed.rpy)), entity.pose)
    found.append(PlacedModel(replace(entity, name=placed.name, pose=pose), meshes))
    return [*issues, *faults]


def _list_of(world: str) -> str:
    folders = package_directories()
    file = list_file(folders[0] if folders else "", PACKAGE, world)
    if not os.path.isfile(file):
        raise InputError([error("object-list-missing",
                                f"world '{world_name(world)}' has no object list", file=file,
                                hint="name one with object_list")])
    return file


def _groups_beside(file: str) -> Tuple[Dict[str, List[str]], List[Issue]]:
    groups = groups_file(file)
    if not os.path.isfile(groups):
        return {}, []
    tree, source, issues = read_yaml(groups, "/object_groups", angles=True)
    found, more = parse_groups(tree, source)
    return found, [*issues, *more]
