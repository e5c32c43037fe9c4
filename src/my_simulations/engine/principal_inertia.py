"""Principal axes and moments of inertia tensors."""
from __future__ import annotations

from typing import Any, Tuple

import numpy as np

from ..description.model import Inertial
from ..geometry import Pose, Quat, Vec3, multiply, normalised


def principal(inertial: Inertial) -> Tuple[Pose, Vec3]:
    """The pose of the principal axes in the link frame and the moments about them (kg m^2).

    A diagonal tensor keeps its axes.
    """
    diagonal = (inertial.ixx, inertial.iyy, inertial.izz)
    if not (inertial.ixy or inertial.ixz or inertial.iyz):
        return inertial.pose, diagonal
    tensor = np.array([
        [inertial.ixx, inertial.ixy, inertial.ixz],
        [inertial.ixy, inertial.iyy, inertial.iyz],
        [inertial.ixz, inertial.iyz, inertial.izz],
    ])
    moments, axes = np.linalg.eigh(tensor)
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] *= -1.0
    turn = multiply(inertial.pose.orientation, quat_of(axes))
    return Pose(inertial.pose.position, normalised(turn)), (
        float(moments[0]), float(moments[1]), float(moments[2]))


def quat_of(r: np.ndarray[Any, Any]) -> Quat:
    """The quaternion (x y z w) of a rotation matrix, by its largest component (Shepperd 1978)."""
    candidates = [
        r[0, 0] - r[1, 1] - r[2, 2], r[1, 1] - r[0, 0] - r[2, 2],
        r[2, 2] - r[0, 0] - r[1, 1], r[0, 0] + r[1, 1] + r[2, 2],
    ]
    which = int(np.argmax(candidates))
    root = float(np.sqrt(1.0 + candidates[which]))
    q = [0.0, 0.0, 0.0, 0.0]
    q[which] = root / 2.0
    if which == 3:
        q[0] = (r[2, 1] - r[1, 2]) / (2 * root)
        q[1] = (r[0, 2] - r[2, 0]) / (2 * root)
        q[2] = (r[1, 0] - r[0, 1]) / (2 * root)
    else:
        i, j, k = which, (which + 1) % 3, (which + 2) % 3
        q[j] = (r[j, i] + r[i, j]) / (2 * root)
        q[k] = (r[k, i] + r[i, k]) / (2 * root)
        q[3] = (r[k, j] - r[j, k]) / (2 * root)
    return normalised((float(q[0]), float(q[1]), float(q[2]), float(q[3])))
