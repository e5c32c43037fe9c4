"""Checks the values that plugins pass to their context, before they reach the engine."""
from __future__ import annotations

import math
from typing import Any

from ..geometry import Pose, Vec3


def check_finite(value: Any, what: str) -> float:
    """Return a finite number. Raises ValueError, which names `what`."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{what} must be a finite number, is {value!r:.100}")
    return number


def check_number(value: Any, what: str) -> float:
    """Return a number, which may be infinite. Raises ValueError, which names `what`."""
    infinite = isinstance(value, float) and math.isinf(value)
    return value if infinite else check_finite(value, what)


def check_vector(value: Any, what: str) -> Vec3:
    """Return three finite numbers. Raises ValueError, which names `what`."""
    try:
        x, y, z = value
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be three numbers, is {value!r:.100}") from None
    return check_finite(x, what), check_finite(y, what), check_finite(z, what)


def check_pose(value: Any, what: str) -> Pose:
    """Return a pose of finite numbers. Raises ValueError, which names `what`."""
    try:
        position, (x, y, z, w) = value
    except (TypeError, ValueError):
        raise ValueError(f"{what} must be a Pose, is {value!r:.100}") from None
    return Pose(check_vector(position, what), (check_finite(x, what), check_finite(y, what),
                                               check_finite(z, what), check_finite(w, what)))
