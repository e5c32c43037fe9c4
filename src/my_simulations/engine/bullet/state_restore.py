"""Restore the states of models: after a reset or a crash, or from the model that they replace."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np
import pybullet

from ...description.model import Model
from ...geometry import Pose, compose, conjugate, inverse, multiply, rotate, subtract, twist_at
from ..commands import LinkState, ModelState
from ..ring_rows import axis_rows, row_name
from . import bodies
from .bodies import Body
from .body_builder import Builder
from .joint_constraints import Constraints
from .link_states import read_com_pose
from .state_readout import StateReadout


@dataclass
class Entry:
    """A model in the engine; `pose` is where its frame was put when it was built."""

    model: Model
    builder: Builder
    bodies: List[Body]
    first_row: int
    pose: Pose
    constraints: Constraints


Start = Tuple[Entry, Pose]
"""A model, and the initial world pose of its frame."""


def store_initial_rows(readout: StateReadout, starts: Sequence[Start]) -> None:
    """Store the table rows of models that were just built; no step may have been made since.

    The same builder and the same pose give the same rows, bit for bit.
    """
    readout.read()
    for entry, pose in starts:
        built = entry.builder
        built.initial_rows = (pose, readout.links[built.link_rows].copy(),
                              readout.joints[built.joint_rows].copy())


def show_initial_rows(readout: StateReadout, starts: Sequence[Start]) -> bool:
    """Write the stored rows to the tables; return False and write none if any is missing."""
    if any(entry.builder.initial_rows is None or entry.builder.initial_rows[0] != pose
           for entry, pose in starts):
        return False
    for built in (entry.builder for entry, _ in starts):
        if built.initial_rows is not None:
            _, readout.links[built.link_rows], readout.joints[built.joint_rows] = built.initial_rows
    return True


def restore(entry: Entry, state: ModelState) -> None:
    """Set the state of a new model; its links and joint axes are in the description's order."""
    rates = {row.name: values
             for row, values in zip(axis_rows(entry.model), state.joints)}
    for body in entry.bodies:
        link = state.links[body.parts[0].row - entry.first_row]
        if body.base is not None:
            bodies.set_pose(body, link.pose)
        for axis in body.axes:
            bodies.set_axis_state(body, axis, *rates[row_name(axis.name, axis.number)])
        for ball in body.ball_joints:
            set_ball_joint(body, ball, entry.pose, lambda row: state.links[row - entry.first_row])
        if body.base is None:
            _restore_base(body, link.pose)
        elif body.moves:
            bodies.set_base_twist(body, link.pose, link.twist)


def _restore_base(body: Body, link_pose: Pose) -> None:
    """Set the pose of the fixed base so that the first link has its pose."""
    base = Pose(*pybullet.getBasePositionAndOrientation(body.uid))
    part = body.parts[0]
    base_from_com = compose(inverse(base), Pose(*read_com_pose(body.uid, part.index)))
    target = compose(part.com_pose(link_pose), inverse(base_from_com))
    if not _nearly(base, target):
        pybullet.resetBasePositionAndOrientation(body.uid, target.position,
                                                 target.orientation)


def set_ball_joint(body: Body, ball: bodies.BallJoint, base: Pose,
             state_of: Callable[[int], LinkState]) -> None:
    """Set orientation and rate of a ball joint to match the links that it connects.

    Args:
        body: whose joint it is.
        ball: the joint.
        base: the pose of a fixed base.
        state_of: returns the state of a link row.
    """
    child = state_of(ball.child.row)
    mine, spin, theirs = ball.child.com_pose(child.pose), child.twist.angular, base
    if ball.parent is not None:
        parent = state_of(ball.parent.row)
        theirs = ball.parent.com_pose(parent.pose)
        spin = subtract(spin, parent.twist.angular)
    between = multiply(conjugate(theirs.orientation), mine.orientation)
    pybullet.resetJointStateMultiDof(
        body.uid, ball.index, targetValue=multiply(ball.zero, between),
        targetVelocity=rotate(conjugate(mine.orientation), spin))


def inherited(before: Entry, model: Model, frame: Pose, state_of: Callable[[int], LinkState],
              axis_table: np.ndarray) -> ModelState:
    """Return the state of a model for another one that replaces it, by names of links and joints.

    Args:
        before: the model to be replaced, with its frame at `frame`.
        model: the new one. Its links and joints without a predecessor have their initial state.
        frame: see `before`.
        state_of: returns the state of a link row.
        axis_table: (rows, 2), positions and rates.
    """
    rows = {link.name: before.first_row + n for n, link in enumerate(before.model.links)}
    poses = {link.name: link.pose for link in before.model.links}
    states = []
    for link in model.links:
        if link.name not in rows:
            states.append(LinkState(compose(frame, link.pose)))
            continue
        state = state_of(rows[link.name])
        if link.pose != poses[link.name]:
            shift = compose(inverse(poses[link.name]), link.pose)
            state = LinkState(compose(state.pose, shift),
                              twist_at(state.twist, rotate(state.pose.orientation,
                                                           shift.position)))
        states.append(state)
    axes: Dict[str, Any] = {
        row_name(axis.name, axis.number): tuple(axis_table[axis.row].tolist())
        for body in before.bodies for axis in body.axes}
    return ModelState(tuple(states), tuple(
        axes.get(row.name, (0.0, 0.0)) for row in axis_rows(model)))


def _nearly(one: Pose, other: Pose) -> bool:
    return all(abs(a - b) < 1e-9 for a, b in zip((*one.position, *one.orientation),
                                                   (*other.position, *other.orientation)))
