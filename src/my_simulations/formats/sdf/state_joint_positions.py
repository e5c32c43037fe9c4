"""Computes joint positions from link poses."""
from __future__ import annotations

import math
from typing import Mapping, Optional

from ...description.model import WORLD, Joint
from ...geometry import Pose, compose, conjugate, dot, inverse, multiply, rotate, subtract

_HINGES = ("revolute", "continuous")
_SMALL = 1e-12


def joint_position(joint: Joint, at_zero: Mapping[str, Pose],
                   poses: Mapping[str, Pose]) -> Optional[float]:
    """The position of a joint with one axis, in rad (-pi to pi, or within its limits) or m.

    Args:
        joint: revolute or prismatic.
        at_zero: poses of the links in the model, where every joint is at 0.
        poses: present poses of the links, all in one frame.

    Returns:
        None for other joint types, and if a pose is missing.
    """
    if joint.axis is None or joint.type not in (*_HINGES, "prismatic") or joint.parent == WORLD:
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


def _within(angle: float, lower: float, upper: float) -> float:
    """The equivalent angle within the limits, else in -pi to pi."""
    angle = math.remainder(angle, 2.0 * math.pi)
    for turned in (angle, angle + 2.0 * math.pi, angle - 2.0 * math.pi):
        if lower <= turned <= upper:
            return turned
    return angle


def _tidy(value: float) -> float:
    return 0.0 if abs(value) < _SMALL else value
