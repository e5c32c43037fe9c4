"""Joint positions from link poses, and where joints hold a model in the world."""
from __future__ import annotations

import math
from typing import Mapping, Optional, Sequence

from ..geometry import (
    Pose,
    compose,
    conjugate,
    dot,
    inverse,
    multiply,
    rotate,
    scale,
    subtract,
)
from .model import WORLD, Joint, Link

_HINGES = ("revolute", "continuous")
_SMALL = 1e-12


def joint_position(joint: Joint, at_zero: Mapping[str, Pose],
                   poses: Mapping[str, Pose]) -> Optional[float]:
    """The position of a joint with one axis, in rad (-pi to pi, or within its limits) or m.

    Args:
        joint: revolute or prismatic.
        at_zero: poses of the links in the model, where every joint is at 0; for joints to the
            world, poses in the world, and that of `WORLD`.
        poses: present poses of the links, all in one frame.

    Returns:
        None for other joint types, and if a pose is missing.
    """
    if not has_position(joint) or joint.axis is None:
        return None
    if joint.parent not in poses or joint.child not in poses or not (
            joint.parent in at_zero and joint.child in at_zero):
        return None
    frame = joint.pose  # in the child link's frame
    before = compose(compose(inverse(at_zero[joint.parent]), at_zero[joint.child]), frame)
    now = compose(compose(inverse(poses[joint.parent]), poses[joint.child]), frame)
    axis = joint.axis.xyz
    if joint.type == "prismatic":
        return _tidy(dot(subtract(now.position, before.position),
                         rotate(before.orientation, axis)))
    turn = multiply(conjugate(before.orientation), now.orientation)
    angle = 2.0 * math.atan2(dot((turn[0], turn[1], turn[2]), axis), turn[3])
    return _tidy(_within(angle, joint.axis.lower, joint.axis.upper))


def has_position(joint: Joint) -> bool:
    """Whether it has one axis, so that one number says where it is."""
    return joint.axis is not None and joint.type in (*_HINGES, "prismatic")


def moved_child_pose(joint: Joint, by: float, child: Pose) -> Pose:
    """The pose of a joint's child link after the joint has moved by rad or m, its parent at rest.

    Args:
        joint: one with `has_position`.
        by: the difference of its positions.
        child: pose of the child link before.
    """
    axis = joint.axis.xyz if joint.axis is not None else (0.0, 0.0, 1.0)
    if joint.type == "prismatic":
        way = Pose(scale(axis, by))
    else:
        sine = scale(axis, math.sin(by / 2.0))
        way = Pose((0.0, 0.0, 0.0), (*sine, math.cos(by / 2.0)))
    return compose(compose(compose(child, joint.pose), way), inverse(joint.pose))


def anchored_pose(joints: Sequence[Joint], links: Sequence[Link], poses: Mapping[str, Pose],
                  positions: Mapping[str, float]) -> Optional[Pose]:
    """Where the frame of a model is that hangs on the world, with its joints to the world at 0.

    Args:
        joints: of the model.
        links: of the model, with their poses in it.
        poses: present poses of its links in the world.
        positions: of its joints, rad or m.

    Returns:
        None if no joint to the world says it.
    """
    at_zero = {link.name: link.pose for link in links}
    anchors = [joint for joint in joints if joint.parent == WORLD and joint.child in poses
               and joint.child in at_zero and (joint.type == "fixed" or (
                   has_position(joint) and joint.name in positions))]
    for joint in sorted(anchors, key=lambda one: one.type != "fixed"):
        child = poses[joint.child]
        if joint.type != "fixed":
            child = moved_child_pose(joint, -positions[joint.name], child)
        return compose(child, inverse(at_zero[joint.child]))
    return None


def _within(angle: float, lower: float, upper: float) -> float:
    """The equivalent angle within the limits, else in -pi to pi."""
    angle = math.remainder(angle, 2.0 * math.pi)
    for turned in (angle, angle + 2.0 * math.pi, angle - 2.0 * math.pi):
        if lower <= turned <= upper:
            return turned
    return angle


def _tidy(value: float) -> float:
    return 0.0 if abs(value) < _SMALL else value
