"""Filled messages of sensor_msgs, nav_msgs and geometry_msgs; by default stamped with now."""
from __future__ import annotations

from typing import Any, Iterable, List, Optional, Protocol, Sequence, Tuple

from ..geometry import Pose, Quat, Twist, Vec3
from ..geometry_messages import fill_pose, fill_quaternion, fill_twist, fill_vector, fill_wrench
from .context import Context
from .frames import stamp_message

ULTRASOUND, INFRARED = 0, 1   # of sensor_msgs/Range
_DIAGONAL_KNOWN = 2           # of sensor_msgs/NavSatFix


class JointReading(Protocol):
    """A joint whose state is published."""

    name: str

    @property
    def position(self) -> float:
        """rad or m."""

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""


def diagonal_covariance(variances: Sequence[float]) -> List[float]:
    """Return a square covariance matrix, row by row, with these variances on its diagonal."""
    count = len(variances)
    matrix = [0.0] * count ** 2
    matrix[::count + 1] = variances
    return matrix


def joint_state_message(context: Context, joints: Sequence[JointReading], frame: str = "",
                        efforts: Optional[Sequence[float]] = None, velocities: bool = True) -> Any:
    """Return a sensor_msgs/JointState; without `efforts` that field is empty."""
    message = stamp_message(context, "sensor_msgs/JointState", frame)
    message.name = [joint.name for joint in joints]
    message.position = [joint.position for joint in joints]
    if velocities:
        message.velocity = [joint.velocity for joint in joints]
    message.effort = list(efforts or ())
    return message


def odometry_message(context: Context, frames: Tuple[str, str], pose: Pose, twist: Twist,
                     covariances: Sequence[Sequence[float]], ns: Optional[int] = None) -> Any:
    """Return a nav_msgs/Odometry of the pose of the second frame in the first one.

    `covariances`: of the pose and of the twist.
    """
    message = stamp_message(context, "nav_msgs/Odometry", frames[0], ns)
    message.child_frame_id = frames[1]
    fill_pose(message.pose.pose, pose)
    fill_twist(message.twist.twist, twist)
    message.pose.covariance, message.twist.covariance = map(list, covariances)
    return message


def imu_message(context: Context, frame: str, orientation: Quat, rate: Iterable[float],
                acceleration: Iterable[float]) -> Any:
    """Return a sensor_msgs/Imu: rad/s and m/s^2, in the axes of the sensor; no covariances."""
    message = stamp_message(context, "sensor_msgs/Imu", frame)
    fill_quaternion(message.orientation, orientation)
    fill_vector(message.angular_velocity, rate)
    fill_vector(message.linear_acceleration, acceleration)
    return message


def wrench_message(context: Context, frame: str, wrench: Tuple[Vec3, Vec3]) -> Any:
    """Return a geometry_msgs/WrenchStamped of a force (N) and a torque (N m)."""
    message = stamp_message(context, "geometry_msgs/WrenchStamped", frame)
    fill_wrench(message.wrench, wrench)
    return message


def vector_message(context: Context, frame: str, vector: Vec3) -> Any:
    """Return a geometry_msgs/Vector3Stamped."""
    message = stamp_message(context, "geometry_msgs/Vector3Stamped", frame)
    fill_vector(message.vector, vector)
    return message


def point_message(context: Context, frame: str, point: Vec3, ns: Optional[int] = None) -> Any:
    """Return a geometry_msgs/PointStamped, m."""
    message = stamp_message(context, "geometry_msgs/PointStamped", frame, ns)
    fill_vector(message.point, point)
    return message


def magnetic_message(context: Context, frame: str, field: Iterable[float],
                     variances: Sequence[float] = (0.0,) * 3) -> Any:
    """Return a sensor_msgs/MagneticField, T."""
    message = stamp_message(context, "sensor_msgs/MagneticField", frame)
    fill_vector(message.magnetic_field, field)
    message.magnetic_field_covariance = diagonal_covariance(variances)
    return message


def fix_message(context: Context, frame: str, latitude: float, longitude: float, altitude: float,
                variances: Sequence[float], status: int = 0, service: int = 0) -> Any:
    """Return a sensor_msgs/NavSatFix: degrees, m, and the variances east, north and up, m^2."""
    message = stamp_message(context, "sensor_msgs/NavSatFix", frame)
    message.latitude, message.longitude, message.altitude = latitude, longitude, altitude
    message.position_covariance = diagonal_covariance(variances)
    message.position_covariance_type = _DIAGONAL_KNOWN
    message.status.status, message.status.service = status, service
    return message


def range_message(context: Context, frame: str, ns: int, kind: int, field_of_view: float,
                  limits: Tuple[float, float], distance: float) -> Any:
    """Return a sensor_msgs/Range: rad, and m; `kind` is `ULTRASOUND` or `INFRARED`."""
    message = stamp_message(context, "sensor_msgs/Range", frame, ns)
    message.radiation_type, message.field_of_view = kind, field_of_view
    message.min_range, message.max_range = limits
    message.range = distance
    return message
