"""A model in the world: its description, its rows in the ring, and its state there."""
from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Dict, Iterator, List, Optional, Tuple

from ..description.advice import reach_of
from ..description.cost_budget import Cost
from ..description.model import Joint, Model
from ..description.model_plugins import has_plugins
from ..description.saved_state import InitialState
from ..description.shapes import MeshTable
from ..engine.commands import LinkState, ModelState
from ..engine.ring import Snapshot
from ..engine.ring_rows import AXES, axis_rows, row_name
from ..geometry import IDENTITY, STILL, Pose, Twist, compose, inverse
from .nested_models import NestedModel, find_nested_models


@dataclass
class Entity:
    """A model in the world.

    Attributes:
        model_id: its id in the engine.
        model: flattened description.
        initial_pose: world pose of the model frame that a reset restores.
        first_link_row, first_joint_row: its first rows in the ring's tables.
        meshes: its collision meshes, kept for a restart of the engine.
        pose: world pose of a model without links; that of others is in the ring.
        articulated: built as an articulated body, for a prismatic joint to another model.
        launched: spawned by the launch file that started the simulator, and spawned again by it at
            the next start.
        spawn_id: identifies its spawn; an edit of the model keeps it.
        start: how it moves at its start, from a saved state; None for at rest.
        cost: its part of the world's budget.
    """

    model_id: int
    model: Model
    initial_pose: Pose
    first_link_row: int
    first_joint_row: int
    meshes: MeshTable = field(default_factory=dict)
    pose: Pose = IDENTITY
    articulated: bool = False
    launched: bool = False
    start: Optional[InitialState] = None
    cost: Cost = Cost()

    def __post_init__(self) -> None:
        self.pose = self.initial_pose
        self.spawn_id = self.model_id
        self.link_names = [link.name for link in self.model.links]
        self.joint_names = [row.name for row in axis_rows(self.model)]
        self.has_plugins = has_plugins(self.model)
        self.canonical = 0
        self.link_from_model = IDENTITY
        link = self.model.frame_link
        if link is not None:
            self.canonical = self.link_names.index(link.name)
            self.link_from_model = inverse(link.pose)

    @cached_property
    def reaches(self) -> List[float]:
        """The radius about the origin of each link that contains its shapes (`reach_of`), m."""
        return list(map(reach_of, self.model.links))

    @cached_property
    def joints_by_name(self) -> Dict[str, Tuple[Joint, int]]:
        """All joints, fixed ones too: joint and axis number; `joint::1` for the second axis."""
        return {row_name(joint.name, number): (joint, number)
                for joint in reversed(self.model.joints)
                for number in range(max(1, AXES.get(joint.type, 0)))}

    @cached_property
    def nested(self) -> Dict[str, NestedModel]:
        """Its nested models by scoped name within the model."""
        return find_nested_models(self.model)

    @cached_property
    def scoped_links(self) -> Tuple[str, ...]:
        """`model::link` of each link, in the order of `link_names`."""
        return tuple(f"{self.model.name}::{link}" for link in self.link_names)

    @cached_property
    def scoped_joints(self) -> Tuple[str, ...]:
        """`model::joint` of each joint axis, in the order of `joint_names`."""
        return tuple(f"{self.model.name}::{joint}" for joint in self.joint_names)

    @property
    def canonical_row(self) -> int:
        """Row of the link that carries the model frame."""
        return self.first_link_row + self.canonical

    @property
    def link_ids(self) -> range:
        """Ids of its links in feeds of poses and states, in the order of `link_names`."""
        return range(self.first_link_row, self.first_link_row + len(self.link_names))

    @property
    def joint_rows(self) -> range:
        """Rows of its joint axes, in the order of `joint_names`."""
        return range(self.first_joint_row, self.first_joint_row + len(self.joint_names))

    def link_state(self, snapshot: Snapshot, link: str) -> Tuple[Pose, Twist]:
        """World pose and twist of a link by its name in the model. Raises ValueError."""
        return snapshot.link(self.first_link_row + self.link_names.index(link))

    def axis_states(self, snapshot: Snapshot) -> Iterator[Tuple[str, int, float, float]]:
        """Joint, axis number, position (rad or m) and rate (rad/s or m/s) of all joint axes."""
        for n, axis in enumerate(axis_rows(self.model)):
            yield (axis.joint.name, axis.number, *snapshot.joint(self.first_joint_row + n))

    def has_link_row(self, row: int) -> bool:
        return 0 <= row - self.first_link_row < len(self.link_names)

    def has_joint_row(self, row: int) -> bool:
        """Whether a row of the joint table is one of its axes."""
        return 0 <= row - self.first_joint_row < len(self.joint_names)

    def axis_row(self, joint: str, number: int) -> Optional[int]:
        """Row of an axis of a joint; None for a fixed joint."""
        name = row_name(joint, number)
        return (self.first_joint_row + self.joint_names.index(name)
                if name in self.joint_names else None)

    def rows_in(self, successor: "Entity") -> Tuple[Dict[int, int], Dict[int, int]]:
        """Return the rows of its links and axes in a successor, by row, if that has them too."""
        links = {row: successor.first_link_row + successor.link_names.index(name)
                 for row, name in zip(self.link_ids, self.link_names)
                 if name in successor.link_names}
        axes = {row: successor.first_joint_row + successor.joint_names.index(name)
                for row, name in zip(self.joint_rows, self.joint_names)
                if name in successor.joint_names}
        return links, axes

    def state(self, snapshot: Snapshot) -> Tuple[Pose, Twist]:
        """World pose of the model frame, twist of the canonical link at its origin."""
        if not self.link_names:
            return self.pose, STILL
        pose, twist = snapshot.link(self.canonical_row)
        if self.link_from_model is not IDENTITY and self.link_from_model != IDENTITY:
            pose = compose(pose, self.link_from_model)
        return pose, twist

    def saved(self, snapshot: Snapshot) -> ModelState:
        """State of all links and joints in `snapshot`, for the engine to restore."""
        links = tuple(LinkState(*snapshot.link(self.first_link_row + n))
                      for n in range(len(self.link_names)))
        joints = tuple(snapshot.joint(self.first_joint_row + n)
                       for n in range(len(self.joint_names)))
        return ModelState(links, joints)
