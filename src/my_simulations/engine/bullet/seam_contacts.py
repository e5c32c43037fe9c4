"""Lets wheels and cylinders roll over the seams between triangles as over one surface.

Where a lying cylinder is a little deep in a floor of triangles, it meets the edge of the triangle
ahead or behind too. That edge carries part of the weight, pushes against the way or along it, and
turns the wheel: at 0.05 m/s a wheel lost or gained up to 80 % of its speed in 10 s. Two things
cure that:

- Bullet takes a new point for an old one when they are as near as its breaking threshold, a
  fiftieth of the body's size. So a point on an edge replaced the one below the axle. While
  something rolls on triangles, the threshold is smaller for pairs that are new in a step, as its
  own are in each.
- What the edges did wrong in a step is taken back in the next one: their normal forces should have
  acted along the normal of the deepest point, and through the axle.
"""
from __future__ import annotations

from math import sqrt
from typing import Any, Dict, List, NamedTuple, Tuple

import pybullet

from ...geometry import Vec3, add, cross, dot, norm, rotate, scale, subtract
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .link_states import place
from .rolling_contacts import EVERY, Key, RollingContacts
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import WorldParameters

_APART = 5e-4  # of a body's size: points that are nearer are one; usually more
_CHORD = 1.5   # of the way that lies in the floor: an edge farther off the axle is an obstacle
_SAME = 0.95   # cosine between two normals of one surface
_NONE = (0.0, 0.0, 0.0)

Contact = Tuple[Any, ...]  # as PyBullet tells it


class _Push(NamedTuple):
    """What is to act in the next step: N at a place, N m, world axes."""

    force: Vec3
    place: Vec3
    torque: Vec3


class SeamContacts(StepHelper):
    """Takes back what the edges of triangles do to what rolls over them."""

    events = COMMANDED

    def __init__(self, rolling: RollingContacts, parameters: WorldParameters) -> None:
        self._rolling, self._parameters = rolling, parameters
        self._at: Dict[Key, Tuple[Vec3, Vec3]] = {}   # centre and axis before the step
        self._pushes: Dict[Key, List[_Push]] = {}

    def forget(self, body: Body) -> None:
        """A body is gone."""
        for key in [key for key in self._pushes if key[0] == body.uid]:
            del self._pushes[key]

    def clear(self) -> None:
        """All bodies are gone."""
        self._at.clear()
        self._pushes.clear()

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Drop the forces on a body that a command reached."""
        self.forget(body)

    def due(self, step: int) -> int:
        """Each step while something rolls on triangles, else the next look for such."""
        if self._pushes or self._rolling.on_seams:
            return step
        return next_multiple(step, EVERY) if self._rolling.knows_seams else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Push against what went wrong in the last step."""
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
        """See what went wrong in the step that began at count `step`."""
        if not self._at:
            return
        for key, (centre, axis) in self._at.items():
            ends: Dict[bool, List[Contact]] = {}
            for contact in pybullet.getContactPoints(bodyA=key[0], linkIndexA=key[1]):
                if contact[8] <= 0.0 and self._rolling.is_seamed(contact[2]):
                    end = dot(subtract(contact[5], centre), axis) > 0.0
                    ends.setdefault(end, []).append(contact)
            pushes = [push for contacts in ends.values() for push in _pushes(
                contacts, centre, axis)]
            if pushes:
                self._pushes[key] = pushes
        self._at.clear()


def _pushes(contacts: List[Contact], centre: Vec3, axis: Vec3) -> List[_Push]:
    """What takes back the work of edges at one end of a cylinder: none, or one push."""
    deepest = min(contacts, key=lambda contact: contact[8])
    lever = subtract(deepest[5], centre)
    along = dot(lever, axis)
    radius = norm(_across(lever, axis))
    normal = _across(deepest[7], axis)
    reach = _CHORD * sqrt(-2.0 * deepest[8] * radius)
    force, torque = _NONE, 0.0
    for contact in contacts:
        own, load = _across(contact[7], axis), contact[9]
        way = norm(_across(subtract(contact[5], deepest[5]), axis))
        if load <= 0.0 or way > reach or dot(own, normal) < _SAME:
            continue
        force = add(force, scale(subtract(normal, own), load))
        torque -= load * dot(axis, cross(subtract(contact[5], centre), own))
    if force == _NONE and torque == 0.0:
        return []
    return [_Push(force, add(centre, scale(axis, along)), scale(axis, torque))]


def _across(vector: Vec3, axis: Vec3) -> Vec3:
    """The part of a vector across an axis."""
    return subtract(vector, scale(axis, dot(vector, axis)))
