"""Joint positions and velocities that a model starts with, from a saved state."""
from __future__ import annotations

from typing import List, Optional

from ..description.model import WORLD, Model
from ..description.saved_state import InitialState
from ..engine.commands import Command, SetJoints, SetLinkState, SetModelState
from ..geometry import compose
from .entity import Entity


def initial_commands(entity: Entity, start: Optional[InitialState]) -> List[Command]:
    """Commands that apply a saved initial state to a model that was just loaded.

    A model without joints gets the twist of each link. An articulated model moves as one rigid
    body with the twist of its canonical link, unless it hangs on the world; its joint rates are
    zero.
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
        elif n == entity.canonical and not _hangs_on_world(entity.model):
            commands.append(SetModelState(entity.model_id, entity.initial_pose, twist))
    return commands


def _hangs_on_world(model: Model) -> bool:
    return any(joint.parent == WORLD for joint in model.joints)
