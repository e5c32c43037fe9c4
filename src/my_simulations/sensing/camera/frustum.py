"""The pyramid that a camera sees."""
from __future__ import annotations

import math

import numpy as np

from ..api import CameraSpec


def projection(spec: CameraSpec) -> np.ndarray:
    """Clip space from view (x right, y up, looking along -z); the first row read is the upper."""
    near, far = spec.near, spec.far
    across = 1.0 / math.tan(spec.hfov / 2)
    return np.array([[across, 0, 0, 0], [0, -across * spec.width / spec.height, 0, 0],
                     [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)],
                     [0, 0, -1.0, 0]])


def in_sight(centers: np.ndarray, radius: float, spec: CameraSpec) -> np.ndarray:
    """Which balls (view frame) the camera's pyramid may touch."""
    seen = (centers[:, 2] < radius - spec.near) & (centers[:, 2] > -spec.far - radius)
    half = math.tan(spec.hfov / 2)
    for axis, slope in ((0, half), (1, half * spec.height / spec.width)):
        outside = (np.abs(centers[:, axis]) + centers[:, 2] * slope) / math.hypot(1.0, slope)
        seen &= outside < radius
    found: np.ndarray = seen
    return found
