"""Compute positions and rates of joints that close loops, which have no axis in Bullet.

They follow from the states of the connected links, as for all joints in Gazebo.
"""
from __future__ import annotations

from typing import List, Sequence

import numpy as np

from ...description.joint_positions import has_position, joint_position
from ...description.model import WORLD, Joint, Model
from ...geometry import Pose, Twist, compose, dot, rotate, subtract, twist_at
from ..ring import pose_and_twist
from ..ring_rows import axis_rows


class ClosingJoint:
    """One joint of a loop, with a row of its own in the joint table.

    Args:
        joint: has a single axis.
        model: its model.
        place: the pose of the model's frame where it was built.
        first_link: row of the model's first link.
        row: its own.
    """

    def __init__(self, joint: Joint, model: Model, place: Pose, first_link: int,
                 row: int) -> None:
        self.row = row
        self._joint = joint
        self._rows = {link.name: first_link + n for n, link in enumerate(model.links)
                      if link.name in (joint.parent, joint.child)}
        # Link poses at position 0: in the world for a joint to the world, else in the model.
        frame = place if WORLD in (joint.parent, joint.child) else Pose()
        self._at_zero = {link.name: compose(frame, link.pose) for link in model.links
                         if link.name in self._rows}
        self._at_zero.setdefault(WORLD, Pose())

    def read(self, links: np.ndarray, joints: np.ndarray) -> None:
        """Update its row of the joint table from the link table."""
        poses, twists = {WORLD: Pose()}, {WORLD: Twist()}
        for name, row in self._rows.items():
            poses[name], twists[name] = pose_and_twist(links[row].tolist())
        position = joint_position(self._joint, self._at_zero, poses)
        joints[self.row, 0] = 0.0 if position is None else position
        joints[self.row, 1] = self._rate(poses[self._joint.parent], twists[self._joint.parent],
                                         poses[self._joint.child], twists[self._joint.child])

    def _rate(self, parent: Pose, parents: Twist, child: Pose, childs: Twist) -> float:
        joint = self._joint
        assert joint.axis is not None
        pivot = compose(child, joint.pose)
        axis = rotate(pivot.orientation, joint.axis.xyz)
        if joint.type != "prismatic":
            return dot(axis, subtract(childs.angular, parents.angular))
        ahead = twist_at(childs, subtract(pivot.position, child.position)).linear
        behind = twist_at(parents, subtract(pivot.position, parent.position)).linear
        return dot(axis, subtract(ahead, behind))


def closing_joints(names: Sequence[str], model: Model, place: Pose, first_link: int,
                   first_row: int) -> List[ClosingJoint]:
    """Return those of the named joints that have one axis and a child in the model."""
    return [ClosingJoint(row.joint, model, place, first_link, first_row + n)
            for n, row in enumerate(axis_rows(model))
            if row.joint.name in names and has_position(row.joint) and row.joint.child != WORLD]
