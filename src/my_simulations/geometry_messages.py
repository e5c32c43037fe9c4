"""Writes poses and twists into messages of geometry_msgs."""
from __future__ import annotations

from typing import Any

from .geometry import Pose, Twist


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
