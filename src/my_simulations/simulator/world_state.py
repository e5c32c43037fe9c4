"""Captured states of all models, to be restored later."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Tuple

from ..description.model import WORLD, Model
from ..description.saved_state import InitialState
from ..engine.commands import Command, ModelState, SetJoints, SetLinkState, SetModelState
from ..engine.ring import Clock, Snapshot
from ..geometry import Pose, Twist, compose
from .entity import Entity


@dataclass(frozen=True)
class CapturedState:
    """State of a model: world pose of its frame, twist of its canonical link, links and joints."""

    pose: Pose
    twist: Twist
    links: Tuple[str, ...]
    state: ModelState


@dataclass(frozen=True)
class WorldState:
    """States by model name, and the clock."""

    step: int
    sim_ns: int
    models: Dict[str, CapturedState]

    @classmethod
    def of(cls, entities: Sequence[Entity], snapshot: Snapshot,
           now: Tuple[int, Clock]) -> "WorldState":
        """The state in a snapshot; `now`: the present step count, if nothing has moved since."""
        step, clock = now
        return cls(step, clock.sim_ns(step), {
            entity.model.name: CapturedState(*entity.state(snapshot), tuple(entity.link_names),
                                          entity.saved(snapshot))
            for entity in entities})

    def commands(self, entities: Sequence[Entity]) -> List[Command]:
        """Commands that restore these models, if their links are still the same."""
        commands: List[Command] = []
        for entity in entities:
            was = self.models.get(entity.model.name)
            if was is None or was.links != tuple(entity.link_names):
                continue
            if not entity.link_names:
                entity.pose = was.pose
            else:
                commands += _commands(entity, was)
        return commands


def _commands(entity: Entity, was: CapturedState) -> List[Command]:
    """Restore an articulated model by its frame and joints, others link by link."""
    model = entity.model
    if model.static or (len(entity.link_names) == 1 and not model.joints):
        return [SetModelState(entity.model_id, was.pose, None if model.static else was.twist)]
    if not model.joints:
        return [SetLinkState(entity.first_link_row + n, link.pose, link.twist)
                for n, link in enumerate(was.state.links)]
    joints = [SetJoints(tuple((entity.first_joint_row + n, position, rate)
                              for n, (position, rate) in enumerate(was.state.joints)))] \
        if was.state.joints else []
    # Joints first: if the frame's link is not the root, it places the links above it. Rates of
    # joints are lost when the model is moved.
    return [*joints, SetModelState(entity.model_id, was.pose, was.twist), *joints]


def initial_commands(entity: Entity, start: Optional[InitialState]) -> List[Command]:
    """Commands that apply a saved initial state to a model that was just loaded.

    A model without joints gets the twist of each link. An articulated model moves as one rigid
    body with the twist of its canonical link, unless a joint connects it to the world; its joint
    rates are zero.
    """
    if start is None or entity.model.static:
        return []
    commands: List[Command] = []
    positions = tuple((entity.first_joint_row + n, start.joints[name], 0.0)
                      for n, name in enumerate(entity.joint_names) if name in start.joints)
    if positions:
        commands.append(SetJoints(positions))
    for n, link in enumerate(entity.model.links):
        twist = start.twists.get(link.name)
        if twist is None:
            continue
        pose = compose(entity.initial_pose, link.pose)
        if not entity.model.joints:
            commands.append(SetLinkState(entity.first_link_row + n, pose, twist))
        elif n == entity.canonical and not _is_jointed_to_world(entity.model):
            commands.append(SetModelState(entity.model_id, entity.initial_pose, twist))
    return commands


def _is_jointed_to_world(model: Model) -> bool:
    return any(joint.parent == WORLD for joint in model.joints)
