"""Lets lying cylinders roll as they should: neither on by themselves, nor ever faster.

Bullet keeps the contact points of a pair from step to step where they were on the surfaces. On a
cylinder that turns they lag 0.2 to 0.4 mm behind the axle, and what they carry there drives it on:
a can pushed to 0.05 m/s rolled at 0.4 m/s after 20 s, one at rest rolled out of the room. So the
points of lying cylinders are dropped before each step; the step finds new ones.

A step finds one new point, at one end or the other, so only one end is pushed out of the floor at a
time: at the rate of other contacts a cylinder of 3 cm rolls 1.9 mm deep, where Bullet is so inexact
on boxes that it loses 2 % of 0.05 m/s in 20 s (measured). Where a cylinder rolls on what does
not move, its overlaps are therefore parted as fast as that gives it no velocity to jump with.

A cylinder at rest would rock on such points. So one that hardly moves, where the floor is level and
nothing that moves, no joint and no timed force acts on it, keeps its points, and is stopped in
every step and put back. One that rocks already is judged by its way between two looks, an even
count of steps: the velocity of a step says nothing then.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import dist
from typing import AbstractSet, Any, Callable, Dict, List, Optional, Set, Tuple

import pybullet

from ...description.model import Link
from ...description.shapes import Capsule, Cylinder, Empty, Heightmap, Mesh
from ...geometry import (
    Pose,
    Vec3,
    conjugate,
    cross,
    dot,
    multiply,
    norm,
    rotate,
    rotation_vector,
    scale,
    subtract,
)
from ..body_plan import BASE
from . import collision_groups
from .bodies import Body, Part
from .body_events import ACTUATED, COMMANDED, BodyEvent
from .extra_surfaces import SOFT
from .link_states import place
from .step_helper import FAR, StepHelper, next_multiple

EVERY = 8
"""Steps between two looks at who lies."""

_LYING = 0.1      # of the contact normal along the axis: less is a cylinder on its side
_UPRIGHT = 0.9    # more is one on its end
_TURNS = 0.01     # rad/s: joints slower than that need nothing
_CREEP = 5e-3     # m/s: what rolls slower stands
_TURN = 0.2       # rad/s: the same for its turning
_LEVEL = 1e-3     # of gravity along the floor: less is a level one
_ASLEEP = 3       # looks without velocity: it sleeps, and Bullet leaves it alone
_HINGED = 3       # looks until a wheel that rolls is looked at again
_PATIENCE = 8     # looks until one that sleeps, or stands on its end, is looked at again
_SHIFT = 1e-5     # m between two looks: less is not its own
_NONE = (0.0, 0.0, 0.0)

_PARTING = 5.0      # 1/s: the rate at which overlaps of all other contacts are parted
_MOST = 0.2         # the largest share of an overlap that is parted in one step
_PUSH = 2.0         # of the speed that gravity gives in one step: what an overlap is parted with
_HARD = 1e12        # N/m: so stiff that only the share counts
_CHANGE = 0.1       # smaller changes of the share are not worth a call


Key = Tuple[int, int]  # body uid, link index


@dataclass
class _Roller:
    """A round link: its axis in the frame of its principal axes; looks without velocity.

    Attributes:
        hard: its contacts are no springs, so how they part is ours to say.
        wait: looks at which it need not be looked at.
        seen: where it was at the last look, if it lay on its side.
        seamed: it touches triangles.
    """

    body: Body
    part: Part
    axis: Vec3
    meets: collision_groups.Filter
    hard: bool
    still: int = 0
    wait: int = 0
    seen: Optional[Pose] = None
    seamed: bool = False
    share: float = 0.0   # of an overlap, parted in each step; 0: as PyBullet has it


class RollingContacts(StepHelper):
    """Drops the contact points of lying cylinders before each step.

    Args:
        dropping: is told, before that, of which links points are dropped, and in which step.
        loaded: tells the bodies that timed forces act on in this step.
        flies: returns whether a body is known to touch nothing in a step.
        find_pairs: finds the pairs that are new, before a step that is set up for what rolls on
            triangles: the others would keep points as close together as those of such a pair.

    Attributes:
        on_seams: what rolls on triangles just now, and its axis in the frame of its principal axes.
    """

    events = COMMANDED

    def __init__(self, dropping: Callable[[AbstractSet[Key], int], None],
                 loaded: Callable[[], AbstractSet[int]],
                 flies: Callable[[int, int], bool],
                 find_pairs: Callable[[], None]) -> None:
        self._find_pairs = find_pairs
        self._dropping, self._loaded, self._flies = dropping, loaded, flies
        self.on_seams: Dict[Key, Vec3] = {}
        self._rollers: Dict[Key, _Roller] = {}
        self._rolling: Dict[Key, collision_groups.Filter] = {}
        self._standing: Dict[int, Pose] = {}
        self._moving: Set[int] = set()
        self._seams: Set[int] = set()   # floors of triangles

    def add(self, body: Body, part: Part, link: Link) -> None:
        """Know a link of a body; only moving ones that are cylinders about one axis matter."""
        if body.moves:
            self._moving.add(body.uid)
        elif any(isinstance(each.geometry, (Heightmap, Mesh)) for each in link.collisions):
            self._seams.update(set(body.uids) - body.faces)
        axis = axis_of(link)
        if axis is not None and body.moves:
            own = rotate(conjugate(part.link_from_com.orientation), axis)
            self._rollers[body.uid, part.index] = _Roller(body, part, own,
                                                          collision_groups.moving(link),
                                                          link.collisions[0].surface.kp >= SOFT)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._standing.pop(body.uid, None)
        self._moving.discard(body.uid)
        self._seams.difference_update(body.uids)
        for part in body.parts:
            for table in (self._rollers, self._rolling, self.on_seams):
                table.pop((body.uid, part.index), None)

    def clear(self) -> None:
        """All bodies are gone."""
        self.on_seams.clear()
        self._rollers.clear()
        self._rolling.clear()
        self._standing.clear()
        self._moving.clear()
        self._seams.clear()

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """A rigid body was put somewhere or given another velocity: it may roll at once.

        A force or a motor moves what lies still only: what stands on its end keeps its points.
        """
        if event in ACTUATED and body.uid not in self._standing:
            return
        self._standing.pop(body.uid, None)
        roller = self._rollers.get((body.uid, BASE)) if body.rigid else None
        if roller is not None:
            roller.still = roller.wait = 0
            roller.seen = None
            self._rolling[body.uid, BASE] = roller.meets

    def landed(self, uid: int, normal: Vec3) -> None:
        """A rigid body is about to touch something: if it stands on it, it keeps its points."""
        roller = self._rollers.get((uid, BASE))
        if roller is not None and (uid, BASE) in self._rolling:
            turn = pybullet.getBasePositionAndOrientation(uid)[1]
            if abs(dot(normal, rotate(turn, roller.axis))) > _UPRIGHT:
                del self._rolling[uid, BASE]

    def rolls(self, uid: int) -> bool:
        """Whether a rigid body rolls on its side."""
        return (uid, BASE) in self._rolling

    @property
    def knows_seams(self) -> bool:
        """Whether something may roll on triangles."""
        return bool(self._seams and self._rollers)

    def is_seamed(self, uid: int) -> bool:
        """Whether a body is a floor of triangles."""
        return uid in self._seams

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Find out now and then who rolls, and let it roll in the next step."""
        if step % EVERY == 0 and self._rollers:
            loaded = self._loaded()
            for key, roller in self._rollers.items():
                if roller.wait:
                    roller.wait -= 1
                elif self._flies(key[0], step):
                    continue
                elif self._rolls(roller, dt, gravity, roller.body.uid in loaded):
                    self._rolling[key] = roller.meets
                else:
                    self._rolling.pop(key, None)
            if self._seams:
                self.on_seams = {key: self._rollers[key].axis for key in self._rolling
                                 if self._rollers[key].seamed}
        for uid in self._standing:
            linear, angular = pybullet.getBaseVelocity(uid)
            if (linear != _NONE or angular != _NONE) and _slow(linear, angular):
                pybullet.resetBaseVelocity(uid, _NONE, _NONE)
        self._dropping(self._rolling.keys(), step)
        self._drop(self._rolling.keys() - self.on_seams.keys(), step)
        if self.on_seams:
            if not self._moving.issubset({uid for uid, _ in self.on_seams}):
                self._find_pairs()
            self._drop(self.on_seams.keys(), step)

    def _drop(self, keys: AbstractSet[Key], step: int) -> None:
        """Drop the contact points of links, those of one set in the order of `_rolling`."""
        for key, meets in self._rolling.items():
            if key in keys and not self._flies(key[0], step):
                pybullet.setCollisionFilterGroupMask(*key, meets.group, meets.mask)

    def due(self, step: int) -> int:
        """Each step while something rolls, or stands, else the next look."""
        if self._rolling or self._standing:
            return step
        return next_multiple(step, EVERY) if self._rollers else FAR

    def _rolls(self, roller: _Roller, dt: float, gravity: Vec3, loaded: bool) -> bool:
        """Whether a link lies on its side and does not stand; finds out whether it does."""
        uid, index = roller.body.uid, roller.part.index
        if roller.body.rigid:
            linear, angular = pybullet.getBaseVelocity(uid)
            seen, roller.seen = roller.seen, None
            roller.still = roller.still + 1 if linear == angular == _NONE else 0
            if roller.still:
                if roller.still >= _ASLEEP:
                    self._standing.pop(uid, None)
                    roller.wait = _PATIENCE
                return False
            at = Pose(*pybullet.getBasePositionAndOrientation(uid))
            turn = at.orientation
        elif index != BASE and abs(pybullet.getJointState(uid, index)[1]) < _TURNS:
            return False
        else:
            turn = place(uid, index)[1]
        axis = rotate(turn, roller.axis)
        contacts = pybullet.getContactPoints(bodyA=uid, linkIndexA=index)
        if roller.hard:
            self._part(roller, contacts, dt, norm(gravity))
        if not contacts:
            return (uid, index) in self._rolling
        roller.seamed = any(contact[2] in self._seams for contact in contacts)
        if any(abs(dot(contact[7], axis)) > _LYING for contact in contacts):
            roller.wait = _PATIENCE if all(
                abs(dot(contact[7], axis)) > _UPRIGHT for contact in contacts) else 0
            return False
        if roller.body.rigid:
            before = self._standing.pop(uid, None)
            roller.seen = at
            rocks = seen is not None and norm(linear) < _CREEP + norm(gravity) * dt and _slow(
                *_mean(seen, at, EVERY * dt))
            if ((rocks or _slow(linear, angular)) and not loaded and not roller.body.ties
                    and self._on_level(contacts, gravity)):
                self._stand(uid, before)
                return False
        else:
            roller.wait = _HINGED
        return True

    def _part(self, roller: _Roller, contacts: Tuple[Any, ...], dt: float, weight: float) -> None:
        """Set how fast the overlaps of a link are parted. `weight`: gravity, m/s^2.

        Wheels keep the usual rate on triangles, whose edges would drive them on.
        """
        share = least = min(_MOST, _PARTING * dt)
        key = roller.body.uid, roller.part.index
        depth = max((-contact[8] for contact in contacts), default=0.0)
        if depth > 0.0 and key in self._rolling and not any(
                contact[2] in self._moving or (contact[2] in self._seams and not roller.body.rigid)
                for contact in contacts):
            share = min(_MOST, max(least, _PUSH * weight * dt * dt / depth))
        if abs(share - (roller.share or least)) > _CHANGE * share:
            roller.share = share
            pybullet.changeDynamics(*key, contactStiffness=_HARD,
                                    contactDamping=dt * _HARD * (1.0 / share - 1.0))

    def _stand(self, uid: int, before: Optional[Pose]) -> None:
        """Let a body stand where it stood at the last look, if it did and moved since by itself."""
        at = Pose(*pybullet.getBasePositionAndOrientation(uid))
        if before is not None and dist(at.position, before.position) < _SHIFT:
            x, y, _ = before.position
            at = Pose((x, y, at.position[2]), before.orientation)
            pybullet.resetBasePositionAndOrientation(uid, at.position, at.orientation)
        self._standing[uid] = at

    def _on_level(self, contacts: Tuple[Any, ...], gravity: Vec3) -> bool:
        """Whether a body only stands on level floors that do not move.

        Edges of triangles beside it, which carry nothing, may be inclined.
        """
        limit = _LEVEL * norm(gravity)
        return all(contact[2] not in self._moving and (
            contact[8] > 0.0 or norm(cross(contact[7], gravity)) <= limit)
                   for contact in contacts)


def _slow(linear: Vec3, angular: Vec3) -> bool:
    return norm(linear) < _CREEP and norm(angular) < _TURN


def _mean(before: Pose, after: Pose, duration: float) -> Tuple[Vec3, Vec3]:
    """The velocities, linear and angular, that lead from one pose to another in `duration` s."""
    turn = rotation_vector(multiply(after.orientation, conjugate(before.orientation)))
    return (scale(subtract(after.position, before.position), 1.0 / duration),
            scale(turn, 1.0 / duration))


def axis_of(link: Link) -> Optional[Vec3]:
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
