"""Make constraints for joints outside the tree: closed loops, screws, gearboxes, mimics."""
from __future__ import annotations

import math
from typing import Dict, List, Optional, Sequence, Tuple

import pybullet

from ...description.model import WORLD, Joint, Model
from ...geometry import Pose, Vec3, compose, inverse, rotate, scale, transform
from ..body_plan import NO_LINK, BodyPlan
from .bodies import Axis, Body, Part
from .constraint_book import ConstraintBook, Number

_FORCE = 1e7          # N or N m: largest force or torque of a closed loop or a gear
_HINGE_LENGTH = 0.1   # m between the two points that represent a hinge
_LEAST_RADIUS = 0.01  # m, of the points that represent a fixed joint
_ERP = 0.2

End = Tuple[Body, Part]
"""A link as the end of a joint."""


def connect_links(book: ConstraintBook, joint: Joint, child: End, child_from_joint: Pose,
                  parent: Optional[End], parent_from_joint: Pose) -> List[Number]:
    """Connect two links like a joint, without limits and other properties of its axes.

    PyBullet has no hinge between bodies; two point-to-point constraints represent one. Universal
    joints act as ball joints. Prismatic joints require links of articulated bodies. Only type and
    axis of the joint are used; its frame is given in the frames of both links, or of the world for
    `parent` None. Returns the numbers of the constraints in the book.
    """
    points: List[Vec3] = [(0.0, 0.0, 0.0)]
    kind = {"fixed": pybullet.JOINT_FIXED, "prismatic": pybullet.JOINT_PRISMATIC}.get(
        joint.type, pybullet.JOINT_POINT2POINT)
    axis = joint.axis.xyz if joint.axis is not None else (0.0, 0.0, 1.0)
    if joint.type in ("revolute", "continuous"):
        points = [scale(axis, half * _HINGE_LENGTH) for half in (-0.5, 0.5)]
    elif joint.type == "fixed" and (child[0].rigid or (parent is not None and parent[0].rigid)):
        kind = pybullet.JOINT_POINT2POINT  # "fixed" constrains rotations of rigid bodies wrongly
        points = _about_the_centre(child[1], child_from_joint)
    return [_add_constraint(book, child, compose(child_from_joint, Pose(at)), parent,
                            compose(parent_from_joint, Pose(at)), kind, axis) for at in points]


def _about_the_centre(part: Part, link_from_joint: Pose) -> List[Vec3]:
    """Return three points around a link's centre of mass, in the joint frame.

    Their distance is the mean radius of gyration: a correction of one then moves the others least.
    """
    radius = max(_LEAST_RADIUS, (sum(part.moments) / max(part.mass, 1e-9) / 2.0) ** 0.5)
    joint_from_com = compose(inverse(link_from_joint), part.link_from_com)
    turns = (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)
    return [transform(joint_from_com, (radius * math.cos(turn), radius * math.sin(turn), 0.0))
            for turn in turns]


def _add_constraint(book: ConstraintBook, one: End, mine: Pose, other: Optional[End], theirs: Pose,
                    kind: int, axis: Vec3) -> Number:
    (body, part), uid, index = one, -1, -1
    mine = compose(inverse(part.link_from_com), mine)
    if other is not None:
        theirs = compose(inverse(other[1].link_from_com), theirs)
        uid, index = other[0].uid, other[1].index
        if body.rigid and not other[0].rigid:  # PyBullet requires the articulated body first
            (body, part), uid, index = other, body.uid, part.index
            mine, theirs = theirs, mine
    is_rigid = body.rigid and (other is None or other[0].rigid)
    return book.make(is_rigid, (
        body.uid, part.index, uid, index, kind, rotate(mine.orientation, axis), mine.position,
        theirs.position, mine.orientation, theirs.orientation), maxForce=_FORCE)


class Constraints:
    """The constraints of one model; call `remove` before its bodies are removed.

    Attributes:
        closing: constraints of joints that close loops: numbers in the book by joint name.
    """

    def __init__(self, book: ConstraintBook, model: Model, plans: Sequence[BodyPlan],
                 bodies: Sequence[Body], pose: Pose, open_joints: Sequence[Joint],
                 first_row: int) -> None:
        self._book = book
        self._model = model
        self._pose = pose
        self._parts = {part.row - first_row: (body, part)
                       for body in bodies for part in body.parts}
        self._axes = {(axis.name, axis.number): (body, axis)
                      for body in bodies for axis in body.axes}
        self._made: List[int] = []
        self.closing: Dict[str, List[int]] = {}
        for joint in open_joints:
            if joint.type == "gearbox":
                self._gearbox(joint)
            else:
                self._close(joint)
        for plan, body in zip(plans, bodies):
            self._screws(plan, body)
        self._mimics()

    def end(self, name: str) -> Optional[End]:
        """A link of the model by its name; None for the world."""
        return self._end(name)

    def remove(self) -> None:
        self._book.remove(self._made)
        self._made.clear()

    # -- loops -----------------------------------------------------------------------------------

    def _close(self, joint: Joint) -> None:
        parent, child = self._end(joint.parent), self._end(joint.child)
        at = self._model_from_joint(joint)
        made: List[int] = []
        if child is not None:
            made = connect_links(self._book, joint, child, self._seen_from(child, at), parent,
                                 compose(self._pose, at) if parent is None
                                 else self._seen_from(parent, at))
        elif parent is not None:
            made = connect_links(self._book, joint, parent, self._seen_from(parent, at), None,
                                 compose(self._pose, at))
        self._made += made
        self.closing[joint.name] = made

    def _seen_from(self, end: End, at: Pose) -> Pose:
        """Return a pose given in the model frame in the frame of a link, at joint positions 0."""
        index = next(n for n, (_, other) in self._parts.items() if other is end[1])
        return compose(inverse(self._model.links[index].pose), at)

    def _end(self, name: str) -> Optional[End]:
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
        """Constrain two axes of one body: follower + ratio leader = target."""
        if follower[0].uid != leader[0].uid:
            return
        self._made.append(self._book.make(False, (
            follower[0].uid, follower[1], leader[0].uid, leader[1], pybullet.JOINT_GEAR,
            (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            gearRatio=ratio, maxForce=_FORCE, erp=_ERP, relativePositionTarget=target))

    def _screws(self, plan: BodyPlan, body: Body) -> None:
        """Constrain screws to thread_pitch rad per metre; positive is left-handed in Gazebo."""
        offset = 0 if plan.fixed_base else 1
        for n, node in enumerate(plan.links[:-1]):
            following = plan.links[n + 1]
            if node.index == NO_LINK and node.joint is not None and node.joint.type == "screw":
                turning, sliding = n - offset, n + 1 - offset
                if node.kind == "prismatic":
                    turning, sliding = sliding, turning
                assert following.joint is node.joint
                pitch = node.joint.thread_pitch
                self._gear((body, turning), (body, sliding), pitch)
                for axis in body.axes:
                    if axis.index == turning and pitch:
                        axis.follower = sliding, -1.0 / pitch
                    elif axis.index == sliding:
                        axis.follower = turning, -pitch

    def _gearbox(self, joint: Joint) -> None:
        """Constrain theta2 = -ratio theta1: angles of child and parent to the reference link."""
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

