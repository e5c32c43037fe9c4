"""A running world as a file: the description with the present poses, and a `<state>`.

The final poses stand in the models themselves, so that every reader finds them. A `<state>` tells
what they cannot: where the links of an articulated model are and, on request, sim time and
velocities of everything.
"""
from __future__ import annotations

import os
from dataclasses import replace
from typing import Dict, List, Optional, Sequence

from ..description.compare import differences
from ..description.model import Joint, Model
from ..description.saved_state import LightState, LinkState, ModelState, SavedState
from ..description.unflatten import unflattened
from ..description.world import World
from ..engine.ring import Snapshot
from ..engine.ring_rows import axis_rows
from ..errors import CommandError, InputError
from ..formats.reading import read_file
from ..formats.sdf.writer.entities import write_world
from ..geometry import STILL, compose, inverse
from ..resources.package_files import package_directories
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import ENDINGS, folder_of_users, ships, users_folder
from .registry import Entity
from .safe_file import write_whole
from .simulator import Simulator

EXTENSIONS = ENDINGS

_DISPLACED = 1e-6
"""By how much what has not been moved may be off: m, rad, parts of a quaternion."""


def present_world(simulator: Simulator, *, state: bool = True, launched: bool = True) -> World:
    """The description of what is in the world now, with `state` set.

    Models stand in load order, at the poses of one snapshot; physics and gravity are as last set.

    Args:
        simulator: what is described.
        state: the `<state>` holds sim time, velocities and every model; else it is about time 0,
            and holds the models whose joints or links are elsewhere than in their description.
        launched: with the models that the launch file spawned.
    """
    entities, snapshot = simulator.states.fresh()
    if not launched:
        entities = [entity for entity in entities if not entity.launched]
    world = simulator.world
    models = [replace(unflattened(entity.model), pose=entity.state(snapshot)[0])
              for entity in entities]
    saved = (_state if state else _configuration)(world, entities, snapshot)
    return replace(
        world, models=models, lights=simulator.lights.all(),
        joints=_joints_of(simulator, entities), physics=simulator.physics.settings,
        gravity=simulator.physics.gravity, state=saved, initial={}, initial_ns=0)


def _joints_of(simulator: Simulator, entities: Sequence[Entity]) -> List[Joint]:
    """The joints between these models, or between one of them and the world."""
    there = {entity.model.name for entity in entities}
    return [joint for joint in simulator.models.inter_model_joints
            if all("::" not in end or end.split("::")[0] in there
                   for end in (joint.parent, joint.child))]


def _state(world: World, entities: Sequence[Entity], snapshot: Snapshot) -> SavedState:
    return SavedState(
        world.name, snapshot.sim_ns, iterations=snapshot.step,
        models=[_model_state(entity, snapshot) for entity in entities],
        lights=[LightState(light.name, light.pose) for light in world.lights],
    )


def _configuration(world: World, entities: Sequence[Entity],
                   snapshot: Snapshot) -> Optional[SavedState]:
    """What the poses of the models do not tell, at rest at time 0; None where they tell all.

    A model that the `<state>` does not name is where its own <pose> says, which a person may
    change in the file by hand.
    """
    models = [_at_rest(_model_state(entity, snapshot)) for entity in entities
              if not entity.model.static and _is_displaced(entity, snapshot)]
    return SavedState(world.name, 0, models=models) if models else None


def _at_rest(state: ModelState) -> ModelState:
    return replace(state, links=[replace(link, twist=STILL) for link in state.links])


def _is_displaced(entity: Entity, snapshot: Snapshot) -> bool:
    """Whether a joint or a link is elsewhere in its model than the description says."""
    model_from_world = inverse(entity.state(snapshot)[0])
    saved = entity.saved(snapshot)
    return any(abs(position) > _DISPLACED for position, _rate in saved.joints) or any(
        bool(differences(compose(model_from_world, now.pose), link.pose, _DISPLACED))
        for link, now in zip(entity.model.links, saved.links))


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
               inline: bool = True, state: bool = False, launched: bool = False,
               despite_losses: bool = False) -> str:
    """Write the running world to a file.

    Args:
        simulator: what is saved; it goes on meanwhile.
        path: absolute, or relative to the first root; ends in .world or .sdf.
        roots: folders below which files may be written; see `default_roots`.
        resolver: finds what includes bring; needed unless `inline`.
        overwrite: whether a file of that name may be replaced.
        inline: write models from includes in full; else those that nothing changed but for name,
            pose, static and more plugins are includes again.
        state: with sim time and velocities; see `present_world`.
        launched: with the models that the launch file spawned.
        despite_losses: whether a file may be replaced of which parts could not be loaded.

    Returns:
        The absolute path that was written.

    Raises:
        CommandError: the path is not allowed, the file ships with this package, or it cannot be
            written; a file that was there is untouched.
    """
    target = allowed_path(path, roots)
    refuse_shipped(target)
    if not despite_losses and overwrite:
        _refuse_losses(simulator, target)
    world = present_world(simulator, state=state, launched=launched)
    included = None if inline or resolver is None else _Includes(resolver)
    write_whole(target, write_world(world, world.state, included), overwrite)
    return target


def _refuse_losses(simulator: Simulator, target: str) -> None:
    """Keep a file from being replaced by less than what it holds. Raises CommandError."""
    losses, file = simulator.models.losses, simulator.world.file
    if losses and file and os.path.realpath(file) == target:
        more = f" (and {len(losses) - 1} more)" if len(losses) > 1 else ""
        raise CommandError(f"{target} was not loaded completely, overwriting it would lose "
                           f"content: {losses[0]}{more}; save under another name")


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
        except (ResourceNotFoundError, InputError):
            return None  # what cannot be found again must be written in full
        return found if isinstance(found, Model) else None


def refuse_shipped(target: str) -> None:
    """Raise CommandError for a file that came with this package."""
    if ships(target):
        raise CommandError(f"{target} ships with my_simulations and is never overwritten; choose "
                           "another name or folder")


def default_roots(world_file: str = "", caller: str = "") -> List[str]:
    """Where worlds may be saved.

    The first one is where relative paths start: the folder of the running world's file, if that is
    the user's own, else `~/my_simulations/worlds`. The others are the package's `world` folder,
    workspaces' sources, and the folder in which the command was typed.

    Args:
        world_file: of the running world; "" for none.
        caller: folder in which the command was typed; "" for the working directory.
    """
    roots = [folder_of_users(world_file), users_folder()]
    own = package_directories()
    world = os.path.join(own[0], "world") if own else ""
    if world and os.access(world, os.W_OK):
        roots.append(world)
    entries = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    roots += [entry for entry in entries if os.path.basename(entry.rstrip("/")) == "src"]
    roots.append(caller or os.getcwd())
    return list(dict.fromkeys(root for root in roots if root and root != os.sep))


def allowed_path(path: str, roots: Sequence[str]) -> str:
    """The path to write, with links in its folders followed.

    Raises:
        CommandError: not below a root, not a world file's name, or a link that leads elsewhere.
    """
    path = os.path.expanduser(path.strip())
    if not roots:
        raise CommandError("no folder is allowed for saving worlds; set parameter ~save_roots")
    if "\0" in path or os.path.splitext(path)[1].lower() not in EXTENSIONS:
        raise CommandError(f"invalid file name {path!r}: it must end in .world or .sdf")
    target = os.path.realpath(os.path.join(os.path.expanduser(roots[0]), path))
    for root in roots:
        real = os.path.realpath(os.path.expanduser(root))
        if target.startswith(real.rstrip(os.sep) + os.sep):
            return target
    raise CommandError(f"{path!r} resolves to {target}, which is outside the allowed folders: "
                       + ", ".join(roots))
