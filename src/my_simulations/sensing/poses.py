"""Poses of many links at once, as NumPy arrays."""
from __future__ import annotations

from typing import Union

import numpy as np

from ..engine.ring import LINK_WIDTH
from ..geometry import Pose

POSE_WIDTH = 7


def rows_of(raw: Union[bytes, memoryview]) -> np.ndarray:
    """Link rows of the ring as (n, 7): position and quaternion x, y, z, w."""
    return np.frombuffer(raw, dtype=np.float64).reshape(-1, LINK_WIDTH)[:, :POSE_WIDTH].copy()


def matrices(poses: np.ndarray) -> np.ndarray:
    """(n, 7) poses as (n, 4, 4) float64 matrices, parent from child."""
    x, y, z, w = poses[:, 3:].T
    found = np.zeros((len(poses), 4, 4))
    found[:, 0, 0] = 1 - 2 * (y * y + z * z)
    found[:, 0, 1] = 2 * (x * y - z * w)
    found[:, 0, 2] = 2 * (x * z + y * w)
    found[:, 1, 0] = 2 * (x * y + z * w)
    found[:, 1, 1] = 1 - 2 * (x * x + z * z)
    found[:, 1, 2] = 2 * (y * z - x * w)
    found[:, 2, 0] = 2 * (x * z - y * w)
    found[:, 2, 1] = 2 * (y * z + x * w)
    found[:, 2, 2] = 1 - 2 * (x * x + y * y)
    found[:, :3, 3] = poses[:, :3]
    found[:, 3, 3] = 1.0
    return found


def matrix(pose: Pose) -> np.ndarray:
    """A pose as a (4, 4) matrix, parent from child."""
    return matrices(np.array([[*pose.position, *pose.orientation]]))[0]
