"""Edits of a running world that can be undone: applying an operation returns its inverse.

An inverse restores only what the operation changed; changes by physics or by others since then
are kept.
"""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import groupby, islice
from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Optional,
    Protocol,
    Sequence,
    Tuple,
    Union,
)

from ..description.light import Light
from ..description.model import Joint, Model
from ..description.model_group import extra_with_group, group_of, with_group
from ..description.plugin import PluginSpec
from ..description.shapes import MeshTable
from ..description.world import Physics
from ..engine.commands import ModelState
from ..errors import CommandError
from ..geometry import STILL, Pose, Vec3
from .inter_model_joints import DeletedModel
from .load_groups import small_groups
from .models import NewModel
from .order_slot import OrderSlot
from .simulator import Simulator
from .world_state import WorldState

_MOST_REMOVED = 1000
"""Models that one command deletes: the engine takes 0.2 s for 1000 boxes."""


class Operation(Protocol):
    """An edit of the world."""

    def apply(self, world: Simulator) -> "Operation":
        """Apply the edit and return its inverse.

        Raises CommandError: the edit is not possible; nothing has changed.
        """


@dataclass(frozen=True)
class Group:
    """Several operations as one: all are applied, or none."""

    parts: Tuple[Operation, ...]

    def apply(self, world: Simulator) -> Operation:
        """Apply the parts in order; the inverse undoes them in reverse order."""
        done: List[Operation] = []
        for part in _join_neighbours(self.parts):
            try:
                done.append(part.apply(world))
            except CommandError:
                for inverse in reversed(done):
                    inverse.apply(world)
                raise
        return Group(tuple(reversed(done)))


@dataclass(frozen=True)
class AddModel:
    """Spawn a model, or restore a deleted one.

    Attributes:
        model: its description.
        pose: world pose of the model frame.
        meshes: its collision meshes by `mesh_key`.
        state: state of its links and joints; None for at rest at `pose`.
        deleted: what `Models.delete` returned for it; None for a new model.
    """

    model: Model
    pose: Pose
    meshes: MeshTable = field(default_factory=dict)
    state: Optional[ModelState] = None
    deleted: Optional[DeletedModel] = None

    def apply(self, world: Simulator) -> Operation:
        world.models.spawn(self.model, self.pose, meshes=self.meshes, state=self.state,
                           deleted=self.deleted)
        return RemoveModel(self.model.name)


@dataclass(frozen=True)
class RemoveModel:
    """Delete the model `name`."""

    name: str

    def apply(self, world: Simulator) -> Operation:
        """Delete the model; the inverse restores it with the states of its links and joints."""
        return _remove_models(world, [self.name])


def _remove_models(world: Simulator, names: Sequence[str]) -> Operation:
    """Delete models, whose names are different, by one command; returns the inverse."""
    for name in names:
        world.models.get(name)  # raises UnknownEntityError
    entities, snapshot = world.states.latest()
    by_name = {entity.model.name: entity for entity in entities}
    before = [(by_name[name], by_name[name].pose) for name in names]
    back: List[Operation] = []
    for (entity, pose), deleted in reversed([*zip(before, world.models.delete_all(names))]):
        state = entity.saved(snapshot) if entity.link_names else None
        back.append(AddModel(entity.model, entity.initial_pose, entity.meshes, state, deleted))
        if state is None:
            back.append(SetPoses({entity.model.name: pose}))
    return back[0] if len(back) == 1 else Group(tuple(back))


@dataclass(frozen=True)
class _AddModels:
    """Spawn several models by one command; none of them has joints to other models."""

    parts: Tuple[AddModel, ...]

    def apply(self, world: Simulator) -> Operation:
        world.models.spawn_all([NewModel(one.model, one.pose, one.meshes, one.state, one.deleted)
                                for one in self.parts])
        return Group(tuple(RemoveModel(one.model.name) for one in reversed(self.parts)))


@dataclass(frozen=True)
class _RemoveModels:
    """Delete several models, whose names are different, by one command."""

    names: Tuple[str, ...]

    def apply(self, world: Simulator) -> Operation:
        return _remove_models(world, self.names)


def _join_neighbours(parts: Iterable[Operation]) -> Iterator[Operation]:
    """The parts in their order; neighbours that add or delete models are joined."""
    for kind, run in groupby(_without_groups(parts), _joined_as):
        same = list(run)
        if kind == "add":
            models = [one for one in same if isinstance(one, AddModel)]
            added = iter(models)
            for group in small_groups([one.model for one in models]):
                few = tuple(islice(added, len(group)))
                yield few[0] if len(few) == 1 else _AddModels(few)
        elif kind == "remove":
            names = [one.name for one in same if isinstance(one, RemoveModel)]
            if len(set(names)) < len(names):  # the second of them is unknown by then
                yield from same
                continue
            for at in range(0, len(names), _MOST_REMOVED):
                yield _RemoveModels(tuple(names[at:at + _MOST_REMOVED]))
        else:
            yield from same


def _without_groups(parts: Iterable[Operation]) -> Iterator[Operation]:
    for part in parts:
        if isinstance(part, Group):
            yield from _without_groups(part.parts)
        else:
            yield part


def _joined_as(part: Operation) -> str:
    """Neighbours of the same kind are joined; "" for an operation that is applied by itself."""
    if isinstance(part, RemoveModel):
        return "remove"
    if not isinstance(part, AddModel) or (part.deleted and part.deleted.joints.joints):
        return ""
    return "add"


@dataclass(frozen=True)
class EditModel:
    """Replace the description of the model `name`; the new description may rename it.

    Attributes:
        name: present name of the model.
        model: the new description.
        meshes: collision meshes to add, by `mesh_key`.
        undone: whether the model had this description before; see `Models.edit`.
    """

    name: str
    model: Model
    meshes: MeshTable = field(default_factory=dict)
    undone: bool = False

    def apply(self, world: Simulator) -> Operation:
        """Edit the model; its links and joints keep their states."""
        old = world.models.get(self.name)
        world.models.edit(self.name, self.model, self.meshes, self.undone)
        return EditModel(self.model.name, old, undone=True)


@dataclass(frozen=True)
class SetGroups:
    """Put models and lights into groups of the editor.

    Attributes:
        groups: name of the group by name of the model or light, "" for none.
    """

    groups: Dict[str, str]

    def apply(self, world: Simulator) -> Operation:
        """Set the groups; no model is built again. Raises CommandError for an unknown name."""
        before = {name: entity_of(world, name) for name in self.groups}
        for name, entity in before.items():
            if isinstance(entity, Light):
                world.lights.set(name, with_group(entity, self.groups[name]))
            else:
                world.models.set_extra(name, extra_with_group(entity.extra, self.groups[name]))
        return SetGroups({name: group_of(entity) for name, entity in before.items()})


def entity_of(world: Simulator, name: str) -> Union[Model, Light]:
    """Return the model or light of a name: the model if both have it. Raises CommandError."""
    light = None if world.models.has(name) else next(
        (one for one in world.lights.all() if one.name == name), None)
    return light or world.models.get(name)


@dataclass(frozen=True)
class EditJoint:
    """Replace the properties of a joint, found by its name in `model`."""

    model: str
    joint: Joint

    def apply(self, world: Simulator) -> Operation:
        """Edit the joint, in place if the engine supports the change."""
        scoped = f"{self.model}::{self.joint.name}"
        _, old, _ = world.joints.find(scoped)
        world.joints.edit(scoped, self.joint)
        return EditJoint(self.model, old)


@dataclass(frozen=True)
class SetPoses:
    """Move models, lights and links (`model::link`) to world poses, at rest.

    Attributes:
        poses: world poses by name.
        before: poses to restore on undo, for entities that a drag has already moved.
    """

    poses: Dict[str, Pose]
    before: Dict[str, Pose] = field(default_factory=dict)

    def apply(self, world: Simulator) -> Operation:
        """Move all entities; if one cannot be moved, the others return to their poses."""
        done: Dict[str, Pose] = {}
        try:
            for name, pose in self.poses.items():
                was = pose_of(world, name)
                move_entity(world, name, pose)
                done[name] = was
        except CommandError:
            for name, pose in done.items():
                move_entity(world, name, pose)
            raise
        before = {name: pose for name, pose in self.before.items() if name in done}
        return SetPoses({**done, **before})


def pose_of(world: Simulator, name: str) -> Pose:
    """World pose of a model, light or link. Raises CommandError for an unknown name."""
    if world.models.has(name):
        return world.states.model_state(name)[0]
    for light in world.lights.all():
        if light.name == name:
            return light.pose
    if "::" not in name:
        world.models.get(name)  # raises UnknownEntityError
    return world.states.link_state(name)[0]


def move_entity(world: Simulator, name: str, pose: Pose) -> None:
    """Set the world pose of a model, light or link, at rest. Raises CommandError."""
    if world.models.has(name):
        world.states.set_model_state(name, pose, STILL)
    elif any(light.name == name for light in world.lights.all()):
        world.lights.set(name, replace(world.lights.get(name), pose=pose))
    elif "::" in name:
        world.states.set_link_state(name, pose, STILL)
    else:
        world.models.get(name)


@dataclass(frozen=True)
class AddLight:
    """Add a light: at `slot` in the order of lights, or last."""

    light: Light
    slot: Optional[OrderSlot] = None

    def apply(self, world: Simulator) -> Operation:
        world.lights.add(self.light, slot=self.slot)
        return RemoveLight(self.light.name)


@dataclass(frozen=True)
class RemoveLight:
    """Delete the light `name`."""

    name: str

    def apply(self, world: Simulator) -> Operation:
        """Delete the light; the inverse restores it at its position in the order."""
        names = [light.name for light in world.lights.all()]
        return AddLight(world.lights.delete(self.name), OrderSlot.of(names, self.name))


@dataclass(frozen=True)
class EditLight:
    """Replace the description of the light `name`; the new description may rename it."""

    name: str
    light: Light

    def apply(self, world: Simulator) -> Operation:
        old = world.lights.get(self.name)
        world.lights.set(self.name, self.light)
        return EditLight(self.light.name, old)


@dataclass(frozen=True)
class SetPhysics:
    """Set the physics settings and gravity (m/s^2, world frame)."""

    physics: Physics
    gravity: Vec3

    def apply(self, world: Simulator) -> Operation:
        back = SetPhysics(world.physics.settings, world.physics.gravity)
        world.physics.set(self.physics, self.gravity)
        return back


@dataclass(frozen=True)
class SetWorldField:
    """Set a field of the world, one of `scene.WORLD_FIELDS`."""

    name: str
    value: Any

    def apply(self, world: Simulator) -> Operation:
        back = SetWorldField(self.name, getattr(world.world, self.name))
        world.scene.set_field(self.name, self.value)
        return back


@dataclass(frozen=True)
class SetWorldPlugins:
    """Replace the plugins of the world; those of models and actors stay."""

    plugins: Tuple[PluginSpec, ...]

    def apply(self, world: Simulator) -> Operation:
        """Set the plugins; those that are not the same as before are loaded again."""
        back = SetWorldPlugins(tuple(world.world.plugins))
        world.scene.set_field("plugins", list(self.plugins))
        return back


@dataclass(frozen=True)
class RestoreState:
    """Restore captured states of all models."""

    state: WorldState

    def apply(self, world: Simulator) -> Operation:
        """Restore the states; the clock keeps its time."""
        back = RestoreState(world.states.capture())
        world.states.restore(self.state)
        return back


@dataclass(frozen=True)
class Reset:
    """Reset the world.

    Attributes:
        what: `time`, `poses` (of models) or `world` (everything, as loaded).
    """

    what: str

    def apply(self, world: Simulator) -> Operation:
        """Reset time, poses or the whole world; the inverse restores states and time."""
        back = RestoreState(world.states.capture())
        resets: Dict[str, Callable[[], None]] = {
            "time": world.resets.reset_time, "poses": world.resets.reset_world,
            "world": world.resets.reset_simulation}
        resets[self.what]()
        return back
