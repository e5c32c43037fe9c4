"""Converts message fields to poses and twists and back; rejects NaN and infinite values."""
from __future__ import annotations

from typing import Any, Tuple

from ..errors import CommandError
from ..geometry import Pose, Twist, Vec3, is_finite, normalised

NANOSECONDS = 1000000000

LENGTH, SPEED, SPIN = 1e6, 1e6, 1e5
"""Largest accepted coordinate (m), speed (m/s) and rate (rad/s) of a request.

Beyond them doubles are too coarse for a useful simulation.
"""

FORCE = 1e9
"""Largest accepted component of a force (N) or torque (N m)."""


def pose_from_message(message: Any, field: str = "pose") -> Pose:
    """A geometry_msgs/Pose as a pose with a unit quaternion.

    The all-zero quaternion of a client that sets the position only is read as identity (Gazebo
    behaviour).

    Args:
        message: the geometry_msgs/Pose.
        field: its name in the request, for error messages.

    Raises:
        CommandError: a number is NaN, infinite or beyond the limits above.
    """
    p, q = message.position, message.orientation
    position, orientation = (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)
    check_vector(position, LENGTH, "m", f"{field}.position")
    if not is_finite(*orientation):
        raise CommandError(f"{field}.orientation contains NaN or infinity: {orientation}")
    largest = max(map(abs, orientation))
    if largest > LENGTH:   # its square would not be a number
        orientation = (q.x / largest, q.y / largest, q.z / largest, q.w / largest)
    return Pose(position, normalised(orientation))


def twist_from_message(message: Any, field: str = "twist") -> Twist:
    """A geometry_msgs/Twist as a twist, m/s and rad/s, in the axes it was given in.

    Raises CommandError: a number is NaN, infinite or beyond the limits above.
    """
    linear = check_vector(vector_of(message.linear), SPEED, "m/s", f"{field}.linear")
    angular = check_vector(vector_of(message.angular), SPIN, "rad/s", f"{field}.angular")
    return Twist(linear, angular)


def vector_of(message: Any) -> Vec3:
    """A geometry_msgs/Vector3 or Point as a tuple."""
    return (message.x, message.y, message.z)


def check_vector(values: Vec3, limit: float, unit: str, field: str) -> Vec3:
    """Return the vector if it is within the limit.

    Raises CommandError: a number is NaN, infinite or beyond the limit.
    """
    x, y, z = values
    if -limit <= x <= limit and -limit <= y <= limit and -limit <= z <= limit:   # not for NaN
        return values
    if not is_finite(x, y, z):
        raise CommandError(f"{field} contains NaN or infinity: {values}")
    raise CommandError(f"{field} contains a value beyond {limit:g} {unit}: {values}")


def check_number(value: float, low: float, high: float, field: str, unit: str = "") -> float:
    """Return the value if it is in the range.

    Raises CommandError: it is NaN, infinite or not between `low` and `high`.
    """
    check_finite(value, field)
    if not low <= value <= high:
        unit = f" {unit}" if unit else ""
        raise CommandError(f"{field} must be between {low:g} and {high:g}{unit}, is {value:g}")
    return value


def check_finite(value: float, field: str) -> float:
    """The value. Raises CommandError: it is NaN or infinite."""
    if not is_finite(value):
        raise CommandError(f"{field} must be finite, is {value}")
    return value


def seconds_and_nanoseconds(nanoseconds: int) -> Tuple[int, int]:
    """Sim time as the two fields of a ROS time."""
    return divmod(nanoseconds, NANOSECONDS)
