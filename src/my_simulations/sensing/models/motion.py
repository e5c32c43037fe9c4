"""How a point fixed to a link moves."""
from __future__ import annotations

from ...geometry import Pose, Twist, Vec3, add, cross, rotate, scale, subtract


def velocity_at(link: Pose, twist: Twist, mount: Pose) -> Vec3:
    """World velocity (m/s) of a sensor at `mount` (link from sensor): v + w x r.

    `twist` is the link's, at its origin, in world axes.
    """
    lever = rotate(link.orientation, mount.position)
    return add(twist.linear, cross(twist.angular, lever))


def acceleration_between(before: Vec3, now: Vec3, elapsed: float) -> Vec3:
    """Mean acceleration (m/s^2) between two velocities `elapsed` s apart, as Gazebo's IMU; 0 for
    no time.
    """
    if elapsed <= 0.0:
        return (0.0, 0.0, 0.0)
    return scale(subtract(now, before), 1.0 / elapsed)
