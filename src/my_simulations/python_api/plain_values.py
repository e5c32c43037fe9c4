"""Arguments of Python programs: poses, vectors and times as plain numbers."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, Optional, Sequence

from ..errors import CommandError
from ..geometry import Pose, Twist, Vec3, normalised, pose_from_xyzrpy

_POSE_WIDTH = 7
_LONGEST = 2.0 ** 62 / 1e9  # s, 146 years


def pose_of(values: Sequence[float]) -> Pose:
    """A pose from 3 (position), 6 (x y z roll pitch yaw, as in SDF) or 7 numbers (see `Readings`).

    Raises CommandError: another number of values, or no numbers.
    """
    numbers = _numbers(values, "a pose")
    if len(numbers) == 3:
        return Pose((numbers[0], numbers[1], numbers[2]))
    if len(numbers) == 6:
        return pose_from_xyzrpy(*numbers)
    if len(numbers) == _POSE_WIDTH:
        return Pose((numbers[0], numbers[1], numbers[2]),
                    normalised((numbers[3], numbers[4], numbers[5], numbers[6])))
    raise CommandError(f"a pose has 3 numbers (x y z), 6 (x y z roll pitch yaw) or 7 (x y z and a "
                       f"quaternion x y z w), not {len(numbers)}")


def vector_of(values: Sequence[float], what: str) -> Vec3:
    """Three numbers; `what` names them. Raises CommandError."""
    numbers = _numbers(values, what)
    if len(numbers) != 3:
        raise CommandError(f"{what} has 3 numbers, not {len(numbers)}")
    return numbers[0], numbers[1], numbers[2]


def twist_of(values: Sequence[float]) -> Twist:
    """A twist from vx vy vz (m/s) wx wy wz (rad/s). Raises CommandError."""
    numbers = _numbers(values, "a twist")
    if len(numbers) != 6:
        raise CommandError(f"a twist has 6 numbers, not {len(numbers)}")
    return Twist(vector_of(numbers[:3], "linear"), vector_of(numbers[3:], "angular"))


def name_of(value: Any, what: str) -> str:
    """Text; `what` names it. Raises CommandError."""
    if not isinstance(value, str):
        raise CommandError(f"{what} must be text, is {value!r}")
    return value


def number_of(value: Any, what: str) -> float:
    """A finite number; `what` names it. Raises CommandError."""
    try:
        if not isinstance(value, str):
            number = float(value)
            if math.isfinite(number):
                return number
    except (TypeError, ValueError):
        pass
    raise CommandError(f"{what} must be a finite number, is {value!r}")


def limit_of(value: Any, what: str) -> Optional[float]:
    """A number that is not negative, or None; `what` names it. Raises CommandError."""
    if value is None or value == math.inf:
        return value
    if number_of(value, what) < 0.0:
        raise CommandError(f"{what} must not be negative, is {value!r}")
    return float(value)


def numbers_by_name(values: Any, what: str) -> Dict[str, float]:
    """Finite numbers by name; `what` names them. Raises CommandError."""
    if not isinstance(values, Mapping):
        raise CommandError(f"{what} are a dictionary of numbers by name, not {values!r}")
    return {name: number_of(value, f"{what}[{name!r}]") for name, value in values.items()}


def _numbers(values: Sequence[float], what: str) -> List[float]:
    try:
        if not isinstance(values, str):  # whose digits would count
            found = [float(value) for value in values]
            if not all(map(math.isfinite, found)):
                raise CommandError(f"{what} contains NaN or infinity")
            return found
    except (TypeError, ValueError):
        pass
    raise CommandError(f"{what} is a sequence of numbers, not {values!r}")


def nanoseconds_of(duration: Optional[float]) -> int:
    """A duration in s as nanoseconds; -1, for ever, for None and what 64 bits cannot hold.

    Raises CommandError: it is not a number.
    """
    if duration is None or duration == math.inf:
        return -1
    duration = number_of(duration, "a duration")
    if duration >= _LONGEST:
        return -1
    return max(0, round(max(0.0, duration) * 1e9))


def whole_number(value: float, what: str) -> int:
    """A whole number, also one that is written as a float. Raises CommandError; `what` names it."""
    try:
        if int(value) == value:
            return int(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise CommandError(f"{what} must be a whole number, is {value!r}")
