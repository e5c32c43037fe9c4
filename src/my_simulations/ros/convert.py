"""Message fields to poses and twists and back; no number that is not finite gets past here."""
from __future__ import annotations

from typing import Any, Tuple

from ..errors import CommandError
from ..geometry import Pose, Twist, is_finite, normalised

NANOSECONDS = 1000000000


def pose_from_message(message: Any, field: str = "pose") -> Pose:
    """A geometry_msgs/Pose as a pose with a unit quaternion.

    The all-zero quaternion, which a client sends that fills the position only, is identity, as in
    Gazebo.

    Args:
        message: the geometry_msgs/Pose.
        field: its name in the request, for the error.

    Raises:
        CommandError: a number is NaN or infinite.
    """
    p, q = message.position, message.orientation
    position, orientation = (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)
    if not is_finite(*position):
        raise CommandError(f"{field}.position has a number that is not finite: {position}")
    if not is_finite(*orientation):
        raise CommandError(f"{field}.orientation has a number that is not finite: {orientation}")
    return Pose(position, normalised(orientation))


def twist_from_message(message: Any, field: str = "twist") -> Twist:
    """A geometry_msgs/Twist as a twist, m/s and rad/s, in the axes it was given in.

    Raises:
        CommandError: a number is NaN or infinite.
    """
    v, w = message.linear, message.angular
    twist = Twist((v.x, v.y, v.z), (w.x, w.y, w.z))
    if not is_finite(*twist.linear):
        raise CommandError(f"{field}.linear has a number that is not finite: {twist.linear}")
    if not is_finite(*twist.angular):
        raise CommandError(f"{field}.angular has a number that is not finite: {twist.angular}")
    return twist


def finite(value: float, field: str) -> float:
    """The value itself.

    Raises:
        CommandError: it is NaN or infinite.
    """
    if not is_finite(value):
        raise CommandError(f"{field} is not a finite number: {value}")
    return value


def fill_pose(message: Any, pose: Pose) -> None:
    """Write a pose into a geometry_msgs/Pose."""
    p, q = message.position, message.orientation
    p.x, p.y, p.z = pose.position
    q.x, q.y, q.z, q.w = pose.orientation


def fill_twist(message: Any, twist: Twist) -> None:
    """Write a twist into a geometry_msgs/Twist."""
    v, w = message.linear, message.angular
    v.x, v.y, v.z = twist.linear
    w.x, w.y, w.z = twist.angular


def seconds_and_nanoseconds(nanoseconds: int) -> Tuple[int, int]:
    """Sim time as the two fields of a ROS time."""
    return divmod(nanoseconds, NANOSECONDS)
