"""Turning from waypoint to waypoint: the rules of the editor's page (web/js/turn_spline.ts).

A spline of Shoemake's (1985) joins orientations, which does not depend on how long segments take
(ignition::math::RotationSpline): turns swing by some degrees about straight parts of a path, and
widely where the yaw passes from pi to -pi, whose quaternions are far from each other.
"""
from __future__ import annotations

import math
from typing import List, Sequence, TypeVar

from ...geometry import Quat, conjugate, multiply, normalised, slerp

_CLOSED = 1e-3
"""Ends of which no member (m, or of a quaternion) differs by more are one (ignition::math)."""
_SMALL = 1e-3
"""Below this the sine of an angle stands for the angle."""


Point = TypeVar("Point", bound=Sequence[float])


def with_neighbours(points: Sequence[Point]) -> List[Point]:
    """Two points or more with the one before the first and the one after the last.

    Of a closed path, whose ends are one point, these are from its other end; else the ends again.
    """
    closed = all(abs(a - b) <= _CLOSED for a, b in zip(points[0], points[-1]))
    before, after = (points[-2], points[1]) if closed else (points[0], points[-1])
    return [before, *points, after]


def controls_of(turns: Sequence[Quat]) -> List[Quat]:
    """The inner control point at each orientation."""
    if len(turns) < 2:
        return list(turns)
    around = with_neighbours(turns)
    found: List[Quat] = []
    for n, turn in enumerate(turns):
        back = conjugate(turn)
        ahead, behind = _log(multiply(back, around[n + 2])), _log(multiply(back, around[n]))
        found.append(multiply(turn, _exp([-0.25 * (a + b) for a, b in zip(ahead, behind)])))
    return found


def squad(start: Quat, start_control: Quat, goal_control: Quat, goal: Quat, part: float) -> Quat:
    """Return the orientation at a part, 0 to 1, of a segment (Shoemake's squad)."""
    straight = slerp(start, goal, part)
    bent = _along_arc(start_control, goal_control, part)
    return normalised(_along_arc(straight, bent, 2.0 * part * (1.0 - part)))


def _along_arc(a: Quat, b: Quat, part: float) -> Quat:
    """From `a` to `b`, not to -`b`, which is the same orientation."""
    cosine = sum(x * y for x, y in zip(a, b))
    start, end = 1.0 - part, part
    if abs(cosine) < 1.0 - _SMALL:
        angle = math.acos(cosine)
        start, end = (math.sin(start * angle) / math.sin(angle),
                      math.sin(end * angle) / math.sin(angle))
    return normalised((start * a[0] + end * b[0], start * a[1] + end * b[1],
                       start * a[2] + end * b[2], start * a[3] + end * b[3]))


def _log(turn: Quat) -> List[float]:
    """The axis, as long as half the angle; 0 to pi, as the quaternion says."""
    half = math.acos(max(-1.0, min(turn[3], 1.0)))
    sine = math.sin(half)
    factor = half / sine if abs(sine) >= _SMALL else 1.0
    return [factor * turn[0], factor * turn[1], factor * turn[2]]


def _exp(axis: List[float]) -> Quat:
    half = math.sqrt(sum(one * one for one in axis))
    sine = math.sin(half)
    factor = sine / half if abs(sine) >= _SMALL else 1.0
    return (factor * axis[0], factor * axis[1], factor * axis[2], math.cos(half))
