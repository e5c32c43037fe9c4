"""Correct what seams between triangles and between level floors do to cylinders.

`TriangleSeams`: forces on wheels and cylinders that roll over seams between triangles. A lying
cylinder that overlaps a floor of triangles also touches the edge of the triangle ahead or behind.
That edge carries part of the weight, pushes along or against the motion, and turns the wheel
(figures: doc/dev/contacts.md, "Cylinders on their side"). Two corrections are made:

- Bullet merges a new point with an old one within its breaking threshold. While a cylinder rolls on
  triangles, the threshold is smaller for new pairs; its own pairs are new in each step.
- The error of the edge forces in a step is compensated in the next one: the normal forces should
  act along the normal of the deepest point, and through the axle.

`LevelSeams`: upright cylinders that slide on level floors, and over seams between floors (figures:
"Upright cylinders that slide"). When a body starts to slide, or reaches another floor, its contact
points are dropped, and the new points may slide apart ten times as far as usual.

At a seam, the body overlaps the next box of the same height less in its side than in its top. So
Bullet pushes it back. A side below floor level cannot cause a real contact. So a body that such a
side has pushed gets back its velocity of before the step, without tilting and sinking. This also
removes the friction of that step.

Boxes need no correction, because Bullet finds four points of two boxes in each step. Rolling
cylinders do not touch the sides.
"""
from __future__ import annotations

from math import sqrt
from typing import Callable, Collection, Dict, List, NamedTuple, Set, Tuple

import pybullet

from ...description.shapes import Cylinder, Plane
from ...geometry import ZERO3, Vec3, add, conjugate, cross, dot, norm, rotate, scale, subtract
from ..body_plan import BASE
from . import collision_groups, rolling_contacts
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import DISTANCE, LOAD, NORMAL, OTHER_BODY, POINT, ContactPoint, LinkKey
from .link_states import read_com_pose
from .rolling_contacts import RollingContacts, axis_of
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import WorldParameters

_SPACING_ON_TRIANGLES = 5e-4  # of a body's size: closer points are merged (Bullet's default: 0.02)
_CHORD = 1.5                  # of the half chord in the floor: an edge beyond it is an obstacle
_SAME = 0.95                  # smallest cosine between two normals of one surface

EVERY = 8
"""Steps between two checks of sliding bodies."""

_WIDE_SPACING = 0.2  # of a body's size: points of surfaces that slid farther apart are dropped
_FAST = 0.05         # m/s: a slower body does not sink
_LEVEL = 1e-4        # m: floors with a smaller height difference are level
_UP = 0.999          # of a normal, or an axis, along z: less is a side, or a leaning body
_NEAR = 0.06         # m beyond the path until the next check: Bullet finds pairs 5 cm ahead

_Velocity = Tuple[Vec3, Vec3]


class _Push(NamedTuple):
    """A force, N, at a point, and a torque, N m, for the next step; world axes."""

    force: Vec3
    place: Vec3
    torque: Vec3


class TriangleSeams(StepHelper):
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
        if self._pushes or self._rolling.on_triangles:
            return step
        if self._rolling.can_roll_on_triangles:
            return next_multiple(step, rolling_contacts.EVERY)
        return FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compensate the edge forces of the last step; record the poses of rolling links."""
        for (uid, index), pushes in self._pushes.items():
            for push in pushes:
                pybullet.applyExternalForce(uid, index, push.force, push.place,
                                            pybullet.WORLD_FRAME)
                pybullet.applyExternalTorque(uid, index, push.torque, pybullet.WORLD_FRAME)
        self._pushes.clear()
        for key, axis in self._rolling.on_triangles.items():
            centre, turn = read_com_pose(*key)
            self._at[key] = centre, rotate(turn, axis)
        if self._at:
            self._parameters.request_spacing(_SPACING_ON_TRIANGLES)

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compute the compensation for the step that began at count `step`."""
        if not self._at:
            return
        for key, (centre, axis) in self._at.items():
            ends: Dict[bool, List[ContactPoint]] = {}
            for contact in pybullet.getContactPoints(bodyA=key[0], linkIndexA=key[1]):
                if contact[DISTANCE] <= 0.0 and self._rolling.has_triangles(contact[OTHER_BODY]):
                    end = dot(subtract(contact[POINT], centre), axis) > 0.0
                    ends.setdefault(end, []).append(contact)
            pushes = [push for contacts in ends.values() for push in _pushes(
                contacts, centre, axis)]
            if pushes:
                self._pushes[key] = pushes
        self._at.clear()


def _pushes(contacts: List[ContactPoint], centre: Vec3, axis: Vec3) -> List[_Push]:
    """Return the compensation for edge forces at one end of a cylinder: none or one push."""
    deepest = min(contacts, key=lambda contact: contact[DISTANCE])
    lever = subtract(deepest[POINT], centre)
    along = dot(lever, axis)
    radius = norm(_across(lever, axis))
    normal = _across(deepest[NORMAL], axis)
    reach = _CHORD * sqrt(-2.0 * deepest[DISTANCE] * radius)
    force, torque = ZERO3, 0.0
    for contact in contacts:
        own, load = _across(contact[NORMAL], axis), contact[LOAD]
        way = norm(_across(subtract(contact[POINT], deepest[POINT]), axis))
        if load <= 0.0 or way > reach or dot(own, normal) < _SAME:
            continue
        force = add(force, scale(subtract(normal, own), load))
        torque -= load * dot(axis, cross(subtract(contact[POINT], centre), own))
    if force == ZERO3 and torque == 0.0:
        return []
    return [_Push(force, add(centre, scale(axis, along)), scale(axis, torque))]


def _across(vector: Vec3, axis: Vec3) -> Vec3:
    """Return the component of a vector perpendicular to an axis."""
    return subtract(vector, scale(axis, dot(vector, axis)))


class LevelSeams(StepHelper):
    """Keeps sliding bodies on level floors, and undoes the pushes of sides below floor level.

    Args:
        fast: returns the rigid bodies that slide now.
        parameters: solver parameters of the world.
    """

    def __init__(self, fast: Callable[[], Collection[int]], parameters: WorldParameters) -> None:
        self._fast, self._parameters = fast, parameters
        self._bodies: Dict[int, Tuple[collision_groups.Filter, Vec3]] = {}   # and their axis
        self._static: Set[int] = set()
        self._floors: Set[int] = set()         # static bodies with sides
        self._sliding: Dict[int, Set[int]] = {}   # and the floors with its wide points
        self._level: Dict[int, Set[int]] = {}  # bodies near a seam, and level floors there
        self._before: Dict[int, _Velocity] = {}
        self.body_tables = (self._bodies, self._static, self._floors, self._sliding, self._level)

    def add(self, body: Body) -> None:
        """Register a new body; of moving ones, upright cylinders without joints."""
        part = body.parts[0]
        shapes = [collision.geometry for each in body.parts for collision in each.link.collisions]
        if body.moves:
            axis = axis_of(part.link)
            if body.rigid and axis is not None and any(
                    isinstance(each, Cylinder) for each in shapes):
                self._bodies[body.uid] = (collision_groups.moving(part.link), rotate(
                    conjugate(part.link_from_com.orientation), axis))
            return
        self._static.update(body.uids)
        if not any(isinstance(each, Plane) for each in shapes):
            self._floors.update(body.uids)

    def due(self, step: int) -> int:
        """Each step while a body is near a seam, otherwise the step of the next check."""
        if self._level:
            return step
        return next_multiple(step, EVERY) if self._bodies else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Find sliding bodies periodically; record the velocities of bodies near a seam."""
        if step % EVERY == 0:
            self._find_sliding(dt, gravity)
        self._before = {uid: pybullet.getBaseVelocity(uid) for uid in self._level}
        for uid in self._level:
            contacts = pybullet.getContactPoints(bodyA=uid)
            self._widen(uid, [contact[OTHER_BODY] for contact in contacts])

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Restore the velocities of before the step for bodies that a side pushed."""
        for uid, ((x, y, z), (_, _, turn)) in self._before.items():
            if self._is_caught(uid, self._level[uid]):
                pybullet.resetBaseVelocity(uid, (x, y, max(0.0, z)), (0.0, 0.0, turn))

    def _find_sliding(self, dt: float, gravity: Vec3) -> None:
        """Find the bodies that slide, and those that can reach a seam before the next check."""
        self._level.clear()
        fast = self._fast()
        for uid in [uid for uid in self._sliding if uid not in fast]:
            del self._sliding[uid]
        if gravity[0] == gravity[1] == 0.0:
            for uid in fast:
                floors = self._floors_under(uid) if uid in self._bodies else []
                if not floors:
                    self._sliding.pop(uid, None)
                    continue
                self._widen(uid, floors)
                if len(self._floors) > 1:
                    self._find_seam(uid, floors[0], EVERY * dt)

    def _widen(self, uid: int, floors: Collection[int]) -> None:
        """Drop the points of a body on a new floor; its next ones may slide apart farther."""
        wide = self._sliding.setdefault(uid, set())
        if not wide.issuperset(floors):
            self._bodies[uid][0].set(uid, BASE)
            self._parameters.request_spacing(_WIDE_SPACING)
        self._sliding[uid] = set(floors)

    def _floors_under(self, uid: int) -> List[int]:
        """Return the floors of an upright sliding body; none if it touches a moving body."""
        if norm((*pybullet.getBaseVelocity(uid)[0][:2], 0.0)) < _FAST:
            return []
        turn = pybullet.getBasePositionAndOrientation(uid)[1]
        if abs(rotate(turn, self._bodies[uid][1])[2]) < _UP:
            return []
        contacts = pybullet.getContactPoints(bodyA=uid)
        if any(contact[OTHER_BODY] not in self._static for contact in contacts):
            return []
        upright = sorted((contact for contact in contacts if contact[NORMAL][2] > _UP),
                         key=lambda contact: contact[DISTANCE])
        floors = {contact[OTHER_BODY]: None for contact in upright}
        if floors:   # the floor under it first, the sides that it touches last
            floors.update((contact[OTHER_BODY], None) for contact in contacts)
        return list(floors)

    def _find_seam(self, uid: int, floor: int, duration: float) -> None:
        """Store the level floors that a body can reach within `duration`, s, if more than one."""
        reach = norm(pybullet.getBaseVelocity(uid)[0]) * duration + _NEAR
        low, high = pybullet.getAABB(uid, BASE)
        found = pybullet.getOverlappingObjects([c - reach for c in low],
                                               [c + reach for c in high]) or ()
        near = {other for other, _ in found if other in self._floors}
        if floor in near and len(near) > 1:
            level = {other for other in near if abs(_top(other) - _top(floor)) < _LEVEL}
            if len(level) > 1:
                self._level[uid] = level

    @staticmethod
    def _is_caught(uid: int, level: Set[int]) -> bool:
        """Whether the side of a level floor pushes a body that touches only such floors."""
        pushing = [contact for contact in pybullet.getContactPoints(bodyA=uid)
                   if contact[LOAD] > 0.0 and contact[DISTANCE] <= 0.0]
        return (all(contact[OTHER_BODY] in level for contact in pushing)
                and any(contact[NORMAL][2] < _UP for contact in pushing))


def _top(uid: int) -> float:
    return float(pybullet.getAABB(uid, BASE)[1][2])
