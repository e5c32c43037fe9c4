"""Spawns, deletes and edits models in a running world."""
from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from dataclasses import replace as replaced
from typing import Dict, List, Optional, Sequence

from ..description.flatten import flatten_model
from ..description.model import Inertial, Model
from ..description.model_plugins import has_plugins
from ..description.shapes import Material, MeshTable
from ..description.world import World
from ..engine.commands import (
    Batch,
    Command,
    LoadModel,
    ModelState,
    RemoveModel,
)
from ..engine.ring import Snapshot
from ..engine.timed_forces import AddTimedForces
from ..errors import CommandError, error
from ..formats.mesh.loading import without_missing_meshes
from ..geometry import Pose, compose, normalised
from .connected_models import ConnectedModels
from .convex_meshes import ConvexParts
from .drives import Drives
from .entity import Entity
from .inter_model_joints import DeletedModel, InterModelJoints
from .load_groups import prepare_shapes, small_groups
from .model_connections import ModelConnections
from .order_slot import OrderSlot
from .registry import NameTakenError
from .session import Session, check_name
from .world_state import initial_commands
from .wrenches import Wrenches


@dataclass(frozen=True)
class NewModel:
    """A model for `Models.spawn_all`; the fields are the arguments of `Models.spawn`."""

    model: Model
    pose: Optional[Pose] = None
    meshes: MeshTable = field(default_factory=dict)
    state: Optional[ModelState] = None
    deleted: Optional[DeletedModel] = None


class Models(ConnectedModels):
    """Owns the entities, the joints between models, and which models are pinned.

    Changes take the session's structure lock, and the registry lock for the moment in which names
    and rows change; reads take the registry lock.
    """

    def __init__(self, session: Session, wrenches: Wrenches, drives: Drives,
                 convex_meshes: ConvexParts) -> None:
        super().__init__(session)
        self._wrenches = wrenches
        self._drives = drives
        self._convex_meshes = convex_meshes
        self._losses: List[str] = []
        self._saved_starts = dict(session.world.initial)

    # -- reading -----------------------------------------------------------------------------------

    @property
    def losses(self) -> List[str]:
        """Elements of the world file that could not be loaded, one sentence each."""
        return self._losses

    # -- spawning and deleting ---------------------------------------------------------------------

    def spawn(self, model: Model, pose: Optional[Pose] = None, frame: str = "",
              meshes: Optional[MeshTable] = None, replace: bool = False,
              state: Optional[ModelState] = None, deleted: Optional[DeletedModel] = None,
              launched: bool = False) -> None:
        """Add a model to the world; returns when a snapshot contains it.

        Args:
            model: the description, with its name; nested models are flattened.
            pose: pose of the model frame in `frame`; None for the pose of the description.
            frame: reference frame of `pose`, "" for the world.
            meshes: its loaded collision meshes by `mesh_key`.
            replace: replace a model of that name within one step.
            state: state of its links and joints; None for at rest at `pose`.
            deleted: result of `delete`; restores the position in the order and the joints to other
                models.
            launched: see `Entity`.

        Raises:
            CommandError: empty or existing name, unknown frame, or rejected by the engine.
        """
        check_name(model.name, "model")
        model = flatten_model(model)
        meshes = self._convex_meshes.of(model, meshes or {})
        session = self._session
        if has_plugins(model):
            session.before_plugins()
        prepare_shapes(session, model, meshes)
        with session.structure_lock:
            session.await_posted()
            again = InterModelJoints() if deleted is None else deleted.joints
            joints = self._connections.joints.with_joints(again)
            with session.registry_lock:
                old = self._replaceable(model.name, replace)
                # A joint to a model that is restored later may need it articulated.
                articulated = joints.has_prismatic_joint(model.name) or (deleted is not None
                                                             and deleted.articulated)
                entity = session.new_entity(model, self._world_pose(model, pose, frame), meshes,
                                            articulated)
                entity.launched = launched or (deleted is not None and deleted.launched)
                entity.start = (self._saved_starts.pop(model.name, None) if deleted is None
                                else deleted.start)
            try:
                session.call(Batch((
                    load_command(entity, state),
                    *initial_commands(entity, entity.start if state is None else None),
                    *again.commands(session.registry, model.name, entity),
                    *([] if old is None else [RemoveModel(old.model_id)]),
                    *self._connections.pins_with(model.name, entity, session.registry))))
            except CommandError:
                self._forget(entity)
                raise
            with session.registry_lock:
                session.registry.add(entity, None if deleted is None else deleted.slot)
                if deleted is not None:
                    self._set_joints(joints.with_existing_links(session.registry))
                if old is not None:
                    self._set_joints(self._connections.joints.without_model(model.name))
                    self._forget(old)

    def spawn_all(self, models: Sequence[NewModel]) -> None:
        """Add models by one command; returns when a snapshot contains all of them.

        Each command costs a snapshot of the whole world. Joints to other models are not restored.
        Raises CommandError as `spawn`; then none is added.
        """
        session = self._session
        entities: List[Entity] = []
        commands: List[Command] = []
        with session.structure_lock:
            session.await_posted()
            try:
                for one in models:
                    entity = self._new_entity(one, [other.model.name for other in entities])
                    entities.append(entity)
                    commands += [load_command(entity, one.state), *initial_commands(
                        entity, entity.start if one.state is None else None)]
                session.call(Batch(tuple(commands)))
            except CommandError:
                for entity in entities:
                    self._forget(entity)
                raise
            with session.registry_lock:
                session.registry.add_all(entities, [
                    None if one.deleted is None else one.deleted.slot for one in models])
                for entity in entities:
                    self._saved_starts.pop(entity.model.name, None)

    def _new_entity(self, new: NewModel, others: Sequence[str]) -> Entity:
        """The entity of a model that is added after `others`. Raises CommandError."""
        check_name(new.model.name, "model")
        model, deleted, session = flatten_model(new.model), new.deleted, self._session
        if has_plugins(model):
            session.before_plugins()
        parts = self._convex_meshes.of(model, new.meshes)
        with session.registry_lock:
            self._replaceable(model.name)
            if model.name in others:
                raise NameTakenError(f"a model named '{model.name}' already exists")
            entity = session.new_entity(
                model, self._world_pose(model, new.pose, ""), parts,
                self._connections.joints.has_prismatic_joint(model.name)
                or (deleted is not None and deleted.articulated))
        entity.launched = deleted is not None and deleted.launched
        entity.start = deleted.start if deleted else self._saved_starts.get(model.name)
        return entity

    def delete(self, name: str) -> DeletedModel:
        """Delete a model; returns when it is gone, with the data that `spawn` restores it from.

        Raises UnknownEntityError.
        """
        return self.delete_all([name])[0]

    def delete_all(self, names: Sequence[str]) -> List[DeletedModel]:
        """Delete models by one command, as `delete`. The names are different."""
        session = self._session
        with session.structure_lock:
            with session.registry_lock:
                entities = [session.registry.model(name) for name in names]
            commands = tuple(RemoveModel(entity.model_id) for entity in entities)
            session.call(Batch(commands) if len(commands) > 1 else commands[0])
            with session.registry_lock:
                return list(map(self._unregister, entities))

    def _unregister(self, entity: Entity) -> DeletedModel:
        """Remove an entity, which the engine no longer has, from the registry."""
        registry, name = self._session.registry, entity.model.name
        deleted = DeletedModel(OrderSlot.of(registry.names(), name),
                               self._connections.permanent_joints.of_model(name),
                               entity.launched, entity.start, entity.articulated)
        registry.remove(name)
        self._connections = self._connections.without_model(name)
        self._forget(entity)
        return deleted

    def _replaceable(self, name: str, may_replace: bool = False) -> Optional[Entity]:
        registry = self._session.registry
        old = registry.model(name) if name in registry else None
        if old is not None and not may_replace:
            raise NameTakenError(f"a model named '{name}' already exists")
        return old

    def _world_pose(self, model: Model, pose: Optional[Pose], frame: str) -> Pose:
        anchor = self._session.registry.frame(frame)
        wanted = model.pose if pose is None else pose
        wanted = Pose(wanted.position, normalised(wanted.orientation))
        if anchor is None:
            return wanted
        return compose(anchor.newest(self._session.ring)[0], wanted)

    def _set_joints(self, joints: InterModelJoints) -> None:
        self._connections = replaced(self._connections, joints=joints)

    def _forget(self, entity: Entity) -> None:
        """Release the rows, drives and wrenches of an entity that is not in the engine."""
        with self._session.registry_lock:
            self._wrenches.forget_entity(entity)
            self._drives.forget_entity(entity)
            self._session.free_rows(entity)

    # -- changing ----------------------------------------------------------------------------------

    def edit(self, name: str, model: Model, meshes: Optional[MeshTable] = None,
             undone: bool = False) -> None:
        """Replace the description of a model; links and joints in both keep their state.

        Links keep pose and twist (moved along when their pose in the model differs), joints
        position and rate, timed wrenches go on, and bodies that rested on it wake up.

        Args:
            name: present name of the model.
            model: the new description; a new name renames the model. Its pose is ignored: the
                model stays in place, and a reset moves it to where it was loaded.
            meshes: added collision meshes by `mesh_key`; the present ones are kept.
            undone: whether the model had this description before; a light may share its name
                then, as both may in SDF before 1.7.

        Raises:
            CommandError: unknown or existing name, or rejected by the engine; nothing has changed.
        """
        check_name(model.name, "model")
        model = flatten_model(model)
        session = self._session
        if has_plugins(model):
            session.before_plugins()
        with session.structure_lock:
            with session.registry_lock:
                old = session.registry.model(name)
                if model.name != name:
                    check = self._replaceable if undone else session.check_name_is_free
                    check(model.name)
            parts = self._convex_meshes.of(model, {**old.meshes, **(meshes or {})})
            with session.registry_lock:
                entity = session.new_entity(model, old.initial_pose, parts,
                                            self._connections.joints.has_prismatic_joint(model.name))
            entity.pose, entity.articulated = old.pose, old.articulated
            entity.launched, entity.start = old.launched, old.start
            forces = self._wrenches.transfer_to_successor(old, entity)
            driving = self._drives.transfer_to_successor(old, entity)
            try:
                session.call(Batch((
                    replaced(load_command(entity), inherit=old.model_id),
                    RemoveModel(old.model_id),
                    *self._connections.joints.commands(session.registry, name, entity),
                    *([AddTimedForces(tuple(forces))] if forces else []),
                    *driving.commands(),
                    *self._connections.pins_with(name, entity, session.registry))))
            except CommandError:
                self._forget(entity)
                raise
            with session.registry_lock:
                session.registry.swap(old, entity)
                self._connections = self._connections.with_model_renamed(name, model.name,
                                                             session.registry)
                self._forget(old)
            self._wrenches.store(forces)
            self._drives.store_transferred(driving)

    def set_link_inertial(self, link: str, inertial: Inertial,
                          gravity: Optional[bool] = None) -> None:
        """Set the inertial of a link (plain or scoped name), and its gravity flag unless None.

        Raises CommandError.
        """
        with self._session.structure_lock:
            with self._session.registry_lock:
                entity, index = self._session.registry.link(link)
            links = list(entity.model.links)
            old = links[index]
            links[index] = replaced(old, inertial=inertial,
                                    gravity=old.gravity if gravity is None else gravity)
            self.edit(entity.model.name, replaced(entity.model, links=links))

    def set_material(self, name: str, link: str, visual: str, material: Material) -> None:
        """Show a visual in another material, as cameras and the editor do; nothing else changes.

        Args:
            name: of the model.
            link: its name in the model.
            visual: its name in the link.
            material: the new one, whole.

        Raises CommandError for an unknown model, link or visual.
        """
        with self._session.structure_lock, self._session.registry_lock:
            old = self._session.registry.model(name)
            at = next((n for n, one in enumerate(old.model.links) if one.name == link), None)
            if at is None:
                raise CommandError(f"model '{name}' has no link '{link}'")
            visuals = old.model.links[at].visuals
            if not any(one.name == visual for one in visuals):
                names = ", ".join(one.name for one in visuals) or "none"
                raise CommandError(f"link '{name}::{link}' has no visual '{visual}'; it has"
                                   f" {names}")
            links = list(old.model.links)
            links[at] = replaced(links[at], visuals=[
                replaced(one, material=material) if one.name == visual else one
                for one in visuals])
            entity = copy(old)
            entity.model = replaced(old.model, links=links)
            self._session.registry.swap(old, entity)

    def set_launched(self, names: Sequence[str]) -> None:
        """Set which models the launch file spawned; clears the flag of all others."""
        with self._session.registry_lock:
            for entity in self._session.registry.entities():
                entity.launched = entity.model.name in names

    # -- whole worlds, for the other parts, which hold the structure lock --------------------------

    def load_all(self, meshes: Dict[str, MeshTable]) -> None:
        """Load the models of the session's world and join them.

        Models that cannot be loaded are logged and skipped. Raises CommandError if no engine
        starts.
        """
        session = self._session
        self._saved_starts = dict(session.world.initial)
        self._losses = list(session.world.losses)
        self._set_joints(InterModelJoints(session.world.joints))
        self.divide_meshes(session.world, meshes)
        for group in small_groups(session.world.models):
            if len(group) == 1 or not self._load_together(group, meshes):
                for model in group:
                    self._load_or_skip(model, meshes.get(model.name))
        located, issues = self._connections.joints.locate(session.registry)
        for issue in issues:
            session.log(replaced(issue, file=session.world.file))
        self._set_joints(InterModelJoints())  # a restarted engine gets those that were made
        for command in located.commands(session.registry):
            try:
                session.call(command)
                self._set_joints(self._connections.joints.with_joints(
                    located.with_name(command.joint.name)))
            except CommandError as fault:
                session.log(error("joint-refused", str(fault), file=session.world.file))

    def _load_or_skip(self, model: Model, meshes: Optional[MeshTable]) -> None:
        """Load a model of the world, or log why it is skipped."""
        try:
            self.spawn(model, meshes=meshes)
        except CommandError as fault:
            left_out = f"skipped model '{model.name}': {fault}"
            self._losses.append(left_out)
            self._session.log(error("model-refused", left_out, file=self._session.world.file))

    def _load_together(self, group: Sequence[Model], meshes: Dict[str, MeshTable]) -> bool:
        """Load models by one command; returns False, and loads none, if one of them is refused."""
        try:
            self.spawn_all([NewModel(model, meshes=meshes.get(model.name) or {})
                            for model in group])
        except CommandError:
            return False
        return True

    def divide_meshes(self, world: World, meshes: Dict[str, MeshTable],
                      gently: bool = False) -> None:
        """Decompose the meshes of all moving models of a world into convex parts.

        With `gently`, at low priority, because another world is running meanwhile.
        """
        self._convex_meshes.prepare([(flatten_model(model), meshes.get(model.name) or {})
                                     for model in world.models], gently)

    def forget_all(self) -> None:
        """Drop every entity from the registry, after the engine was cleared."""
        session = self._session
        with session.registry_lock:
            for entity in session.registry.entities():
                session.registry.remove(entity.model.name)
                self._forget(entity)
        self._connections = ModelConnections(self._connections.joints)

    def restore_commands(self, snapshot: Snapshot) -> List[Command]:
        """Commands that load every model into a new engine, in the states of a snapshot."""
        entities = self._session.registry.entities()
        return [*(load_command(entity, entity.saved(snapshot)) for entity in entities),
                *self._connections.commands(self._session.registry)]


def load_command(entity: Entity, state: Optional[ModelState] = None) -> LoadModel:
    """The command that loads an entity, at its initial pose or in a state."""
    model = without_missing_meshes(entity.model, entity.meshes)
    return LoadModel(entity.model_id, model, entity.initial_pose,
                     entity.first_link_row, entity.first_joint_row, entity.meshes, state,
                     articulated=entity.articulated)
