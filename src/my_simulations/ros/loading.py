"""The world file of the command line: found, read, its meshes loaded."""
from __future__ import annotations

from typing import Callable, Dict, List, Tuple

from ..description.model import Model
from ..description.shapes import MeshTable
from ..description.world import World
from ..errors import InputError, Issue, error
from ..resources.resolver import NotFound, Resolver

Log = Callable[[Issue], None]


def load_world(name: str, resolver: Resolver, log: Log) -> Tuple[World, Dict[str, MeshTable]]:
    """Read a world.

    A collision whose mesh cannot be used is left out, and the rest of the world loads.

    Args:
        name: a path, or a name in the resource paths.
        resolver: finds the file and what it names.
        log: hears every issue of a world that is usable.

    Returns:
        The world, and the collision meshes of its models by model name.

    Raises:
        InputError: there is no usable world.
    """
    from ..formats.load import read_world
    from ..formats.state import apply_state

    try:
        path = resolver.resolve(name)
    except NotFound as missing:
        raise InputError([error("world-not-found", f"world file {missing}",
                                hint="give its full path, or a folder of GAZEBO_RESOURCE_PATH "
                                     "that holds it")]) from missing
    world, issues = read_world(path, resolver)
    for issue in issues:
        log(issue)
    world = apply_state(world)
    world.models, meshes = _with_meshes(world.models, log)
    return world, meshes


def _with_meshes(models: List[Model], log: Log) -> Tuple[List[Model], Dict[str, MeshTable]]:
    from ..formats.meshes import collision_meshes, without_missing_meshes

    usable: List[Model] = []
    tables: Dict[str, MeshTable] = {}
    for model in models:
        table, issues = collision_meshes(model)
        for issue in issues:
            log(issue)
        usable.append(without_missing_meshes(model, table))
        tables[model.name] = table
    return usable, tables
