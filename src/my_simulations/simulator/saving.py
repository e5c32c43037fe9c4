"""Saves a running world as an SDF file: the description with present poses, and a `<state>`.

Present poses are written into the models themselves, so that every SDF reader uses them. The
`<state>` holds the rest: link poses of articulated models and, on request, sim time and velocities.
"""
from __future__ import annotations

import os
from dataclasses import replace
from typing import Dict, List, Optional, Sequence

from ..description.compare import differences
from ..description.joint_positions import anchored_pose
from ..description.model import Joint, Model
from ..description.saved_state import LightState, LinkState, ModelState, SavedState
from ..description.unflatten import unflatten_model
from ..description.world import World
from ..engine.ring import Snapshot
from ..engine.ring_rows import axis_rows
from ..errors import CommandError, InputError
from ..formats.reading import read_file
from ..formats.sdf.writer.entities import write_world
from ..geometry import STILL, Pose, compose, inverse
from ..resources.package_files import package_directories
from ..resources.resolver import Resolver, ResourceNotFoundError
from ..resources.world_lookup import ENDINGS, folder_of_users, is_shipped, users_folder
from ..xml_characters import check_file_name
from .entity import Entity
from .safe_file import write_atomically
from .simulator import Simulator

EXTENSIONS = ENDINGS

_DISPLACED = 1e-6
"""Tolerance below which a link or joint counts as unmoved: m, rad, components of a quaternion."""


def present_world(simulator: Simulator, *, state: bool = True, launched: bool = True) -> World:
    """The description of the present world, with `World.state` set.

    Models are in load order, at the poses of one snapshot; physics and gravity as last set.

    Args:
        simulator: the running world.
        state: write a `<state>` with sim time, velocities and every model; otherwise its time is 0
            and it holds only models whose joints or links differ from their description.
        launched: include the models that the launch file spawned.
    """
    entities, snapshot = simulator.states.fresh()
    if not launched:
        entities = [entity for entity in entities if not entity.launched]
    world = simulator.world
    models = [replace(unflatten_model(entity.model), pose=_written_pose(entity, snapshot))
              for entity in entities]
    saved = (_state if state else _configuration)(world, entities, snapshot)
    return replace(
        world, models=models, lights=simulator.lights.all(),
        joints=_joints_of(simulator, entities), physics=simulator.physics.settings,
        gravity=simulator.physics.gravity, state=saved, initial={}, initial_ns=0)


def _written_pose(entity: Entity, snapshot: Snapshot) -> Pose:
    """Return the pose to write into a model.

    If joints connect the model to the world, its anchors give the pose: the model frame may have
    moved with a link, such as a door, but the hinge has not. `<state>` contains the link poses.
    """
    saved = entity.saved(snapshot)
    positions = {row.joint.name: position for row, (position, _) in zip(
        axis_rows(entity.model), saved.joints)}
    poses = {link.name: now.pose for link, now in zip(entity.model.links, saved.links)}
    return anchored_pose(entity.model.joints, entity.model.links, poses, positions) or (
        entity.state(snapshot)[0])


def _joints_of(simulator: Simulator, entities: Sequence[Entity]) -> List[Joint]:
    present = {entity.model.name for entity in entities}
    return [joint for joint in simulator.models.inter_model_joints
            if all("::" not in end or end.split("::")[0] in present
                   for end in (joint.parent, joint.child))]


def _state(world: World, entities: Sequence[Entity], snapshot: Snapshot) -> SavedState:
    return SavedState(
        world.name, snapshot.sim_ns, iterations=snapshot.step,
        models=[_model_state(entity, snapshot) for entity in entities],
        lights=[LightState(light.name, light.pose) for light in world.lights],
    )


def _configuration(world: World, entities: Sequence[Entity],
                   snapshot: Snapshot) -> Optional[SavedState]:
    """State of the models whose links or joints have moved, at rest at time 0; None if none have.

    A model without an entry is at the `<pose>` of its element, which users can edit in the file.
    """
    models = [_at_rest(_model_state(entity, snapshot)) for entity in entities
              if not entity.model.static and _is_displaced(entity, snapshot)]
    return SavedState(world.name, 0, models=models) if models else None


def _at_rest(state: ModelState) -> ModelState:
    return replace(state, links=[replace(link, twist=STILL) for link in state.links])


def _is_displaced(entity: Entity, snapshot: Snapshot) -> bool:
    """Whether a joint or link has moved within its model, relative to the description."""
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
        simulator: the world to save; it keeps running.
        path: absolute, or relative to the first root; ends in .world or .sdf.
        roots: folders below which files may be written; see `default_roots`.
        resolver: finds the files of includes; not needed if `inline`.
        overwrite: replace an existing file.
        inline: write included models in full; otherwise a model that differs from its file only in
            name, pose, static and added plugins is written as an `<include>`.
        state: write sim time and velocities; see `present_world`.
        launched: include the models that the launch file spawned.
        despite_losses: replace the world's file although parts of it could not be loaded.

    Returns:
        The absolute path that was written.

    Raises:
        CommandError: the path is not allowed, the file ships with this package, or it cannot be
            written; an existing file is unchanged.
    """
    target = check_save_path(path, roots)
    refuse_shipped(target)
    if not despite_losses and overwrite:
        _refuse_losses(simulator, target)
    world = present_world(simulator, state=state, launched=launched)
    included = None if inline or resolver is None else _Includes(resolver)
    write_atomically(target, write_world(world, world.state, included), overwrite)
    return target


def _refuse_losses(simulator: Simulator, target: str) -> None:
    """Raises CommandError if `target` is the world's file and parts of it could not be loaded."""
    losses, file = simulator.models.losses, simulator.world.file
    if losses and file and os.path.realpath(file) == target:
        more = f" (and {len(losses) - 1} more)" if len(losses) > 1 else ""
        raise CommandError(f"{target} was not loaded completely, overwriting it would lose "
                           f"content: {losses[0]}{more}; save under another name")


class _Includes:
    """Reads the files of included models, each once."""

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
            return None  # a model whose file is gone is written in full
        return found if isinstance(found, Model) else None


def refuse_shipped(target: str) -> None:
    """Raises CommandError for a file that ships with this package."""
    if is_shipped(target):
        raise CommandError(f"{target} ships with my_simulations and is never overwritten; choose "
                           "another name or folder")


def default_roots(world_file: str = "", caller: str = "") -> List[str]:
    """Folders below which worlds may be saved.

    Relative paths start from the first one: the folder of the running world's file if it belongs
    to the user, else `~/my_simulations/worlds`. The others are the package's `world` folder, the
    source folders of workspaces, and the working directory of the user's command.

    Args:
        world_file: file of the running world; "" for none.
        caller: working directory of the user's command; "" for that of this process.
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


def check_save_path(path: str, roots: Sequence[str]) -> str:
    """Check the path of a file to save; return it absolute, without symbolic links in its folders.

    Raises CommandError: not below a root, not a .world or .sdf file, a link to another place, or a
    character that is not shown.
    """
    path = os.path.expanduser(path.strip())
    if not roots:
        raise CommandError("no folder is allowed for saving worlds; set parameter ~save_roots")
    if "\0" in path or os.path.splitext(path)[1].lower() not in EXTENSIONS:
        raise CommandError(f"invalid file name {path!r}: it must end in .world or .sdf")
    check_file_name(path)
    target = os.path.realpath(os.path.join(os.path.expanduser(roots[0]), path))
    for root in roots:
        real = os.path.realpath(os.path.expanduser(root))
        if target.startswith(real.rstrip(os.sep) + os.sep):
            return target
    raise CommandError(f"{path!r} resolves to {target}, which is outside the allowed folders: "
                       + ", ".join(roots))
