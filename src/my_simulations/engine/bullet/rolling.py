"""Lets lying cylinders roll as they should: neither on by themselves, nor ever faster.

Bullet keeps the contact points of a pair from step to step where they were on the surfaces. On a
cylinder that turns they lag 0.2 to 0.4 mm behind the axle, and what they carry there drives it on:
a can pushed to 0.05 m/s rolled at 0.4 m/s after 20 s, one at rest rolled out of the room. So the
points of lying cylinders are dropped before each step; the step finds new ones.

New points are a little beside the place as well where they are found by iteration, on boxes and
meshes. What that pushes a cylinder at rest is less than the least rolling resistance of real ones,
a ten-thousandth of the weight, so one that hardly moves is stopped.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import pybullet

from ...description.model import Link
from ...description.shapes import Capsule, Cylinder, Empty
from ...geometry import Pose, Vec3, conjugate, dot, rotate
from ..plan import BASE
from . import filters
from .bodies import Body, Part

EVERY = 8
"""Steps between two looks at who lies."""

_LYING = 0.1      # of the contact normal along the axis: less is a cylinder on its side
_TURNS = 0.01     # rad/s: joints slower than that need nothing
_CREEP = 2e-3     # m/s: what is slower, and
_RESIST = 2e-3    # m/s^2: speeds up less than that, stands
_ASLEEP = 3       # looks without velocity: it sleeps, and Bullet leaves it alone
_NONE = (0.0, 0.0, 0.0)


@dataclass
class _Roller:
    """A round link: its axis in the frame of its principal axes, and its speed when last seen."""

    body: Body
    part: Part
    axis: Vec3
    meets: filters.Filter
    before: float = 0.0
    still: int = 0


class Rolling:
    """Drops the contact points of lying cylinders before each step."""

    def __init__(self) -> None:
        self._rollers: Dict[Tuple[int, int], _Roller] = {}
        self._lying: Dict[Tuple[int, int], filters.Filter] = {}

    def add(self, body: Body, part: Part, link: Link) -> None:
        """Know a link of a body; only moving ones that are cylinders about one axis matter."""
        axis = _axis_of(link)
        if axis is not None and body.moves:
            own = rotate(conjugate(part.link_from_com.orientation), axis)
            self._rollers[body.uid, part.index] = _Roller(body, part, own, filters.moving(link))

    def forget(self, body: Body) -> None:
        """A body is gone."""
        for part in body.parts:
            for table in (self._rollers, self._lying):
                table.pop((body.uid, part.index), None)

    def clear(self) -> None:
        """All bodies are gone."""
        self._rollers.clear()
        self._lying.clear()

    @property
    def idle(self) -> bool:
        """True when no link can need it."""
        return not self._rollers

    @property
    def busy(self) -> bool:
        """True when something must be done before every step."""
        return bool(self._lying)

    def before(self, step: int, dt: float) -> None:
        """Act before the step that begins at count `step`, of `dt` s."""
        if step % EVERY == 0:
            for key, roller in self._rollers.items():
                if self._lies(roller, dt):
                    self._lying[key] = roller.meets
                else:
                    self._lying.pop(key, None)
        for (uid, index), meets in self._lying.items():
            pybullet.setCollisionFilterGroupMask(uid, index, meets.group, meets.mask)

    def _lies(self, roller: _Roller, dt: float) -> bool:
        """Whether a link lies on its side and may roll; stops it when it creeps."""
        uid, index = roller.body.uid, roller.part.index
        if roller.body.rigid:
            linear, angular = pybullet.getBaseVelocity(uid)
            roller.still = roller.still + 1 if linear == angular == _NONE else 0
            if roller.still:
                return roller.still < _ASLEEP and (uid, index) in self._lying
            turn = pybullet.getBasePositionAndOrientation(uid)[1]
        elif index == BASE:
            turn = pybullet.getBasePositionAndOrientation(uid)[1]
        else:
            if abs(pybullet.getJointState(uid, index)[1]) < _TURNS:
                return False
            turn = pybullet.getLinkState(uid, index)[1]
        axis = rotate(turn, roller.axis)
        contacts = pybullet.getContactPoints(bodyA=uid, linkIndexA=index)
        if not contacts:
            return (uid, index) in self._lying
        if any(abs(dot(contact[7], axis)) > _LYING for contact in contacts):
            return False
        if roller.body.rigid:
            speed = (linear[0] ** 2 + linear[1] ** 2 + linear[2] ** 2) ** 0.5
            if speed < _CREEP and abs(speed - roller.before) < _RESIST * EVERY * dt:
                pybullet.resetBaseVelocity(uid, _NONE, _NONE)
                speed = 0.0
            roller.before = speed
        return True


def _axis_of(link: Link) -> Optional[Vec3]:
    """The one axis that all shapes of a link are round about, in the link frame, or None."""
    found: List[Pose] = []
    for collision in link.collisions:
        if isinstance(collision.geometry, (Cylinder, Capsule)):
            found.append(collision.pose)
        elif not isinstance(collision.geometry, Empty):
            return None
    if not found:
        return None
    axes = [rotate(pose.orientation, (0.0, 0.0, 1.0)) for pose in found]
    if any(abs(dot(axis, axes[0])) < 1.0 - 1e-6 for axis in axes):
        return None
    return axes[0]
