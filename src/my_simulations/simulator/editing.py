"""Changing models that are in the world: their description, not only their state."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional, Tuple

from ..description.flatten import flattened
from ..description.model import Inertial, Joint, Model
from ..description.shapes import MeshTable
from ..engine.commands import (
    AddLoads,
    Batch,
    Command,
    Contact,
    Load,
    ReadContacts,
    RemoveModel,
    SetAxes,
)
from ..errors import CommandError
from .core import WorldCore
from .registry import Entity


class ModelEdits(WorldCore):
    """New descriptions for models that stay where they are."""

    def edit_model(self, name: str, model: Model, meshes: Optional[MeshTable] = None) -> None:
        """Give a model another description; what is in both keeps its state.

        Links keep pose and twist (moved along when their pose in the model differs), joints
        position and rate, timed loads go on, and bodies that rested on it wake.

        Args:
            name: of the model now.
            model: what it becomes; another name renames it. Its pose is not looked at: the model
                stays, and a reset takes it to where it was loaded.
            meshes: collision meshes by `mesh_key`; those it has are kept.

        Raises:
            CommandError: unknown or taken name, or the engine refused it; nothing has changed.
        """
        if not model.name:
            raise CommandError("a model needs a name")
        model = flattened(model)
        with self._order:
            with self._lock:
                old = self._registry.model(name)
                if model.name != name:
                    self._check_free(model.name)
            parts = self._solids.of(model, {**old.meshes, **(meshes or {})})
            with self._lock:
                entity = self._make(model, old.initial_pose, parts, self._connections)
            entity.pose, entity.articulated = old.pose, old.articulated
            entity.launched = old.launched
            loads = self._loads_of(old, entity)
            commands: List[Command] = [replace(self._loading(entity), inherit=old.model_id),
                                       RemoveModel(old.model_id),
                                       *self._connections.commands(self._registry, name, entity)]
            try:
                self._call(Batch(tuple(commands + ([AddLoads(tuple(loads))] if loads else []))))
            except CommandError:
                with self._lock:
                    self._free(entity)
                raise
            with self._lock:
                self._registry.swap(old, entity)
                self._connections = self._connections.renamed(
                    name, model.name).present(self._registry)
                self._free(old)
            self._loads.update({load.load_id: load for load in loads})
            self._held = [model.name if held == name else held for held in self._held]
            if model.name in self._held:
                self._call(self._holding())

    def _check_free(self, name: str) -> None:
        if name in self._registry or any(light.name == name for light in self.world.lights):
            raise CommandError(f"there is a model or light '{name}' already")

    def _loads_of(self, old: Entity, new: Entity) -> List[Load]:
        """The timed loads on a model, for the rows of its successor."""
        links = {old.first_link_row + n: new.first_link_row + new.link_names.index(name)
                 for n, name in enumerate(old.link_names) if name in new.link_names}
        joints = {old.first_joint_row + n: new.first_joint_row + new.joint_names.index(name)
                  for n, name in enumerate(old.joint_names) if name in new.joint_names}
        now = self.step()
        return [replace(load, row=(links if load.effort is None else joints)[load.row])
                for load in self._loads.values()
                if load.stop > now and load.row in (links if load.effort is None else joints)]

    # -- links -----------------------------------------------------------------------------------

    def set_link_inertial(self, link: str, inertial: Inertial,
                          gravity: Optional[bool] = None) -> None:
        """Give a link (plain or scoped name) another inertia; `gravity` None keeps that flag.

        Raises CommandError.
        """
        with self._order:
            with self._lock:
                entity, index = self._registry.link(link)
            links = list(entity.model.links)
            old = links[index]
            links[index] = replace(old, inertial=inertial,
                                   gravity=old.gravity if gravity is None else gravity)
            self.edit_model(entity.model.name, replace(entity.model, links=links))

    # -- joints ----------------------------------------------------------------------------------

    def find_joint(self, name: str) -> Tuple[str, Joint, int]:
        """Model name, joint and axis number of a joint by plain or scoped name, fixed ones too.

        `joint::1` is the second axis. Models are searched in order. Raises UnknownEntity.
        """
        with self._lock:
            entity, joint, number = self._registry.joint(name)
            return entity.model.name, joint, number

    def joint_states(self, name: str) -> List[Tuple[float, float]]:
        """(position, rate) of each axis of a joint; none of a fixed one. Raises UnknownEntity."""
        with self._lock:
            entity, joint, _ = self._registry.joint(name)
            snapshot = self._snapshot()
            return [snapshot.joint(row) for row in (entity.axis_row(joint.name, number)
                                                    for number in (0, 1)) if row is not None]

    def edit_joint(self, name: str, joint: Joint) -> None:
        """Give a joint other axes (limits, friction, damping, spring, motor) or another form.

        Raises CommandError; then nothing has changed.
        """
        with self._order:
            with self._lock:
                entity, old, _ = self._registry.joint(name)
            joints = [joint if one.name == old.name else one for one in entity.model.joints]
            model = replace(entity.model, joints=joints)
            if _form(joint) != _form(old):
                self.edit_model(entity.model.name, model)
                return
            self._call(SetAxes(entity.model_id, tuple(joints)))
            changed = replace(entity, model=model)
            changed.pose = entity.pose
            with self._lock:
                self._registry.swap(entity, changed)

    # -- looking and holding ---------------------------------------------------------------------

    def hold(self, names: List[str]) -> None:
        """Hold these models at rest where they are put, and let go of all others.

        Raises UnknownEntity.
        """
        with self._order:
            with self._lock:
                for name in names:
                    self._registry.model(name)
            self._held = list(names)
            self._call(self._holding())

    def contacts(self) -> List[Tuple[str, str, Contact]]:
        """The contacts of the last step, with the scoped names of both links."""
        found = self._call(ReadContacts()).value
        with self._lock:
            names = {entity.first_link_row + n: f"{entity.model.name}::{link}"
                     for entity in self._registry.entities()
                     for n, link in enumerate(entity.link_names)}
        return [(names[contact.row_a], names[contact.row_b], contact)
                for contact in (found if isinstance(found, tuple) else ())
                if contact.row_a in names and contact.row_b in names]


def _form(joint: Joint) -> tuple:
    """What of a joint the engine cannot change in place."""
    return (joint.name, joint.type, joint.parent, joint.child, joint.pose, joint.thread_pitch,
            joint.gearbox_ratio, joint.gearbox_reference,
            *((axis.xyz, axis.mimic) if axis is not None else None
              for axis in (joint.axis, joint.axis2)))
