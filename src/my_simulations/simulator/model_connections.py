"""Joints between the models of a world, and pins of models."""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import List, Tuple

from ..description.model import Joint
from ..engine.commands import Command, DisconnectModels, PinModels
from .entity import Entity
from .inter_model_joints import InterModelJoints
from .registry import Registry


@dataclass(frozen=True)
class ModelConnections:
    """Joints between models, and the models that are pinned.

    Attributes:
        joints: the joints.
        attached: the names of those that `Models.attach` made.
        pinned, held: names of models, see `Models.pin` and `Models.hold`.
    """

    joints: InterModelJoints = field(default_factory=InterModelJoints)
    attached: Tuple[str, ...] = ()
    pinned: Tuple[str, ...] = ()
    held: Tuple[str, ...] = ()

    @property
    def permanent_joints(self) -> InterModelJoints:
        """The joints between models without those of `Models.attach`, which a reset removes."""
        return self.joints.without_joints(self.attached)

    def without_model(self, model: str) -> "ModelConnections":
        return replace(self, joints=self.joints.without_model(model),
                       pinned=_others(self.pinned, model), held=_others(self.held, model))

    def with_model_renamed(self, old: str, new: str, registry: Registry) -> "ModelConnections":
        """Return the connections after a model was edited, and perhaps renamed."""
        return ModelConnections(
            self.joints.with_model_renamed(old, new, self.attached).with_existing_links(registry),
            self.attached,
            *(tuple(new if name == old else name for name in names)
              for names in (self.pinned, self.held)))

    def with_joint(self, joints: InterModelJoints, name: str) -> "ModelConnections":
        """Return the connections with the joint `name` of `Models.attach`; `joints`: all joints."""
        return replace(self, joints=joints, attached=(*_others(self.attached, name), name))

    def without_joint(self, name: str) -> "ModelConnections":
        return replace(self, joints=self.joints.without_joints((name,)),
                       attached=_others(self.attached, name))

    def detached(self) -> "ModelConnections":
        """Return the connections without the joints of `Models.attach`."""
        return replace(self, joints=self.permanent_joints, attached=())

    def joints_named(self, name: str) -> List[Joint]:
        return self.joints.with_name(name).joints

    def detach_commands(self) -> List[Command]:
        """Commands that remove the joints of `Models.attach` from the engine."""
        return [DisconnectModels(self.attached)] if self.attached else []

    def pin_command(self, registry: Registry) -> PinModels:
        """The command that pins these models, and releases all others."""
        return PinModels(tuple(registry.model(name).model_id
                               for name in dict.fromkeys((*self.pinned, *self.held))
                               if name in registry))

    def pins_with(self, model: str, entity: Entity, registry: Registry) -> List[PinModels]:
        """The command that pins `entity` if the model that it is about to replace is pinned."""
        if model not in (*self.pinned, *self.held):
            return []
        others = self.without_model(model).pin_command(registry)
        return [PinModels((*others.model_ids, entity.model_id))]

    def commands(self, registry: Registry) -> List[Command]:
        """Commands that make the joints and pins in an engine that has loaded the models."""
        commands: List[Command] = list(self.joints.commands(registry))
        if self.pinned or self.held:
            commands.append(self.pin_command(registry))
        return commands


def _others(names: Tuple[str, ...], name: str) -> Tuple[str, ...]:
    return tuple(one for one in names if one != name)
