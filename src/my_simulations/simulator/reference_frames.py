"""Poses and twists in reference frames, as Gazebo's services mean them."""
from __future__ import annotations

from typing import Optional, Tuple

from ..engine.commands import Frame
from ..engine.ring import Snapshot
from ..errors import CommandError
from ..geometry import (
    Pose,
    Twist,
    compose,
    conjugate,
    multiply,
    normalised,
    pose_is_finite,
    rotate,
    subtract,
)
from .registry import Anchor


def usable(pose: Pose, twist: Twist) -> Pose:
    """The pose with a unit quaternion. Raises CommandError when a number is not finite."""
    if not pose_is_finite(pose):
        raise CommandError("the pose holds a number that is not finite")
    if not pose_is_finite(Pose(twist.linear, (*twist.angular, 0.0))):
        raise CommandError("the twist holds a number that is not finite")
    return Pose(pose.position, normalised(pose.orientation))


def in_frame(pose: Pose, twist: Twist,
              anchor: Optional[Anchor]) -> Tuple[Pose, Twist, Optional[Frame]]:
    """What the engine is to be told: a fixed frame is resolved here, a moving one there."""
    if anchor is None:
        return pose, twist, None
    if anchor.row >= 0:
        return pose, twist, Frame(anchor.row, anchor.offset)
    turn = anchor.offset.orientation
    return (compose(anchor.offset, pose),
            Twist(rotate(turn, twist.linear), rotate(turn, twist.angular)), None)


def relative(state: Tuple[Pose, Twist], anchor: Optional[Anchor],
              snapshot: Snapshot) -> Tuple[Pose, Twist]:
    """Gazebo's relative state: pose in the frame, velocity differences turned, no w x r term."""
    if anchor is None:
        return state
    (position, turn), (linear, angular) = state
    (at, axes), (frame_linear, frame_angular) = anchor.state(snapshot)
    back = conjugate(axes)
    pose = Pose(rotate(back, subtract(position, at)), multiply(back, turn))
    return pose, Twist(rotate(back, subtract(linear, frame_linear)),
                       rotate(back, subtract(angular, frame_angular)))
