"""Poses of many links at once, as NumPy arrays."""
from __future__ import annotations

from functools import lru_cache
from typing import Union

import numpy as np

from ..engine.ring import LINK_WIDTH
from ..geometry import Pose

POSE_WIDTH = 7


def rows_of(raw: Union[bytes, memoryview]) -> np.ndarray:
    """Link rows of the ring as (n, 7): position and quaternion x, y, z, w."""
    return np.frombuffer(raw, dtype=np.float64).reshape(-1, LINK_WIDTH)[:, :POSE_WIDTH].copy()


def _rotation_table() -> np.ndarray:
    """(16, 9): a rotation matrix less identity, row by row, of the products x x, x y, ... w w."""
    x, y, z, w = range(4)
    table = np.zeros((4, 4, 3, 3))
    for at, terms in {
            (0, 0): ((y, y, -2), (z, z, -2)), (0, 1): ((x, y, 2), (z, w, -2)),
            (0, 2): ((x, z, 2), (y, w, 2)), (1, 0): ((x, y, 2), (z, w, 2)),
            (1, 1): ((x, x, -2), (z, z, -2)), (1, 2): ((y, z, 2), (x, w, -2)),
            (2, 0): ((x, z, 2), (y, w, -2)), (2, 1): ((y, z, 2), (x, w, 2)),
            (2, 2): ((x, x, -2), (y, y, -2))}.items():
        for one, other, factor in terms:
            table[(one, other, *at)] = factor
    return table.reshape(16, 9)


_ROTATION = _rotation_table()
_STILL = np.eye(3)


def matrices(poses: np.ndarray) -> np.ndarray:
    """(n, 7) poses as (n, 4, 4) float64 matrices, parent from child."""
    count = len(poses)
    turn = poses[:, 3:]
    found = np.zeros((count, 4, 4))
    products = (turn[:, :, None] * turn[:, None, :]).reshape(count, 16)
    np.add(np.dot(products, _ROTATION).reshape(count, 3, 3), _STILL, out=found[:, :3, :3])
    found[:, :3, 3] = poses[:, :3]
    found[:, 3, 3] = 1.0
    return found


_BY_COLUMNS = np.ascontiguousarray(
    _ROTATION.reshape(16, 3, 3).transpose(0, 2, 1)).reshape(16, 9)


def transforms(poses: np.ndarray) -> np.ndarray:
    """(n, 7) poses as (n, 4, 3): the three axes, then the place; `matrices` by columns."""
    count, turn = len(poses), poses[:, 3:]
    found = np.empty((count, 4, 3))
    products = (turn[:, :, None] * turn[:, None, :]).reshape(count, 16)
    np.add(np.dot(products, _BY_COLUMNS).reshape(count, 3, 3), _STILL, out=found[:, :3])
    found[:, 3] = poses[:, :3]
    return found


@lru_cache(maxsize=1024)
def matrix(pose: Pose) -> np.ndarray:
    """A pose as a (4, 4) matrix, parent from child; read-only."""
    made: np.ndarray = matrices(np.array([[*pose.position, *pose.orientation]]))[0]
    made.flags.writeable = False
    return made


def inverse(frame: np.ndarray) -> np.ndarray:
    """Return the inverse of a rigid transform, (4, 4)."""
    made = np.eye(4)
    made[:3, :3] = frame[:3, :3].T
    made[:3, 3] = -frame[:3, :3].T @ frame[:3, 3]
    return made
