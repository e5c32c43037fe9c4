"""Numbers and poses of messages as JSON has them."""
from __future__ import annotations

import math
from typing import Any, List


def number(value: Any, otherwise: Any = 0.0) -> Any:
    """A number that JSON knows."""
    found = float(value)
    return found if math.isfinite(found) else otherwise


def vector(message: Any) -> List[float]:
    """A geometry_msgs/Vector3 or Point."""
    return [number(message.x), number(message.y), number(message.z)]


def pose(message: Any) -> List[float]:
    """A geometry_msgs/Pose; a quaternion that is no rotation is the identity."""
    return vector(message.position) + rotation(message.orientation)


def rotation(turn: Any) -> List[float]:
    """A geometry_msgs/Quaternion of unit length."""
    parts = [number(part) for part in (turn.x, turn.y, turn.z, turn.w)]
    length = math.sqrt(sum(part * part for part in parts))
    return ([part / length for part in parts] if 1e-6 < length < math.inf
            else [0.0, 0.0, 0.0, 1.0])
