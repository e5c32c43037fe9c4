"""Gains of PID loops that suit a joint: from what the joint has to move.

The inertia about an axis (the mass along it, of a prismatic joint) is that of the links beyond the
joint and that of those before it, as if each were one body, in the configuration of the
description; of two free bodies the axis feels 1 / (1 / J1 + 1 / J2).

With the step size dt, an explicit loop of gain d on the rate is stable below 2 J / dt; a tenth of
that is used, which leaves room for links that move with other joints. The other gains follow from
it, so that a loop is also damped with the 15 times larger inertia of a wheel that carries its
robot.
"""
from __future__ import annotations

import math
from typing import Dict, Iterable, List, Set

from ..description.model import Joint, Link, Model
from ..geometry import Vec3, compose, conjugate, cross, dot, rotate, subtract, transform

_STABLE = 0.2
_POSITION = 10.0  # rad/s: P by D of a position loop
_INTEGRAL = 1.0  # 1/s: I by P of a position loop
_RATE_INTEGRAL = 2.0  # 1/s: of a velocity loop
_LEAST = 1e-9
_DIGITS = 3
WORLD = "world"


def default_gains(model: Model, joint: Joint, rate: bool, dt: float,
                  second: bool = False) -> Dict[str, float]:
    """Gains p, i, d for a loop on an axis.

    Args:
        model: the joint's model, flattened.
        joint: one with an axis.
        rate: of a loop that follows a velocity, else a position.
        dt: step size, s.
        second: of its second axis.
    """
    stiff = _STABLE * max(axis_inertia(model, joint, second), _LEAST) / dt
    if rate:
        return _round_gains(p=stiff, i=_RATE_INTEGRAL * stiff, d=0.0)
    return _round_gains(p=_POSITION * stiff, i=_INTEGRAL * _POSITION * stiff, d=stiff)


def axis_inertia(model: Model, joint: Joint, second: bool = False) -> float:
    """What the axis has to move: kg m^2, of a prismatic joint kg; 0 for nothing."""
    links = {link.name: link for link in model.links}
    child = links[joint.child]
    axis = joint.axis2 if second else joint.axis
    frame = compose(child.pose, joint.pose)
    direction = rotate(frame.orientation, axis.xyz if axis is not None else (0.0, 0.0, 1.0))
    beyond, before = _sides(model, joint)
    sides = [beyond]
    if not model.static and WORLD not in before:
        sides.append(before)
    inertias = [_effective_inertia((links[name] for name in side if name in links),
                                   frame.position, direction, joint.type == "prismatic")
                for side in sides]
    if min(inertias) <= 0.0:
        return max(inertias) if len(inertias) > 1 else 0.0
    return 1.0 / sum(1.0 / one for one in inertias)


def _sides(model: Model, joint: Joint) -> "List[Set[str]]":
    """The links that hang on the child, and those that hang on the parent."""
    neighbours: Dict[str, List[str]] = {}
    for other in model.joints:
        if other is not joint and other.name != joint.name:
            neighbours.setdefault(other.parent, []).append(other.child)
            neighbours.setdefault(other.child, []).append(other.parent)
    found = []
    for start in (joint.child, joint.parent):
        side, queue = {start}, [start]
        while queue:
            for name in neighbours.get(queue.pop(), ()):
                if name not in side:
                    side.add(name)
                    if name != WORLD:
                        queue.append(name)
        found.append(side)
    return found


def _effective_inertia(links: Iterable[Link], origin: Vec3, axis: Vec3, slides: bool) -> float:
    total = 0.0
    for link in links:
        inertial = link.inertial
        if slides:
            total += inertial.mass
            continue
        com = compose(link.pose, inertial.pose)
        arm = cross(axis, subtract(transform(com, (0.0, 0.0, 0.0)), origin))
        x, y, z = rotate(conjugate(com.orientation), axis)
        about = (inertial.ixx * x * x + inertial.iyy * y * y + inertial.izz * z * z
                 + 2.0 * (inertial.ixy * x * y + inertial.ixz * x * z + inertial.iyz * y * z))
        total += about + inertial.mass * dot(arm, arm)
    return total


def _round_gains(**gains: float) -> Dict[str, float]:
    return {name: _round(gain) for name, gain in gains.items()}


def _round(value: float) -> float:
    if value <= 0.0 or not math.isfinite(value):
        return 0.0
    return round(value, _DIGITS - 1 - math.floor(math.log10(value)))
