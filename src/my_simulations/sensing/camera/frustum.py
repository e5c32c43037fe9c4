"""The pyramid that a camera sees."""
from __future__ import annotations

import math
from typing import Union

import numpy as np

from ..api import CameraSpec, SensingError


def check(spec: CameraSpec, most: int) -> None:
    """Raise SensingError for a camera that cannot be drawn; `most`: pixels a side."""
    if not 0.0 < spec.hfov < math.pi and spec.lens is None:
        raise SensingError(f"a camera's angle of view lies between 0 and pi, not at {spec.hfov:g}")
    if not 0.0 < spec.near < spec.far < math.inf:
        raise SensingError("a camera sees from near to far, both above 0 m and finite, not from "
                           f"{spec.near:g} to {spec.far:g}")
    if not (0 < spec.width <= most and 0 < spec.height <= most):
        raise SensingError(f"a picture has 1 to {most} pixels a side here, not {spec.width} x "
                           f"{spec.height}")


def projection(spec: CameraSpec) -> np.ndarray:
    """Clip space from view (x right, y up, looking along -z); the first row read is the upper."""
    near, far = spec.near, spec.far
    across = 1.0 / math.tan(spec.hfov / 2)
    return np.array([[across, 0, 0, 0], [0, -across * spec.width / spec.height, 0, 0],
                     [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)],
                     [0, 0, -1.0, 0]])


def is_in_view(centers: np.ndarray, radius: Union[float, np.ndarray], spec: CameraSpec,
             ) -> np.ndarray:
    """Which balls (view frame), of one radius or of one each, the camera's pyramid may touch."""
    seen = (centers[:, 2] < radius - spec.near) & (centers[:, 2] > -spec.far - radius)
    half = math.tan(spec.hfov / 2)
    for axis, slope in ((0, half), (1, half * spec.height / spec.width)):
        outside = (np.abs(centers[:, axis]) + centers[:, 2] * slope) / math.hypot(1.0, slope)
        seen &= outside < radius
    found: np.ndarray = seen
    return found
