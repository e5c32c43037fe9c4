"""Move bodies that a joint connects to the world; the joint position follows within its limits.

In Gazebo the anchor of such a joint stays in the world, and its position follows from the pose of
the link. PyBullet stores joint positions instead, so they are set together with the pose.
"""
from __future__ import annotations

import math
from typing import Dict, List, Optional, Tuple

import pybullet

from ...geometry import (
    Pose,
    Twist,
    compose,
    conjugate,
    dot,
    inverse,
    multiply,
    norm,
    rotation_vector,
    scale,
    subtract,
)
from .bodies import Axis, Body, put_axis
from .link_states import place

_JOINT_TYPE, _PARENT = 2, 16     # of pybullet.getJointInfo
_BASE = -1
_NEAR = 2e-5
"""m and rad: a pose as near as this to one that the joint allows is meant to be that one. Saved
poses have six digits."""
_SAME = 1e-12
_STEP = 0.1   # rad or m, to see which way an axis goes


def move_by_joints(body: Body, way: Pose) -> bool:
    """Move a body with a fixed base by a rigid motion, by setting the joints next to the base.

    Args:
        body: the body.
        way: the motion: it maps old world poses to new ones.

    Returns:
        True if the joints allow the motion; else nothing has changed. Joint rates become zero.
    """
    done: List[Tuple[Axis, float]] = []
    for index in _first_joints(body):
        axis = next((one for one in body.axes if one.index == index), None)
        before = Pose(*place(body.uid, index))
        after = compose(way, before)
        if _is_near(before, after, _SAME if axis is not None else _NEAR):
            continue
        # The half of a screw that turns does not say where its link is.
        position = _position(body, axis, before, after) \
            if axis is not None and axis.follower is None else None
        if axis is None or position is None:
            for other, old in done:
                put_axis(body, other, old)
            return False
        done.append((axis, pybullet.getJointState(body.uid, axis.index)[0]))
        put_axis(body, axis, position)
    return True


def rates(body: Body, twist: Twist) -> Dict[int, float]:
    """The rates, rad/s or m/s, of first joints whose links move with `twist`, by joint index."""
    first = set(_first_joints(body))
    return {axis.index: _rate(body, axis, twist) for axis in body.axes if axis.index in first}


def _rate(body: Body, axis: Axis, twist: Twist) -> float:
    position = pybullet.getJointState(body.uid, axis.index)[0]
    here = Pose(*place(body.uid, axis.index))
    pybullet.resetJointState(body.uid, axis.index, position + _STEP)
    there = Pose(*place(body.uid, axis.index))
    pybullet.resetJointState(body.uid, axis.index, position)
    if _turns(body, axis):
        way = rotation_vector(multiply(there.orientation, conjugate(here.orientation)))
        return dot(scale(way, 1.0 / _STEP), twist.angular)
    return dot(scale(subtract(there.position, here.position), 1.0 / _STEP), twist.linear)


def _first_joints(body: Body) -> List[int]:
    return [index for index in range(pybullet.getNumJoints(body.uid))
            if pybullet.getJointInfo(body.uid, index)[_PARENT] == _BASE]


def _turns(body: Body, axis: Axis) -> bool:
    kind: int = pybullet.getJointInfo(body.uid, axis.index)[_JOINT_TYPE]
    return kind == pybullet.JOINT_REVOLUTE


def _position(body: Body, axis: Axis, before: Pose, after: Pose) -> Optional[float]:
    """The position at which the link is at `after`; None if there is none."""
    start: float = pybullet.getJointState(body.uid, axis.index)[0]
    turns = _turns(body, axis)
    way = rotation_vector(multiply(after.orientation, conjugate(before.orientation))) if turns \
        else subtract(after.position, before.position)
    span = norm(way)
    for position in (start + span, start - span):
        pybullet.resetJointState(body.uid, axis.index, position)
        fits = _is_near(Pose(*place(body.uid, axis.index)), after, _NEAR)
        pybullet.resetJointState(body.uid, axis.index, start)
        if fits:
            return _least(position, axis) if turns else position
    return None


def _least(angle: float, axis: Axis) -> float:
    """The same angle in one turn about zero, as Gazebo has it, unless its stops forbid that."""
    one = math.remainder(angle, 2.0 * math.pi)
    return one if axis.lower <= one <= axis.upper else angle


def _is_near(one: Pose, other: Pose, bound: float) -> bool:
    apart = compose(inverse(one), other)
    return norm(apart.position) < bound and norm(rotation_vector(apart.orientation)) < bound
