"""Writes poses, twists and wrenches into messages of geometry_msgs."""
from __future__ import annotations

from typing import Any, Iterable, Tuple

from .geometry import Pose, Twist, Vec3


def fill_vector(message: Any, vector: Iterable[float]) -> None:
    """Write three numbers into a geometry_msgs/Vector3 or Point."""
    message.x, message.y, message.z = vector


def fill_quaternion(message: Any, quaternion: Iterable[float]) -> None:
    """Write x, y, z, w into a geometry_msgs/Quaternion."""
    message.x, message.y, message.z, message.w = quaternion


def fill_pose(message: Any, pose: Pose) -> None:
    """Write a pose into a geometry_msgs/Pose."""
    fill_vector(message.position, pose.position)
    fill_quaternion(message.orientation, pose.orientation)


def fill_twist(message: Any, twist: Twist) -> None:
    """Write a twist into a geometry_msgs/Twist."""
    fill_vector(message.linear, twist.linear)
    fill_vector(message.angular, twist.angular)


def fill_wrench(message: Any, wrench: Tuple[Vec3, Vec3]) -> None:
    """Write a force (N) and a torque (N m) into a geometry_msgs/Wrench."""
    fill_vector(message.force, wrench[0])
    fill_vector(message.torque, wrench[1])
