"""Poses, rotations and twists in plain Python.

Quaternions are (x, y, z, w). A pose is parent-from-child: `compose(parent_from_a, a_from_b)`
is parent_from_b. Angles are radians, lengths metres. NumPy is left out on purpose: the ROS node
handles single poses only, where tuples are faster and cost neither memory nor start-up time.
"""
from __future__ import annotations

import math
from typing import Any, NamedTuple, Tuple

Vec3 = Tuple[float, float, float]
Quat = Tuple[float, float, float, float]

ZERO3: Vec3 = (0.0, 0.0, 0.0)
IDENTITY_QUAT: Quat = (0.0, 0.0, 0.0, 1.0)


def is_number(value: Any) -> bool:
    """Whether a value of JSON, YAML or the parameter server is a number; true and false are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_finite_number(value: Any) -> bool:
    """Whether a value of JSON or YAML is a finite number; integers that no double holds are not."""
    try:
        return is_number(value) and math.isfinite(value)
    except OverflowError:
        return False


class Pose(NamedTuple):
    """A rigid transform, parent from child.

    Attributes:
        position: metres, in the parent frame.
        orientation: unit quaternion x, y, z, w.
    """

    position: Vec3 = ZERO3
    orientation: Quat = IDENTITY_QUAT


IDENTITY = Pose()


class Twist(NamedTuple):
    """A velocity in world axes: linear m/s at the named frame's origin, angular rad/s."""

    linear: Vec3 = ZERO3
    angular: Vec3 = ZERO3


STILL = Twist()


def add(a: Vec3, b: Vec3) -> Vec3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vec3, b: Vec3) -> Vec3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(a: Vec3, factor: float) -> Vec3:
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def dot(a: Vec3, b: Vec3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec3, b: Vec3) -> Vec3:
    """Vector product a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def norm(a: Vec3) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def unit(v: Vec3) -> Vec3:
    """The direction of a vector, of length 1; a zero vector stays zero."""
    size = norm(v)
    return scale(v, 1.0 / size) if size > 0.0 else v


def is_finite(*values: float) -> bool:
    """True when no value is NaN or infinite."""
    return all(map(math.isfinite, values))


def pose_is_finite(pose: Pose) -> bool:
    """True when no number of the pose is NaN or infinite."""
    return is_finite(*pose.position, *pose.orientation)


def normalised(q: Quat) -> Quat:
    """The unit quaternion along `q`; the all-zero one becomes identity, as in Gazebo."""
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if length < 1e-12:
        return IDENTITY_QUAT
    if abs(length - 1.0) < 1e-15:
        return q
    return (q[0] / length, q[1] / length, q[2] / length, q[3] / length)


def multiply(a: Quat, b: Quat) -> Quat:
    """Hamilton product: the rotation b, then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(q: Quat) -> Quat:
    """The inverse of a unit quaternion."""
    return (-q[0], -q[1], -q[2], q[3])


def rotate(q: Quat, v: Vec3) -> Vec3:
    """The vector `v` turned by the unit quaternion `q`: v + w t + u x t with t = 2 u x v.

    Written out: a spawn takes it dozens of times.
    """
    ux, uy, uz, w = q
    x, y, z = v
    tx, ty, tz = (uy * z - uz * y) * 2.0, (uz * x - ux * z) * 2.0, (ux * y - uy * x) * 2.0
    return (x + tx * w + (uy * tz - uz * ty), y + ty * w + (uz * tx - ux * tz),
            z + tz * w + (ux * ty - uy * tx))


def compose(a: Pose, b: Pose) -> Pose:
    """parent_from_a composed with a_from_b: parent_from_b."""
    return Pose(
        add(a.position, rotate(a.orientation, b.position)),
        normalised(multiply(a.orientation, b.orientation)),
    )


def inverse(pose: Pose) -> Pose:
    """Return child_from_parent of the pose parent_from_child."""
    q = conjugate(pose.orientation)
    return Pose(scale(rotate(q, pose.position), -1.0), q)


def transform(pose: Pose, point: Vec3) -> Vec3:
    """A point of the child frame, in the parent frame."""
    return add(pose.position, rotate(pose.orientation, point))


def slerp(a: Quat, b: Quat, part: float) -> Quat:
    """The rotation at a part (0..1) of the shorter way from `a` to `b`."""
    cosine = sum(x * y for x, y in zip(a, b))
    sign = -1.0 if cosine < 0.0 else 1.0
    angle = math.acos(min(abs(cosine), 1.0))
    start, end = 1.0 - part, part
    if angle >= 1e-6:
        start, end = (math.sin(start * angle) / math.sin(angle),
                      math.sin(end * angle) / math.sin(angle))
    end *= sign
    return normalised((start * a[0] + end * b[0], start * a[1] + end * b[1],
                       start * a[2] + end * b[2], start * a[3] + end * b[3]))


def quat_from_rpy(roll: float, pitch: float, yaw: float) -> Quat:
    """Fixed-axis roll, pitch, yaw (R = Rz Ry Rx), as in URDF and SDF."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def rpy_from_quat(q: Quat) -> Vec3:
    """Fixed-axis roll, pitch, yaw of a unit quaternion; pitch in [-pi/2, pi/2].

    By the sum and the difference of yaw and roll, which are exact near a pitch of +-90 degrees
    too, where an arc sine would lose half the digits.
    """
    x, y, z, w = q
    up, down = math.hypot(w + y, z - x), math.hypot(w - y, z + x)
    difference, total = 2.0 * math.atan2(z - x, w + y), 2.0 * math.atan2(z + x, w - y)
    pitch = 2.0 * math.atan2(up - down, up + down)
    if min(up, down) < 1e-12:
        # Gimbal lock: only yaw -/+ roll is defined; put it all into yaw.
        return (0.0, pitch, _wrap_angle(difference if up > down else total))
    return (_wrap_angle((total - difference) / 2), pitch, _wrap_angle((total + difference) / 2))


def _wrap_angle(angle: float) -> float:
    """The same angle in [-pi, pi]."""
    return math.remainder(angle, 2.0 * math.pi) if abs(angle) > math.pi else angle


def pose_from_xyzrpy(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> Pose:
    """A pose from the six numbers of an SDF `<pose>`."""
    return Pose((x, y, z), quat_from_rpy(roll, pitch, yaw))


def rotation_vector(turn: Quat) -> Vec3:
    """Axis times angle of a quaternion, rad, at most half a turn."""
    x, y, z, w = turn if turn[3] >= 0.0 else (-turn[0], -turn[1], -turn[2], -turn[3])
    size = math.sqrt(x * x + y * y + z * z)
    return scale((x, y, z), 2.0 * math.atan2(size, w) / size) if size > 1e-12 else (0.0, 0.0, 0.0)


def twist_at(twist: Twist, lever: Vec3) -> Twist:
    """The twist of the same rigid body at a point `lever` (world axes) away: v + w x r."""
    return Twist(add(twist.linear, cross(twist.angular, lever)), twist.angular)
