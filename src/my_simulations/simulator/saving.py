"""A running world as a file: the description with the present poses, and a `<state>`.

The final poses stand in the models themselves, so that every reader finds them, and once more in
the `<state>` together with sim time, velocities and joint positions.
"""
from __future__ import annotations

import os
from dataclasses import replace
from typing import Dict, List, Optional, Sequence

from ..description.model import Model
from ..description.unflatten import unflattened
from ..description.world import LightState, LinkState, ModelState, SavedState, World
from ..engine.ring import Snapshot
from ..engine.rows import axis_rows
from ..errors import CommandError, InputError
from ..formats.load import read_file
from ..formats.sdf_write import write_world
from ..resources.own import package_directories
from ..resources.resolver import NotFound, Resolver
from .registry import Entity
from .safe_file import write_whole
from .simulator import Simulator

EXTENSIONS = (".world", ".sdf")


def present_world(simulator: Simulator) -> World:
    """The description of what is in the world now, with `state` set.

    Models stand in load order, at the poses of one snapshot; physics and gravity are as last set.
    """
    entities, snapshot = simulator.look()
    world = simulator.world
    models = [replace(unflattened(entity.model), pose=entity.state(snapshot)[0])
              for entity in entities]
    return replace(
        world, models=models, lights=simulator.lights(),
        joints=simulator.joints_between_models, physics=simulator.physics,
        gravity=simulator.gravity,
        state=_state(world, entities, snapshot), initial={}, initial_ns=0,
        extra=[xml for xml in world.extra if not xml.lstrip().startswith("<state")],
    )


def _state(world: World, entities: Sequence[Entity], snapshot: Snapshot) -> SavedState:
    return SavedState(
        world.name, snapshot.sim_ns, iterations=snapshot.step,
        models=[_model_state(entity, snapshot) for entity in entities],
        lights=[LightState(light.name, light.pose) for light in world.lights],
    )


def _model_state(entity: Entity, snapshot: Snapshot) -> ModelState:
    state = ModelState(entity.model.name, entity.state(snapshot)[0])
    if entity.model.static:
        return state
    saved = entity.saved(snapshot)
    for name, link in zip(entity.link_names, saved.links):
        state.links.append(LinkState(name, link.pose, link.twist))
    for row, (position, _rate) in zip(axis_rows(entity.model), saved.joints):
        state.joints.setdefault(row.joint.name, []).append(position)
    return state


def save_world(simulator: Simulator, path: str, *, roots: Sequence[str],
               resolver: Optional[Resolver] = None, overwrite: bool = False,
               inline: bool = True) -> str:
    """Write the running world to a file.

    Args:
        simulator: what is saved; it goes on meanwhile.
        path: absolute, or relative to the first root; ends in .world or .sdf.
        roots: folders below which files may be written; see `default_roots`.
        resolver: finds what includes bring; needed unless `inline`.
        overwrite: whether a file of that name may be replaced.
        inline: write models from includes in full; else those that nothing changed but for name,
            pose, static and more plugins are includes again.

    Returns:
        The absolute path that was written.

    Raises:
        CommandError: the path is not allowed, or the file cannot be written; a file that was there
            is untouched.
    """
    target = allowed_path(path, roots)
    world = present_world(simulator)
    included = None if inline or resolver is None else _Includes(resolver)
    write_whole(target, write_world(world, world.state, included), overwrite)
    return target


class _Includes:
    """What the URIs of included models bring, each read once."""

    def __init__(self, resolver: Resolver) -> None:
        self._resolver = resolver
        self._known: Dict[str, Optional[Model]] = {}

    def __call__(self, model: Model) -> Optional[Model]:
        if model.uri not in self._known:
            self._known[model.uri] = self._read(model.uri)
        return self._known[model.uri]

    def _read(self, uri: str) -> Optional[Model]:
        try:
            found, _ = read_file(self._resolver.model_file(uri), self._resolver)
        except (NotFound, InputError):
            return None  # what cannot be found again must be written in full
        return found if isinstance(found, Model) else None


def default_roots() -> List[str]:
    """Where worlds may be saved: ours, workspaces' sources, the home folder's, and here.

    The first one is where relative paths start: the package's `world` folder, as on the lab sheet,
    or `~/my_simulations/worlds` where that cannot be written to.
    """
    roots = [os.path.expanduser("~/my_simulations/worlds")]
    own = package_directories()
    if own:
        world = os.path.join(own[0], "world")
        roots.insert(0 if os.access(world, os.W_OK) else 1, world)
    entries = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    roots += [entry for entry in entries if os.path.basename(entry.rstrip("/")) == "src"]
    here = os.getcwd()
    if here != os.sep:
        roots.append(here)
    return roots


def allowed_path(path: str, roots: Sequence[str]) -> str:
    """The path to write, with links in its folders followed.

    Raises:
        CommandError: not below a root, not a world file's name, or a link that leads elsewhere.
    """
    path = os.path.expanduser(path.strip())
    if not roots:
        raise CommandError("there is no folder in which worlds may be saved")
    if "\0" in path or os.path.splitext(path)[1].lower() not in EXTENSIONS:
        raise CommandError(f"{path!r} is no name for a world; it must end in .world or .sdf")
    target = os.path.realpath(os.path.join(os.path.expanduser(roots[0]), path))
    for root in roots:
        real = os.path.realpath(os.path.expanduser(root))
        if target.startswith(real.rstrip(os.sep) + os.sep):
            return target
    raise CommandError(f"{path!r} leads to {target}, where no world may be saved; allowed are "
                       + ", ".join(roots))
