"""Finds and reads a world by name, and starts its simulator."""
from __future__ import annotations

import os
from typing import Callable

from ..engine.api import Engine
from ..engine.commands import FOREVER
from ..errors import InputError, Issue, error, group_repeated
from ..formats.reading import LoadedWorld, read_world
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import advice_on, find_world, similar_world
from .simulator import Simulator

Log = Callable[[Issue], None]
Progress = Callable[[str, str, int, int], None]


def _silent(_title: str, _text: str, _done: int, _of: int) -> None:
    """Ignore progress."""


def start_world(name: str, resolver: Resolver, engines: Callable[[], Engine], log: Log, *,
                seed: int = 0, profile: str = "", steps: int = FOREVER, caller: str = "",
                read: Callable[[], None] = lambda: None, progress: Progress = _silent) -> Simulator:
    """Read a world and start its simulator, paused.

    Args:
        name: see `load_world`.
        resolver: see `load_world`.
        engines: creates the engine.
        log: receives every issue of a usable world, and those of the simulator.
        seed: see `load_world`.
        profile: see `load_world`.
        steps: pause after this many steps; FOREVER for never.
        caller: see `load_world`.
        read: called when the file has been read.
        progress: called with a title, a text, the work done, and the whole work (0: unknown).
            `log` receives notes about the decomposition of meshes.

    Raises:
        InputError: the world cannot be used.
        CommandError: the engine cannot be started.
    """
    loaded = load_world(name, resolver, log, seed=seed, profile=profile, caller=caller,
                        progress=progress)
    read()
    progress("Starting the physics engine", f"{len(loaded.world.models)} models", 0, 0)
    simulator = Simulator(loaded.world, engine_factory=engines, paused=True, log=log,
                          meshes=loaded.meshes, steps=steps)
    simulator.start()
    return simulator


def load_world(name: str, resolver: Resolver, log: Log, *, seed: int = 0, profile: str = "",
               caller: str = "", progress: Progress = _silent) -> LoadedWorld:
    """Find and read a world.

    Args:
        name: a file name as `find_world` takes it.
        resolver: finds the file and the files it refers to.
        log: receives every issue of a usable world.
        seed: seed of populations that are placed at random.
        profile: name of the physics preset to use; "" for the default of the world.
        caller: folder from which relative names start; "" for the working directory.
        progress: see `start_world`.

    Raises:
        InputError: the world is unusable.
    """
    try:
        path = find_world(name, resolver, caller)
    except ResourceNotFoundError as missing:
        is_short = not missing.reason and similar_world(name, caller)
        text = f"{name!r} was not found" if is_short else str(missing)
        raise InputError([error("world-not-found", f"world file {text}",
                                hint=advice_on(name, caller))]) from missing
    title = f"Reading {os.path.basename(path)}"
    progress(title, "", 0, 0)

    def read_meshes(model: str, done: int, of: int) -> None:
        progress(title, model and f"meshes of {model}", done, of)

    loaded = read_world(path, resolver, seed=seed, profile=profile, progress=read_meshes)
    for issue in group_repeated(loaded.issues):
        log(issue)
    return loaded
