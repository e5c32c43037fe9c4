"""Set poses, velocities and joint positions, and notify the helpers that store them.

In Gazebo the anchor of a joint to the world stays in the world, and its position follows from the
pose of the link. PyBullet stores joint positions instead, so they are set together with the pose.
"""
from __future__ import annotations

import math
from typing import Callable, Dict, List, Optional, Sequence, Tuple

import pybullet

from ...geometry import (
    STILL,
    Pose,
    Twist,
    Vec3,
    compose,
    conjugate,
    dot,
    inverse,
    multiply,
    norm,
    pose_is_finite,
    rotate,
    rotation_vector,
    subtract,
    twist_at,
)
from ..api import CommandRefusedError, RemovedError
from ..body_plan import BASE
from ..commands import Frame, LinkState, SetJoints, SetLinkState, SetModelState
from ..ring import pose_and_twist
from . import bodies
from .bodies import Axis, Body, Part, axis_states, set_axis_state
from .body_events import BodyEvent
from .link_rows import ROW
from .link_states import read_com_pose
from .row_reader import RowReader
from .state_readout import StateReadout
from .state_restore import Entry, set_ball_joint
from .wake_up import WakeUp

_NEAR = 2e-5
"""m and rad: a pose is valid if the joint allows one this near; saved poses have six digits."""
_SAME = 1e-12   # m and rad: rounding errors

_TYPE, _AXIS, _PARENT = 2, 13, 16     # of pybullet.getJointInfo


class StateSetter:
    """Sets poses and velocities of models, links and joints."""

    def __init__(self, rows: Dict[int, Tuple[Body, Part]], axes: Dict[int, Tuple[Body, Axis]],
                 readout: StateReadout, row_reader: RowReader, waker: WakeUp,
                 notify: Callable[[BodyEvent, Body], None]) -> None:
        """`rows` and `axes` map table rows to bodies; they are read only.

        `notify` is called after the state of a body was set.
        """
        self._row_reader = row_reader
        self._rows = rows
        self._axes = axes
        self._readout = readout
        self._waker = waker
        self._notify = notify

    def link_state(self, row: int) -> LinkState:
        """Return the present state of the link at a row."""
        return LinkState(*pose_and_twist(ROW.unpack(self._row_reader.read_links((row,)))))

    def present_model_pose(self, entry: Entry) -> Pose:
        """Return the present pose of a model frame."""
        if not entry.model.links:
            return entry.pose
        lead = _canonical(entry)
        return compose(self.link_state(entry.first_row + lead).pose,
                       inverse(entry.model.links[lead].pose))

    def set_model(self, command: SetModelState, entry: Entry) -> None:
        """Set the pose and twist of a model. Raises CommandRefusedError."""
        pose, twist = self._in_world(command.pose, command.twist, command.frame)
        if not entry.model.links:
            return
        # As in Gazebo the velocity is that of the canonical link, which is what is read as well.
        row = entry.first_row + _canonical(entry)
        self._move(entry.bodies, row,
                   compose(pose, entry.model.links[row - entry.first_row].pose), twist)

    def set_link(self, command: SetLinkState) -> None:
        """Set the pose and twist of the body of a link. Raises CommandRefusedError."""
        if command.row not in self._rows:
            raise RemovedError("the link no longer exists")
        body, part = self._rows[command.row]
        if body.base is None and not part.link.kinematic:
            raise CommandRefusedError("the link belongs to a body that is joined to the world")
        pose, twist = self._in_world(command.pose, command.twist, command.frame)
        self._move([body], part.row, pose, twist)

    def set_joints(self, command: SetJoints) -> None:
        """Set positions and rates of joint axes; all are checked before any is set.

        Joints that close loops are ignored: they follow from the others. Raises
        CommandRefusedError, RemovedError.
        """
        for row, position, rate in command.joints:
            if row not in self._axes and not self._readout.closes(row):
                raise RemovedError("the joint no longer exists")
            if not (abs(position) < 1e12 and abs(rate) < 1e12):
                raise CommandRefusedError("the joint position is not finite")
        for row, position, rate in command.joints:
            if self._readout.closes(row):
                continue
            body, axis = self._axes[row]
            self._waker.around([body])
            bodies.set_axis_state(body, axis, position, rate)
            self._notify(BodyEvent.STATE_SET, body)

    def put_back(self, body: Body) -> None:
        """Put a body whose state is not finite back to its last finite pose, at rest."""
        def last_pose(row: int) -> Pose:
            return pose_and_twist(self._readout.links[row].tolist())[0]

        if body.base is not None:
            lead = last_pose(body.parts[0].row)
            bodies.set_pose(body, lead)
            bodies.set_base_twist(body, lead, STILL)
        for axis in body.axes:
            bodies.set_axis_state(body, axis, float(self._readout.joints[axis.row, 0]))
        for ball in body.ball_joints:
            base = Pose(*pybullet.getBasePositionAndOrientation(body.uid))
            set_ball_joint(body, ball, base, lambda row: LinkState(last_pose(row)))
        self._notify(BodyEvent.STATE_REPAIRED, body)

    def _in_world(self, pose: Pose, twist: Optional[Twist],
                  frame: Optional[Frame]) -> Tuple[Pose, Optional[Twist]]:
        if not pose_is_finite(pose):
            raise CommandRefusedError("the pose is not finite")
        if frame is None:
            return pose, twist
        if frame.row not in self._rows:
            raise RemovedError("the reference frame no longer exists")
        at = compose(self.link_state(frame.row).pose, frame.offset)
        if twist is not None:
            twist = Twist(rotate(at.orientation, twist.linear),
                          rotate(at.orientation, twist.angular))
        return compose(at, pose), twist

    def _move(self, moved: Sequence[Body], row: int, wanted: Pose,
              twist: Optional[Twist]) -> None:
        """Move bodies as if they were fixed to the link at `row`, which goes to the pose `wanted`.

        `twist` is the velocity there; None keeps it, turned.
        """
        current = self.link_state(row).pose
        self._waker.around(moved)
        for body in moved:
            self._move_body(body, row, current, wanted, twist)
        self._waker.around(moved, awake=True)

    def _move_body(self, body: Body, row: int, current: Pose, wanted: Pose,
                   twist: Optional[Twist]) -> None:
        lead = self.link_state(body.parts[0].row)
        target = lead.pose
        rates = {axis.index: state[1] for axis, state in zip(body.axes, axis_states(body))}
        if body.base is None:
            way = compose(wanted, inverse(current))
            if not _move_by_joints(body, way):
                pybullet.resetBasePositionAndOrientation(body.uid, *compose(
                    way, Pose(*pybullet.getBasePositionAndOrientation(body.uid))))
        else:
            target = wanted if row == body.parts[0].row else compose(
                wanted, compose(inverse(current), lead.pose))
            bodies.set_pose(body, target)
        if twist is not None:
            rates = _first_rates(body, twist) if body.base is None else {}
        for axis, state in zip(body.axes, axis_states(body)):
            set_axis_state(body, axis, state[0], rates.get(axis.index, 0.0))
        if twist is not None:
            bodies.stop_ball_joints(body)
        if body.moves and body.base is not None:
            bodies.set_base_twist(body, target, _carried(lead, target, wanted.position, twist))
        self._notify(BodyEvent.STATE_SET, body)


def _canonical(entry: Entry) -> int:
    """Return the number of the canonical link, which carries the frame of the model."""
    carrier = entry.model.frame_link
    return next((n for n, link in enumerate(entry.model.links) if link is carrier), 0)


def _carried(lead: LinkState, target: Pose, at: Vec3, twist: Optional[Twist]) -> Twist:
    """Return the twist at `target` of a body with `twist` at the point `at`.

    None keeps the twist of `lead`, rotated with the body.
    """
    if twist is None:
        turn = multiply(target.orientation, conjugate(lead.pose.orientation))
        return Twist(rotate(turn, lead.twist.linear), rotate(turn, lead.twist.angular))
    return twist_at(twist, subtract(target.position, at))


def _first_joints(body: Body) -> Dict[int, Optional[Axis]]:
    """Return the joints between a fixed base and its children: indices, and axes if any."""
    axes = {axis.index: axis for axis in body.axes}
    return {index: axes.get(index) for index in range(pybullet.getNumJoints(body.uid))
            if pybullet.getJointInfo(body.uid, index)[_PARENT] == BASE}


def _first_rates(body: Body, twist: Twist) -> Dict[int, float]:
    """Return the rates of first joints for a twist of their links, rad/s or m/s by joint index."""
    return {index: _along(body, index, twist)[0]
            for index, axis in _first_joints(body).items() if axis is not None}


def _along(body: Body, index: int, moved: Twist) -> Tuple[float, bool]:
    """Return the motion or rate of a joint for that of its link, and whether the joint turns.

    rad or m; rad/s or m/s.
    """
    info = pybullet.getJointInfo(body.uid, index)
    turns: bool = info[_TYPE] == pybullet.JOINT_REVOLUTE
    direction = rotate(read_com_pose(body.uid, index)[1], info[_AXIS])
    return dot(direction, moved.angular if turns else moved.linear), turns


def _move_by_joints(body: Body, way: Pose) -> bool:
    """Move a body with a fixed base by setting the joints next to the base; rates become 0.

    `way` maps old world poses to new ones. Returns False, and changes nothing, if the joints do not
    allow it.
    """
    done: List[Tuple[Axis, float]] = []
    for index, axis in _first_joints(body).items():
        before = Pose(*read_com_pose(body.uid, index))
        after = compose(way, before)
        if _is_near(before, after, _SAME if axis is not None else _NEAR):
            continue
        # The rotating half of a screw does not determine the pose of its link.
        if axis is not None and axis.follower is None:
            start: float = pybullet.getJointState(body.uid, index)[0]
            done.append((axis, start))
            travel, turns = _along(body, index, Twist(
                subtract(after.position, before.position),
                rotation_vector(multiply(after.orientation, conjugate(before.orientation)))))
            position = start + travel
            least = math.remainder(position, 2.0 * math.pi)   # as Gazebo has angles
            set_axis_state(body, axis, least if turns and axis.lower <= least <= axis.upper
                     else position)
            if _is_near(Pose(*read_com_pose(body.uid, index)), after, _NEAR):
                continue
        for other, old in done:
            set_axis_state(body, other, old)
        return False
    return True


def _is_near(one: Pose, other: Pose, bound: float) -> bool:
    apart = compose(inverse(one), other)
    return norm(apart.position) < bound and norm(rotation_vector(apart.orientation)) < bound
