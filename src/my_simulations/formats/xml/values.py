"""Kinds of values in SDF and URDF: one class for each, with its parser and formatter.

`parse` raises ValueError with a phrase that says what was expected and found. `parse_leniently`
reads such a text as Gazebo does, and raises ValueError if Gazebo rejects it.
"""
from __future__ import annotations

import math
from typing import Any, Optional, Protocol, Sequence, Tuple

from ...geometry import Pose, Quat, Vec3, pose_from_xyzrpy, quat_from_rpy, rpy_from_quat
from .gazebo_text import leading_integer, leading_number, stream_numbers

UNSET = "__default__"
"""Text that stands for "not given" (Gazebo behaviour)."""


class Kind(Protocol):
    def parse(self, text: str) -> Any:
        """The value of `text`. Raises ValueError."""

    def format(self, value: Any) -> str:
        """Text that `parse` reads as the same value."""

    def parse_leniently(self, text: str) -> Any:
        """The value that Gazebo reads from a text that `parse` rejects. Raises ValueError."""


def parse_numbers(text: str, count: int) -> Tuple[float, ...]:
    """Parse exactly `count` finite numbers, separated by any white space."""
    parts = text.split()
    if len(parts) != count:
        plural = "number" if count == 1 else "numbers"
        commas = ", separated by spaces, not by commas" if "," in text else ""
        raise ValueError(f"expected {count} {plural}{commas}, found {_format_text(text)}")
    return tuple([parse_number(part) for part in parts])


def parse_number(text: str) -> float:
    """Parse a finite number."""
    value = parse_any_number(text)
    if not math.isfinite(value):
        raise ValueError(f"expected a finite number, found {_format_text(text)}")
    return value


def parse_any_number(text: str) -> float:
    """Parse a number, which may be infinite or NaN."""
    try:
        if "_" in text:  # digit separators of Python, which no format allows
            raise ValueError
        return float(text)
    except ValueError:
        raise ValueError(f"expected a number, found {_format_text(text)}") from None


def _format_text(text: str) -> str:
    text = " ".join(text.split())
    return repr(text if len(text) <= 60 else text[:57] + "...")


def _format_numbers(*values: float) -> str:
    # repr is the shortest text that reads back as the same double.
    return " ".join(repr(int(v)) if v == int(v) and abs(v) < 1e15 else repr(v) for v in values)


def _all_numbers_or_zeros(text: str, count: int) -> Tuple[float, ...]:
    """All numbers of a vector, or zeros: Gazebo reads vectors completely or not at all."""
    return _all_or_zeros(stream_numbers(text, count))


def _all_or_zeros(found: Sequence[Optional[float]]) -> Tuple[float, ...]:
    whole = tuple([value for value in found if value is not None])
    return whole if len(whole) == len(found) else (0.0,) * len(found)


class Bool:
    """`true`, `1`, `false`, `0`, any letter case; also `yes` and `no`, which URDF files use."""

    _words = {"true": True, "1": True, "yes": True, "false": False, "0": False, "no": False}

    def parse(self, text: str) -> bool:
        value = self._words.get(text.strip().lower())
        if value is None:
            raise ValueError(f"expected true or false, found {_format_text(text)}")
        return value

    def format(self, value: bool) -> str:
        return "true" if value else "false"


    def parse_leniently(self, text: str) -> bool:
        raise ValueError(f"expected true or false, found {_format_text(text)}")


class Negated(Bool):
    """A boolean with inverted meaning."""

    def parse(self, text: str) -> bool:
        return not super().parse(text)

    def format(self, value: bool) -> str:
        return super().format(not value)


class Float:
    """A finite number."""

    def parse(self, text: str) -> float:
        return parse_number(text)

    def format(self, value: float) -> str:
        return _format_numbers(value)


    def parse_leniently(self, text: str) -> float:
        return leading_number(_SPELT_OUT.get(text.strip().lower(), text))


_SPELT_OUT = {"true": "1", "false": "0"}


class Friction(Float):
    """A friction coefficient; negative values mean unbounded friction (Gazebo behaviour)."""

    _UNBOUNDED = 1e6

    def parse(self, text: str) -> float:
        return self._check_bounds(super().parse(text))

    def parse_leniently(self, text: str) -> float:
        return self._check_bounds(super().parse_leniently(text))

    def _check_bounds(self, value: float) -> float:
        return self._UNBOUNDED if value < 0 or value == math.inf else value


class Limit:
    """A number that may be infinite, as joint limits may be; never NaN."""

    def parse(self, text: str) -> float:
        value = parse_any_number(text)
        if value != value:
            raise ValueError(f"expected a number, found {_format_text(text)}")
        return value

    def format(self, value: float) -> str:
        return _format_numbers(value) if math.isfinite(value) else repr(value)

    def parse_leniently(self, text: str) -> float:
        return FLOAT.parse_leniently(text)


class Int:
    """An integer; `10.0` and `0x10` are accepted as well."""

    def parse(self, text: str) -> int:
        """Parse a decimal, a hexadecimal (`0x10`) or a whole floating-point number (`10.0`)."""
        try:
            return int(text)
        except ValueError:
            pass
        stripped = text.strip().lower()
        try:
            if stripped.startswith("0x"):
                return int(stripped, 16)
        except ValueError:
            pass
        value = parse_number(text)
        if value != int(value):
            raise ValueError(f"expected a whole number, found {_format_text(text)}")
        return int(value)

    def format(self, value: int) -> str:
        return str(value)

    def parse_leniently(self, text: str) -> int:
        return leading_integer(_SPELT_OUT.get(text.strip().lower(), text))


class Text:
    """A text without leading and trailing white space."""

    def parse(self, text: str) -> str:
        return text.strip()

    def format(self, value: str) -> str:
        return value

    def parse_leniently(self, text: str) -> str:
        return self.parse(text)


class Vector2:
    """Two numbers."""

    def parse(self, text: str) -> Tuple[float, float]:
        x, y = parse_numbers(text, 2)
        return (x, y)

    def format(self, value: Tuple[float, float]) -> str:
        return _format_numbers(*value)


    def parse_leniently(self, text: str) -> Tuple[float, float]:
        x, y = _all_numbers_or_zeros(text, 2)
        return (x, y)


class PlaneSize(Vector2):
    """Two numbers; a third is ignored (Gazebo behaviour)."""

    def parse(self, text: str) -> Tuple[float, float]:
        parts = text.split()
        return super().parse(" ".join(parts[:2]) if len(parts) == 3 else text)


class Vector3:
    """Three numbers."""

    def parse(self, text: str) -> Vec3:
        x, y, z = parse_numbers(text, 3)
        return (x, y, z)

    def format(self, value: Vec3) -> str:
        return _format_numbers(*value)


    def parse_leniently(self, text: str) -> Vec3:
        x, y, z = _all_numbers_or_zeros(text, 3)
        return (x, y, z)


class UniformScale(Vector3):
    """Three numbers, or one for all axes."""

    def parse(self, text: str) -> Vec3:
        if len(text.split()) == 1:
            one = parse_number(text)
            return (one, one, one)
        return super().parse(text)


class Color:
    """Red, green, blue and, where given, alpha (else 1), each 0..1.

    Values above 1 are divided by 255, negative ones are 0 (Gazebo behaviour).
    """

    def parse(self, text: str) -> Tuple[float, float, float, float]:
        parts = text.split()
        if len(parts) not in (3, 4):
            raise ValueError(f"expected 3 or 4 numbers, found {_format_text(text)}")
        r, g, b, a = (self._share(parse_number(part)) for part in (*parts, "1")[:4])
        return (r, g, b, a)

    def parse_leniently(self, text: str) -> Tuple[float, float, float, float]:
        r, g, b, a = stream_numbers(text, 4)
        return (self._share(r or 0.0), self._share(g or 0.0), self._share(b or 0.0),
                1.0 if a is None else self._share(a))

    @staticmethod
    def _share(value: float) -> float:
        return min(value / 255.0, 1.0) if value > 1.0 else max(value, 0.0)

    def format(self, value: Tuple[float, float, float, float]) -> str:
        return _format_numbers(*value)


class Rpy:
    """Roll, pitch, yaw in radians, about fixed axes, as a quaternion."""

    def parse(self, text: str) -> Quat:
        roll, pitch, yaw = parse_numbers(text, 3)
        return quat_from_rpy(roll, pitch, yaw)

    def format(self, value: Quat) -> str:
        return _format_numbers(*rpy_from_quat(value))

    def parse_leniently(self, text: str) -> Quat:
        roll, pitch, yaw = _all_numbers_or_zeros(text, 3)
        return quat_from_rpy(roll, pitch, yaw)


class PoseKind:
    """`x y z roll pitch yaw`: metres, and radians about fixed axes."""

    def parse(self, text: str) -> Pose:
        x, y, z, roll, pitch, yaw = parse_numbers(text, 6)
        return pose_from_xyzrpy(x, y, z, roll, pitch, yaw)

    def format(self, value: Pose) -> str:
        return _format_numbers(*value.position, *rpy_from_quat(value.orientation))

    def parse_leniently(self, text: str) -> Pose:
        """Position and rotation are each read completely or not at all (libignition-math 6)."""
        found = stream_numbers(text, 6)
        position, angles = _all_or_zeros(found[:3]), _all_or_zeros(found[3:])
        return pose_from_xyzrpy(*position, *angles)


class PathPose(PoseKind):
    """As `PoseKind`, of a path: its spline of turns tells q from -q (3.3 rad from -2.98)."""

    def format(self, value: Pose) -> str:
        angles = whole_turn(rpy_from_quat(value.orientation), value.orientation)
        return _format_numbers(*value.position, *angles)


def whole_turn(angles: Vec3, orientation: Quat) -> Vec3:
    """Roll, pitch and yaw of an orientation, with a yaw beyond pi if else it would be -q."""
    roll, pitch, yaw = angles
    if sum(a * b for a, b in zip(quat_from_rpy(roll, pitch, yaw), orientation)) >= 0.0:
        return angles
    return roll, pitch, round(yaw - math.copysign(2.0 * math.pi, yaw), 13)


class Seconds:
    """`sec nsec`, or plain seconds."""

    def parse(self, text: str) -> float:
        parts = text.split()
        if len(parts) == 2:
            return parse_number(parts[0]) + parse_number(parts[1]) * 1e-9
        return parse_numbers(text, 1)[0]

    def parse_leniently(self, text: str) -> float:
        seconds, nanoseconds = stream_numbers(text, 2)
        return (seconds or 0.0) + (nanoseconds or 0.0) * 1e-9

    def format(self, value: float) -> str:
        whole = math.floor(value)
        return f"{whole} {round((value - whole) * 1e9)}"


BOOL, NEGATED, FLOAT, LIMIT, INT, TEXT = Bool(), Negated(), Float(), Limit(), Int(), Text()
VECTOR2, VECTOR3, SCALE, COLOR = Vector2(), Vector3(), UniformScale(), Color()
PLANE_SIZE, FRICTION = PlaneSize(), Friction()
RPY, POSE, PATH_POSE, SECONDS = Rpy(), PoseKind(), PathPose(), Seconds()
