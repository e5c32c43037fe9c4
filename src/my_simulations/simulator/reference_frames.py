"""Poses and twists in reference frames, as defined by Gazebo's services."""
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
from .registry import ReferenceFrame


def usable(pose: Pose, twist: Twist) -> Pose:
    """The pose with a unit quaternion. Raises CommandError for NaN or infinity."""
    if not pose_is_finite(pose):
        raise CommandError("the pose contains NaN or infinity")
    if not pose_is_finite(Pose(twist.linear, (*twist.angular, 0.0))):
        raise CommandError("the twist contains NaN or infinity")
    return Pose(pose.position, normalised(pose.orientation))


def in_frame(pose: Pose, twist: Twist,
              frame: Optional[ReferenceFrame]) -> Tuple[Pose, Twist, Optional[Frame]]:
    """Arguments of an engine command: fixed frames are resolved here, moving ones there."""
    if frame is None:
        return pose, twist, None
    if frame.row >= 0:
        return pose, twist, Frame(frame.row, frame.offset)
    turn = frame.offset.orientation
    return (compose(frame.offset, pose),
            Twist(rotate(turn, twist.linear), rotate(turn, twist.angular)), None)


def relative(state: Tuple[Pose, Twist], frame: Optional[ReferenceFrame],
              snapshot: Snapshot) -> Tuple[Pose, Twist]:
    """Gazebo's relative state: pose in the frame, velocity differences turned, no w x r term."""
    if frame is None:
        return state
    (position, turn), (linear, angular) = state
    (at, axes), (frame_linear, frame_angular) = frame.state(snapshot)
    back = conjugate(axes)
    pose = Pose(rotate(back, subtract(position, at)), multiply(back, turn))
    return pose, Twist(rotate(back, subtract(linear, frame_linear)),
                       rotate(back, subtract(angular, frame_angular)))
