"""Joints of models in a running world: found by name, read, set, edited."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Dict, List, Optional, Sequence, Tuple

from ..description.model import Joint
from ..engine.commands import Command, JointWrench, ReadJointWrenches, SetAxes, SetJoints
from ..engine.ring_rows import axis_rows
from .entity import Entity
from .models import Models
from .session import Session


class Joints:
    """Joints by plain or scoped name. Edits take the structure lock, the rest the registry lock."""

    def __init__(self, session: Session, models: Models) -> None:
        self._session = session
        self._models = models

    def find(self, name: str) -> Tuple[str, Joint, int]:
        """Model name, joint and axis number of a joint, fixed ones too.

        `joint::1` is the second axis. Models are searched in order. Raises UnknownEntityError.
        """
        with self._session.registry_lock:
            entity, joint, number = self._session.registry.joint(name)
            return entity.model.name, joint, number

    def states(self, name: str) -> List[Tuple[float, float]]:
        """Position (rad or m) and rate (rad/s or m/s) of each axis of a joint; none of a fixed one.

        Raises UnknownEntityError.
        """
        self._session.await_posted()
        with self._session.registry_lock:
            entity, joint, _ = self._session.registry.joint(name)
            snapshot = self._session.snapshot()
            return [snapshot.joint(row) for row in (entity.axis_row(joint.name, number)
                                                    for number in (0, 1)) if row is not None]

    def wrenches(self, names: Sequence[str]) -> List[Optional[JointWrench]]:
        """What joints (fixed ones too) transmitted in the last step, in one question to the engine.

        A joint is measured from the step after its first reading on: the first answer is None, and
        so is the one after a reset, a change of its model, or a crash of the engine. None for ever
        for joints between models.

        Raises UnknownEntityError, CommandError.
        """
        with self._session.registry_lock:
            found = [self._session.registry.joint(name) for name in names]
        answer = self._session.call(ReadJointWrenches(tuple(
            (entity.model_id, joint.name) for entity, joint, _ in found))).value
        return list(answer) if isinstance(answer, tuple) else [None] * len(found)

    def row(self, name: str) -> int:
        """The row of a joint axis. Raises UnknownEntityError."""
        with self._session.registry_lock:
            return self._session.axis_row(name)

    def set_positions(self, positions: Dict[str, float],
                      rates: Optional[Dict[str, float]] = None) -> None:
        """Move joint axes to positions (rad or m); within their limits, as Gazebo does.

        Args:
            positions: by name.
            rates: rad/s or m/s of some of these axes; 0 for the others.

        Raises:
            UnknownEntityError: a joint does not exist.
            CommandError: the engine rejected a position.
        """
        session = self._session

        def look_up() -> Command:
            found = [session.registry.movable_joint(name) for name in positions]
            return SetJoints(tuple(
                (row, _clamp_to_limits(entity, row, value), (rates or {}).get(name, 0.0))
                for (entity, row), (name, value) in zip(found, positions.items())),
                             tuple(sorted({entity.model_id for entity, _ in found})))

        session.call_looked_up(look_up)

    def edit(self, name: str, joint: Joint) -> None:
        """Change the axes (limits, friction, damping, spring, motor) or the type of a joint.

        Raises CommandError if the engine rejects it; then nothing has changed.
        """
        session = self._session
        with session.structure_lock:
            with session.registry_lock:
                entity, old, _ = session.registry.joint(name)
            joints = [joint if one.name == old.name else one for one in entity.model.joints]
            model = replace(entity.model, joints=joints)
            if _fixed_properties(joint) != _fixed_properties(old):
                self._models.edit(entity.model.name, model)
                return
            session.call(SetAxes(entity.model_id, tuple(joints)))
            changed = replace(entity, model=model)
            changed.pose = entity.pose
            with session.registry_lock:
                session.registry.swap(entity, changed)


def _clamp_to_limits(entity: Entity, row: int, position: float) -> float:
    """Return the allowed position of an axis that is nearest; NaN and infinity stay."""
    found = axis_rows(entity.model)[row - entity.first_joint_row]
    axis = found.joint.axis2 if found.number else found.joint.axis
    if axis is None or found.joint.type == "continuous" or axis.lower > axis.upper or (
            not math.isfinite(position)):
        return position
    return min(max(position, axis.lower), axis.upper)


def _fixed_properties(joint: Joint) -> Tuple[object, ...]:
    """The properties of a joint that the engine cannot change without building the model again."""
    return (joint.name, joint.type, joint.parent, joint.child, joint.pose, joint.thread_pitch,
            joint.gearbox_ratio, joint.gearbox_reference,
            *((axis.xyz, axis.mimic) if axis is not None else None
              for axis in (joint.axis, joint.axis2)))
