"""Poses of ROS messages in the plane of the floor."""
from __future__ import annotations

import math


def planar_pose(pose):
    """Return x, y (m) and yaw (rad) of a geometry_msgs/Pose."""
    return (pose.position.x, pose.position.y, yaw_of(pose.orientation))


def yaw_of(orientation):
    return 2.0 * math.atan2(orientation.z, orientation.w)
