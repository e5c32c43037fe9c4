"""Checks the values that plugins pass to their context, before they reach the engine."""
from __future__ import annotations

import math
from typing import Any

from ..geometry import Pose, Vec3


def finite(value: Any, what: str) -> float:
    """A finite number. Raises ValueError, which names `what`."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{what} must be a finite number, is {value!r:.100}")
    return number


def number(value: Any, what: str) -> float:
    """A number, which may be infinite. Raises ValueError, which names `what`."""
    infinite = isinstance(value, float) and math.isinf(value)
    return value if infinite else finite(value, what)


def vector(value: Any, what: str) -> Vec3:
    """Three finite numbers. Raises ValueError, which names `what`."""
    try:
        x, y, z = value
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be three numbers, is {value!r:.100}") from None
    return finite(x, what), finite(y, what), finite(z, what)


def pose_of(value: Any, what: str) -> Pose:
    """A pose of finite numbers. Raises ValueError, which names `what`."""
    try:
        position, (x, y, z, w) = value
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be a Pose, is {value!r:.100}") from None
    return Pose(vector(position, what), (finite(x, what), finite(y, what), finite(z, what),
                                         finite(w, what)))
