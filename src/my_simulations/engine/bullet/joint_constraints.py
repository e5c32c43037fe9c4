"""Make constraints for joints outside the tree: closed loops, screws, gearboxes, mimics, and joints
between models.

PyBullet 3.2 has a fault: when it removes a constraint of a multibody, it also frees the last
constraint of its table if that one is between two rigid bodies (it reads the slot into which the
last one was moved). The next use of the freed constraint crashes the process. So constraints
between rigid bodies are removed first, and made again afterwards.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set, Tuple

import pybullet

from ...description.model import WORLD, Joint, Model
from ...geometry import IDENTITY, Pose, Vec3, compose, inverse, rotate, scale, transform
from ..api import CommandRefusedError, RemovedError
from ..body_plan import BASE, NO_LINK, TIE_TYPES, BodyPlan
from ..commands import ConnectModels
from . import collision_groups
from .bodies import Axis, Body, Part, set_sleep
from .body_events import BodyObserver

_FORCE = 1e7          # N or N m: largest force or torque of a closed loop or a gear
_HINGE_LENGTH = 0.1   # m between the two points that represent a hinge
_LEAST_RADIUS = 0.01  # m, of the points that represent a fixed joint
_ERP = 0.2            # share of the position error of gears that is corrected in each step

End = Tuple[Body, Part]
"""A link as the end of a joint."""

_BodyAxis = Tuple[Body, Axis]


@dataclass(eq=False)
class Constraint:
    """A constraint between two links, rigid bodies or not, and the arguments that make it.

    Attributes:
        made_with: the arguments of pybullet.createConstraint.
        changed_to: the keyword arguments of pybullet.changeConstraint.
        uid: PyBullet's number, which can change.
    """

    is_rigid: bool
    made_with: Tuple[Any, ...]
    changed_to: Mapping[str, Any]
    uid: int = -1

    def make(self) -> None:
        """Create the constraint in PyBullet."""
        self.uid = int(pybullet.createConstraint(*self.made_with))
        pybullet.changeConstraint(self.uid, **self.changed_to)


class ConstraintBook:
    """Stores all constraints of a world; makes and removes them in a safe order (see above).

    Attributes:
        gears: the constraints of gears.
    """

    def __init__(self) -> None:
        self._made: List[Constraint] = []
        self.gears: List[Constraint] = []

    def make(self, is_rigid: bool, made_with: Tuple[Any, ...], **changed_to: Any) -> Constraint:
        """Make a constraint; its arguments are attributes of `Constraint`."""
        made = Constraint(is_rigid, made_with, changed_to)
        made.make()
        self._made.append(made)
        if made_with[4] == pybullet.JOINT_GEAR:
            self.gears.append(made)
        return made

    def remove(self, going: Sequence[Constraint]) -> None:
        """Remove constraints; their bodies must still exist."""
        self._made = [one for one in self._made if one not in going]
        self.gears = [one for one in self.gears if one not in going]
        lifted = [] if all(one.is_rigid for one in going) else [
            one for one in self._made if one.is_rigid]
        for one in (*lifted, *sorted(going, key=lambda each: not each.is_rigid)):
            pybullet.removeConstraint(one.uid)
        for one in lifted:
            one.make()


def connect_links(book: ConstraintBook, joint: Joint, child: End, child_from_joint: Pose,
                  parent: Optional[End], parent_from_joint: Pose) -> List[Constraint]:
    """Connect two links like a joint, without limits and other properties of its axes.

    PyBullet has no hinge between bodies; two point-to-point constraints represent one. Universal
    joints act as ball joints. Prismatic joints require links of articulated bodies. Only type and
    axis of the joint are used; its frame is given in the frames of both links, or of the world for
    `parent` None.
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
                    kind: int, axis: Vec3) -> Constraint:
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
        closing: constraints of joints that close loops, by joint name.
        links: the links of the model by name, as ends of joints.
    """

    def __init__(self, book: ConstraintBook, model: Model, plans: Sequence[BodyPlan],
                 bodies: Sequence[Body], pose: Pose, open_joints: Sequence[Joint],
                 first_row: int) -> None:
        self._book = book
        self._model = model
        self.links: Dict[str, End] = {model.links[part.row - first_row].name: (body, part)
                                      for body in bodies for part in body.parts}
        self._axes = {(axis.name, axis.number): (body, axis)
                      for body in bodies for axis in body.axes}
        self._made: List[Constraint] = []
        self.closing: Dict[str, List[Constraint]] = {}
        for joint in open_joints:
            if joint.type == "gearbox":
                self._gear(self._axis_between(joint.gearbox_reference, joint.child),
                           self._axis_between(joint.gearbox_reference, joint.parent),
                           joint.gearbox_ratio)
            else:
                self._close(joint, pose)
        for plan, body in zip(plans, bodies):
            self._screws(plan, body)
        for joint in model.joints:
            mimic = joint.axis.mimic if joint.axis is not None else None
            if mimic is not None:
                self._gear(self._axes.get((joint.name, 0)), self._axes.get((mimic.joint, 0)),
                           -mimic.multiplier, mimic.offset)

    def remove(self) -> None:
        self._book.remove(self._made)
        self._made.clear()

    def _close(self, joint: Joint, pose: Pose) -> None:
        """Close a loop; `pose`: of the model."""
        poses = {link.name: link.pose for link in self._model.links}
        at = compose(poses.get(joint.child, IDENTITY), joint.pose)
        # The frame of the joint in those of the links, at joint positions 0, or of the world.
        child, parent = sorted((joint.child, joint.parent), key=lambda name: name == WORLD)
        self.closing[joint.name] = connect_links(
            self._book, joint, self.links[child], compose(inverse(poses[child]), at),
            self.links.get(parent),
            compose(pose if parent == WORLD else inverse(poses[parent]), at))
        self._made += self.closing[joint.name]

    def _gear(self, follower: Optional[_BodyAxis], leader: Optional[_BodyAxis], ratio: float,
              target: float = 0.0) -> None:
        """Constrain two axes, if they are in one body: follower + ratio leader = target.

        A gearbox constrains the angles of child and parent to the reference link.
        """
        if follower is not None and leader is not None and follower[0].uid == leader[0].uid:
            self._mesh(follower[0], follower[1].index, leader[1].index, ratio, target)

    def _mesh(self, body: Body, follower: int, leader: int, ratio: float, target: float) -> None:
        """Make the constraint of `_gear`, by PyBullet's indices of the axes."""
        self._made.append(self._book.make(False, (
            body.uid, follower, body.uid, leader, pybullet.JOINT_GEAR,
            (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            gearRatio=ratio, maxForce=_FORCE, erp=_ERP, relativePositionTarget=target))

    def _axis_between(self, one: str, other: str) -> Optional[_BodyAxis]:
        for joint in self._model.joints:
            if {joint.parent, joint.child} == {one, other}:
                return self._axes.get((joint.name, 0))
        return None

    def _screws(self, plan: BodyPlan, body: Body) -> None:
        """Constrain screws to thread_pitch rad per metre; positive is left-handed in Gazebo."""
        offset = 0 if plan.fixed_base else 1
        for n, node in enumerate(plan.links[:-1]):
            if node.index == NO_LINK and node.joint is not None and node.joint.type == "screw":
                turning, sliding = n - offset, n + 1 - offset
                if node.kind == "prismatic":
                    turning, sliding = sliding, turning
                pitch = node.joint.thread_pitch
                self._mesh(body, turning, sliding, pitch, 0.0)
                for axis in body.axes:
                    if axis.index == turning and pitch:
                        axis.follower = sliding, -1.0 / pitch
                    elif axis.index == sliding:
                        axis.follower = turning, -pitch


@dataclass(eq=False)
class _Tie:
    """A joint between two bodies; `ends` has one entry for a joint to the world."""

    name: str
    ends: Tuple[End, ...]
    constraints: List[Constraint]

    @property
    def uids(self) -> Set[int]:
        """PyBullet's numbers of the bodies that are tied."""
        return {body.uid for body, _ in self.ends}

    def count(self, change: int) -> None:
        """Change the number of ties of both bodies by `change`; tied bodies do not sleep."""
        for body, _ in self.ends:
            body.ties += change
            set_sleep(body)

    def set_collision(self, collide: bool) -> None:
        for (body, part), (other, its) in [self.ends] if len(self.ends) == 2 else []:
            for uid in body.uids:
                for near in other.uids:
                    collision_groups.ignore(uid, near, part.index, its.index, not collide)


class InterModelJoints(BodyObserver):
    """Joints between links of different models, or between a rigid body and the world.

    Constraints hold them, so limits, friction, damping, springs and motors of their axes do not
    act. Connected bodies do not sleep, and do not collide with each other (Gazebo behaviour). A
    joint is removed with either of the models that it connects.

    Attributes:
        carried: the rigid bodies that are connected and can move.
    """

    def __init__(self, book: ConstraintBook) -> None:
        self._book = book
        self._ties: List[_Tie] = []
        self.carried: List[Body] = []
        self._anchor: Optional[End] = None

    def connect(self, command: ConnectModels, rows: Dict[int, End]) -> None:
        """Connect two links. Raises CommandRefusedError, RemovedError."""
        joint = command.joint
        if joint.type not in TIE_TYPES:
            raise CommandRefusedError(
                f"joint '{joint.name}' of type {joint.type} cannot connect two models"
            )
        ends = [(command.child_row, command.child_from_joint),
                (command.parent_row, command.parent_from_joint)]
        ends.sort(key=lambda end: end[0] < 0)  # the world last
        if ends[0][0] not in rows or not (ends[1][0] < 0 or ends[1][0] in rows):
            raise RemovedError(f"a link of joint '{joint.name}' no longer exists")
        one = rows[ends[0][0]]
        other = rows[ends[1][0]] if ends[1][0] >= 0 else self._world()
        if joint.type == "prismatic" and (one[0].rigid or other[0].rigid):
            raise CommandRefusedError(
                f"joint '{joint.name}' slides between bodies that are not articulated"
            )
        made = connect_links(self._book, joint, one, ends[0][1], other, ends[1][1])
        tie = _Tie(joint.name, tuple(end for end in (one, other) if end is not self._anchor), made)
        self._ties.append(tie)
        tie.set_collision(False)
        tie.count(1)
        self._update_carried()

    def _world(self) -> End:
        """Return a static body without a shape: constraints of rigid bodies need a second body."""
        if self._anchor is None:
            uid = pybullet.createMultiBody(0.0)
            part = Part(-1, BASE, IDENTITY, 0.0, (0.0, 0.0, 0.0), 0.0, 0.0)
            self._anchor = Body(uid, -1, [part], moves=False, rigid=False, may_sleep=False), part
        return self._anchor

    def forget(self, body: Body) -> None:
        """Remove the joints of a removed body."""
        for tie in [tie for tie in self._ties if body.uid in tie.uids]:
            self._disconnect(tie)
            # Bullet stores pairs that do not collide by body numbers, which new bodies reuse.
            tie.set_collision(True)

    def disconnect(self, names: Sequence[str]) -> List[Body]:
        """Remove joints by name; returns the bodies that they connected, which collide again."""
        found = [tie for tie in self._ties if tie.name in names]
        for tie in found:
            self._disconnect(tie)
            if not any(other.uids == tie.uids for other in self._ties):
                tie.set_collision(True)
        return [body for tie in found for body, _ in tie.ends]

    def _disconnect(self, tie: _Tie) -> None:
        self._ties.remove(tie)
        self._book.remove(tie.constraints)
        tie.count(-1)
        self._update_carried()

    def _update_carried(self) -> None:
        carried = {body.uid: body for tie in self._ties for body, _ in tie.ends
                   if body.rigid and body.moves}
        self.carried = [carried[uid] for uid in sorted(carried)]
