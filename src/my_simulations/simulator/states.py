"""The state of everything, as the state topics show it."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List

from ..engine.ring import Snapshot
from ..geometry import Pose, Twist
from .registry import Entity


@dataclass
class States:
    """Parallel lists: all models in load order, all their links in the description's order.

    Poses and twists are in the world frame; twists at the link origins. A model has the twist of
    its canonical link. `revision` grows when names change, `sequence` when states may have.
    """

    revision: int
    sequence: int
    step: int
    sim_ns: int
    model_names: List[str] = field(default_factory=list)
    model_poses: List[Pose] = field(default_factory=list)
    model_twists: List[Twist] = field(default_factory=list)
    link_names: List[str] = field(default_factory=list)
    link_poses: List[Pose] = field(default_factory=list)
    link_twists: List[Twist] = field(default_factory=list)


def collect(entities: List[Entity], snapshot: Snapshot, revision: int) -> States:
    """The states of `entities` in one snapshot."""
    states = States(revision, snapshot.sequence, snapshot.step, snapshot.sim_ns)
    for entity in entities:
        name = entity.model.name
        pose, twist = entity.state(snapshot)
        states.model_names.append(name)
        states.model_poses.append(pose)
        states.model_twists.append(twist)
        for index, link in enumerate(entity.link_names):
            pose, twist = snapshot.link(entity.first_link_row + index)
            states.link_names.append(f"{name}::{link}")
            states.link_poses.append(pose)
            states.link_twists.append(twist)
    return states
