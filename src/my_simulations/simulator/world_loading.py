"""Finds and reads a world, loads its meshes and starts its simulator."""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, Dict, List, Tuple

from ..description.model import Model
from ..description.shapes import MeshTable
from ..description.world import World
from ..engine.api import Engine
from ..engine.commands import FOREVER
from ..errors import InputError, Issue, error, errors_of
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import advice_on, find_world
from .simulator import Simulator

Log = Callable[[Issue], None]


def start_world(name: str, resolver: Resolver, engines: Callable[[], Engine], log: Log, *,
                seed: int = 0, profile: str = "", steps: int = FOREVER, caller: str = "",
                read: Callable[[], None] = lambda: None) -> Simulator:
    """Read a world and start its simulator, paused.

    Args:
        name: see `load_world`.
        resolver: see `load_world`.
        engines: makes the engine.
        log: receives every issue of a usable world, and those of the simulator.
        seed: see `load_world`.
        profile: see `load_world`.
        steps: pause after this many steps; FOREVER for never.
        caller: see `load_world`.
        read: called when the file has been read.

    Raises:
        InputError: the world is unusable.
        CommandError: the engine cannot be started.
    """
    world, meshes = load_world(name, resolver, log, seed=seed, profile=profile, caller=caller)
    read()
    simulator = Simulator(world, engine_factory=engines, paused=True, log=log, meshes=meshes,
                          steps=steps)
    simulator.start()
    return simulator


def load_world(name: str, resolver: Resolver, log: Log, *, seed: int = 0,
               profile: str = "", caller: str = "") -> Tuple[World, Dict[str, MeshTable]]:
    """Read a world.

    A collision whose mesh cannot be used does not collide, and the rest of the world is loaded; it
    stays in the description, so that saving the world keeps it.

    Args:
        name: see `find_world`.
        resolver: resolves the file and its URIs.
        log: receives every issue of a usable world.
        seed: random seed.
        profile: name of the physics preset; "" for the world's default.
        caller: base folder of relative names; "" for the working directory.

    Returns:
        The world, and the collision meshes of its models by model name.

    Raises:
        InputError: the world is unusable.
    """
    from ..formats.loading_advice import advised
    from ..formats.reading import read_world
    from ..formats.sdf.state_applied import apply_state

    try:
        path = find_world(name, resolver, caller)
    except ResourceNotFoundError as missing:
        raise InputError([error("world-not-found", f"world file {missing}",
                                hint=advice_on(name, caller))]) from missing
    world, issues = read_world(path, resolver, seed=seed, profile=profile)
    for issue in issues:
        log(issue)
    world = replace(apply_state(world), losses=[str(issue) for issue in errors_of(issues)])
    meshes = _meshes(world.models, log)
    for issue in advised(world.models, meshes, path):
        log(issue)
    return world, meshes


def _meshes(models: List[Model], log: Log) -> Dict[str, MeshTable]:
    from ..formats.mesh.loading import collision_meshes

    tables: Dict[str, MeshTable] = {}
    for model in models:
        tables[model.name], issues = collision_meshes(model)
        for issue in issues:
            log(issue)
    return tables
