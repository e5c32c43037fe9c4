"""What a tree of joints cannot say: closed loops, screws, gearboxes, axes that follow others."""
from __future__ import annotations

from typing import List, Optional, Sequence, Tuple

import pybullet

from ...description.model import WORLD, Joint, Model
from ...geometry import Pose, Vec3, compose, inverse, scale
from ..plan import NO_LINK, BodyPlan
from .bodies import Axis, Body, Part

_FORCE = 1e7          # N or N m: what a closed loop or a gear may need
_HINGE_LENGTH = 0.1   # m between the two points that stand for a hinge
_ERP = 0.2


class Constraints:
    """The constraints of one model; `remove` before its bodies go."""

    def __init__(self, model: Model, plans: Sequence[BodyPlan], bodies: Sequence[Body],
                 pose: Pose, open_joints: Sequence[Joint], first_row: int) -> None:
        self._model = model
        self._pose = pose
        self._parts = {part.row - first_row: (body, part)
                       for body in bodies for part in body.parts}
        self._axes = {(axis.name, axis.number): (body, axis)
                      for body in bodies for axis in body.axes}
        self._made: List[int] = []
        for joint in open_joints:
            if joint.type == "gearbox":
                self._gearbox(joint)
            else:
                self._close(joint)
        for plan, body in zip(plans, bodies):
            self._screws(plan, body)
        self._mimics()

    def remove(self) -> None:
        """Take them out."""
        for made in self._made:
            pybullet.removeConstraint(made)
        self._made.clear()

    # -- loops -----------------------------------------------------------------------------------

    def _close(self, joint: Joint) -> None:
        """A joint that would close a loop, as points that stay together."""
        parent, child = self._end(joint.parent), self._end(joint.child)
        model_from_joint = self._model_from_joint(joint)
        if parent is None and child is None:
            return
        if child is None:
            parent, child = child, parent
        assert child is not None
        offsets: List[Vec3] = [(0.0, 0.0, 0.0)]
        if joint.type in ("revolute", "continuous") and joint.axis is not None:
            offsets = [scale(joint.axis.xyz, half * _HINGE_LENGTH) for half in (-0.5, 0.5)]
        kinds = {"fixed": pybullet.JOINT_FIXED, "prismatic": pybullet.JOINT_PRISMATIC}
        kind = kinds.get(joint.type, pybullet.JOINT_POINT2POINT)
        for offset in offsets:
            at = compose(model_from_joint, Pose(offset))
            self._tie(child, parent, at, kind,
                      joint.axis.xyz if joint.axis is not None else (0.0, 0.0, 0.0))

    def _tie(self, one: Tuple[Body, Part], other: Optional[Tuple[Body, Part]], at: Pose,
             kind: int, axis: Vec3) -> None:
        """Tie a link to another, or to the world, at a pose of the model frame."""
        (body, part), mine = one, self._seen_from(one, at)
        theirs, other_uid, other_index = compose(self._pose, at), -1, -1
        if other is not None:
            theirs = self._seen_from(other, at)
            other_uid, other_index = other[0].uid, other[1].index
            if body.rigid and not other[0].rigid:  # PyBullet wants the articulated body first
                body, part, mine, theirs, other_uid, other_index = (
                    *other, theirs, mine, body.uid, part.index)
        made = pybullet.createConstraint(
            body.uid, part.index, other_uid, other_index, kind, axis, mine.position,
            theirs.position, mine.orientation, theirs.orientation)
        pybullet.changeConstraint(made, maxForce=_FORCE)
        self._made.append(made)

    def _seen_from(self, end: Tuple[Body, Part], at: Pose) -> Pose:
        """A pose of the model frame seen from a link's centre of mass, at joint positions 0."""
        part = end[1]
        index = next(n for n, (_, other) in self._parts.items() if other is part)
        model_from_com = compose(self._model.links[index].pose, part.link_from_com)
        return compose(inverse(model_from_com), at)

    def _end(self, name: str) -> Optional[Tuple[Body, Part]]:
        if name == WORLD:
            return None
        return self._parts[self._index(name)]

    def _index(self, name: str) -> int:
        return next(n for n, link in enumerate(self._model.links) if link.name == name)

    def _model_from_joint(self, joint: Joint) -> Pose:
        if joint.child == WORLD:
            return joint.pose
        return compose(self._model.links[self._index(joint.child)].pose, joint.pose)

    # -- gears -----------------------------------------------------------------------------------

    def _gear(self, follower: Tuple[Body, int], leader: Tuple[Body, int], ratio: float,
              target: float = 0.0) -> None:
        """follower + ratio leader = target, of two axes of one body."""
        if follower[0].uid != leader[0].uid:
            return
        made = pybullet.createConstraint(
            follower[0].uid, follower[1], leader[0].uid, leader[1], pybullet.JOINT_GEAR,
            (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        pybullet.changeConstraint(made, gearRatio=ratio, maxForce=_FORCE, erp=_ERP,
                                  relativePositionTarget=target)
        self._made.append(made)

    def _screws(self, plan: BodyPlan, body: Body) -> None:
        """Turning by thread_pitch rad a metre; positive pitches are left-handed in Gazebo."""
        offset = 0 if plan.fixed_base else 1
        for n, node in enumerate(plan.links[:-1]):
            following = plan.links[n + 1]
            if node.index == NO_LINK and node.joint is not None and node.joint.type == "screw":
                turning, sliding = n - offset, n + 1 - offset
                if node.kind == "prismatic":
                    turning, sliding = sliding, turning
                assert following.joint is node.joint
                self._gear((body, turning), (body, sliding), node.joint.thread_pitch)

    def _gearbox(self, joint: Joint) -> None:
        """theta2 = -ratio theta1: angles of child and parent about the reference link."""
        first = self._axis_between(joint.gearbox_reference, joint.parent)
        second = self._axis_between(joint.gearbox_reference, joint.child)
        if first is not None and second is not None:
            self._gear((second[0], second[1].index), (first[0], first[1].index),
                       joint.gearbox_ratio)

    def _axis_between(self, one: str, other: str) -> Optional[Tuple[Body, Axis]]:
        for joint in self._model.joints:
            if {joint.parent, joint.child} == {one, other}:
                return self._axes.get((joint.name, 0))
        return None

    def _mimics(self) -> None:
        for joint in self._model.joints:
            mimic = joint.axis.mimic if joint.axis is not None else None
            if mimic is None:
                continue
            follower, leader = self._axes.get((joint.name, 0)), self._axes.get((mimic.joint, 0))
            if follower is not None and leader is not None:
                self._gear((follower[0], follower[1].index), (leader[0], leader[1].index),
                           -mimic.multiplier, mimic.offset)

