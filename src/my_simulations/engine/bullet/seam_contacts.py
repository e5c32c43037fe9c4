"""Correct the forces on wheels and cylinders that roll over seams between triangles.

A lying cylinder that overlaps a floor of triangles also touches the edge of the triangle ahead or
behind. That edge carries part of the weight, pushes along or against the motion, and turns the
wheel (figures: doc/dev/contacts.md, "Cylinders on their side"). Two corrections are made:

- Bullet merges a new point with an old one within its breaking threshold. While a cylinder rolls on
  triangles, the threshold is smaller for new pairs; its own pairs are new in each step.
- The error of the edge forces in a step is compensated in the next one: the normal forces should
  act along the normal of the deepest point, and through the axle.
"""
from __future__ import annotations

from math import sqrt
from typing import Dict, List, NamedTuple, Tuple

import pybullet

from ...geometry import Vec3, add, cross, dot, norm, rotate, scale, subtract
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import DISTANCE, LOAD, NORMAL, OTHER_BODY, PLACE, ContactPoint, LinkKey
from .link_states import place
from .rolling_contacts import EVERY, RollingContacts
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import WorldParameters

_APART = 5e-4  # of a body's size: closer points are merged (Bullet's default: 0.02)
_CHORD = 1.5   # of the half chord in the floor: an edge beyond it is an obstacle
_SAME = 0.95   # smallest cosine between two normals of one surface
_NONE = (0.0, 0.0, 0.0)


class _Push(NamedTuple):
    """A force, N, at a point, and a torque, N m, for the next step; world axes."""

    force: Vec3
    place: Vec3
    torque: Vec3


class SeamContacts(StepHelper):
    """Compensates the forces of triangle edges on rolling links."""

    events = COMMANDED

    def __init__(self, rolling: RollingContacts, parameters: WorldParameters) -> None:
        self._rolling, self._parameters = rolling, parameters
        self._at: Dict[LinkKey, Tuple[Vec3, Vec3]] = {}   # centre and axis before the step
        self._pushes: Dict[LinkKey, List[_Push]] = {}
        self.body_tables = (self._pushes,)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Discard the forces on a body that a command changed."""
        self.forget(body)

    def due(self, step: int) -> int:
        """Each step while a link rolls on triangles, otherwise the step of the next check."""
        if self._pushes or self._rolling.on_seams:
            return step
        return next_multiple(step, EVERY) if self._rolling.knows_seams else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compensate the edge forces of the last step; record the poses of rolling links."""
        for (uid, index), pushes in self._pushes.items():
            for push in pushes:
                pybullet.applyExternalForce(uid, index, push.force, push.place,
                                            pybullet.WORLD_FRAME)
                pybullet.applyExternalTorque(uid, index, push.torque, pybullet.WORLD_FRAME)
        self._pushes.clear()
        for key, axis in self._rolling.on_seams.items():
            centre, turn = place(*key)
            self._at[key] = centre, rotate(turn, axis)
        if self._at:
            self._parameters.request_spacing(_APART)

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compute the compensation for the step that began at count `step`."""
        if not self._at:
            return
        for key, (centre, axis) in self._at.items():
            ends: Dict[bool, List[ContactPoint]] = {}
            for contact in pybullet.getContactPoints(bodyA=key[0], linkIndexA=key[1]):
                if contact[DISTANCE] <= 0.0 and self._rolling.is_seamed(contact[OTHER_BODY]):
                    end = dot(subtract(contact[PLACE], centre), axis) > 0.0
                    ends.setdefault(end, []).append(contact)
            pushes = [push for contacts in ends.values() for push in _pushes(
                contacts, centre, axis)]
            if pushes:
                self._pushes[key] = pushes
        self._at.clear()


def _pushes(contacts: List[ContactPoint], centre: Vec3, axis: Vec3) -> List[_Push]:
    """Return the compensation for edge forces at one end of a cylinder: none or one push."""
    deepest = min(contacts, key=lambda contact: contact[DISTANCE])
    lever = subtract(deepest[PLACE], centre)
    along = dot(lever, axis)
    radius = norm(_across(lever, axis))
    normal = _across(deepest[NORMAL], axis)
    reach = _CHORD * sqrt(-2.0 * deepest[DISTANCE] * radius)
    force, torque = _NONE, 0.0
    for contact in contacts:
        own, load = _across(contact[NORMAL], axis), contact[LOAD]
        way = norm(_across(subtract(contact[PLACE], deepest[PLACE]), axis))
        if load <= 0.0 or way > reach or dot(own, normal) < _SAME:
            continue
        force = add(force, scale(subtract(normal, own), load))
        torque -= load * dot(axis, cross(subtract(contact[PLACE], centre), own))
    if force == _NONE and torque == 0.0:
        return []
    return [_Push(force, add(centre, scale(axis, along)), scale(axis, torque))]


def _across(vector: Vec3, axis: Vec3) -> Vec3:
    """Return the component of a vector perpendicular to an axis."""
    return subtract(vector, scale(axis, dot(vector, axis)))
