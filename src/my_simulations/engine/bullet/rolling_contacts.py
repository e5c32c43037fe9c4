"""Make lying cylinders roll at constant speed, and keep them at rest on level floors.

Bullet's contact points lag behind the axle of a rolling cylinder and accelerate it. So the points
of lying cylinders are dropped before each step; the step finds new ones. It finds one, at one end
or the other, so overlaps with static bodies are separated as fast as possible without a jump
(figures: doc/dev/contacts.md, "Cylinders on their side").

A cylinder at rest would rock on such points. So a cylinder that hardly moves keeps its points, is
stopped in each step and set back, if the floor is level and no moving body, joint or timed force
acts on it. For a cylinder that already rocks, the velocity of one step means nothing. Its motion
between two checks, an even number of steps apart, decides instead.

With a friction pyramid, which is the cheaper model, wheels that a motor holds keep their points.
The motor takes up the small moment of points that lag.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import dist
from typing import AbstractSet, Any, Callable, Dict, Iterable, List, Optional, Set, Tuple

import pybullet

from ...description.model import Link
from ...description.shapes import Capsule, Cylinder, Empty, Heightmap, Mesh
from ...geometry import (
    IDENTITY,
    ZERO3,
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
from .contact_points import DISTANCE, NORMAL, OTHER_BODY, LinkKey
from .extra_surfaces import SOFT
from .link_states import read_com_pose
from .step_helper import FAR, StepHelper, next_multiple

EVERY = 8
"""Steps between two checks for lying cylinders."""

_LYING = 0.1        # of the contact normal along the axis: a cylinder below it lies on its side
_UPRIGHT = 0.9      # a cylinder above it stands on its end
_TURNING = 0.01     # rad/s: slower joints need no correction
_CREEP = 5e-3       # m/s: a slower cylinder counts as at rest
_CREEP_RATE = 0.2   # rad/s: the same for its angular velocity
_LEVEL = 1e-3       # of gravity along the floor: a floor below it is level
_ASLEEP = 3         # checks without velocity: then it sleeps, and Bullet does not move it
_STEADY = 0.1       # m/s: a faster cylinder on a static floor is checked half as often
_JOINT_WAIT = 3     # checks until a rolling wheel, or a free link of an arm, is checked again
_LONG_WAIT = 8      # checks until a sleeping or upright cylinder is checked again
_SHIFT = 1e-5       # m between two checks: a shorter motion is drift
_LARGEST_LAG = 0.1  # of a radius: five times the largest lag of Bullet's contact points

_USUAL_SEPARATION = 5.0   # 1/s: separation rate of the overlaps of all other contacts
_LARGEST_SHARE = 0.2      # largest share of an overlap that is removed in one step
_SEPARATION_FACTOR = 2.0  # separation speed of overlaps / speed that gravity adds in one step
_STIFFNESS = 1e12         # N/m: so high that Bullet's separation depends on the share only
_SHARE_TOLERANCE = 0.1    # smaller relative changes of the share are not applied


@dataclass
class _Roller:
    """A link that is round about one axis.

    Attributes:
        axis: of the cylinder, in the frame of its principal axes.
        hard: its contacts have no stiffness of their own, so this module sets their separation.
        still: consecutive checks without velocity.
        wait: number of the next checks that omit it.
        seen: its pose at the last check, if it lay on its side.
        on_triangles: whether it touched triangles at the last check.
        joint_row: of its axle; -1 without.
        lag_torque: upper bound of the torque of contact points that lag, per gravity, kg m.
    """

    body: Body
    part: Part
    axis: Vec3
    collision_filter: collision_groups.Filter
    hard: bool
    joint_row: int = -1
    lag_torque: float = 0.0
    still: int = 0
    wait: int = 0
    seen: Optional[Pose] = None
    on_triangles: bool = False
    share: float = 0.0   # of an overlap, removed in each step; 0: PyBullet's default


class RollingContacts(StepHelper):
    """Drops the contact points of lying cylinders before each step.

    Args:
        flies: returns whether a body certainly touches nothing in a step.
        loaded: returns the bodies that timed forces act on in this step.
        find_pairs: finds the new pairs of other bodies before a step with the spacing of contact
            points for cylinders on triangles, which all new pairs in that step get.
        holding: returns the effort, N m, with which the motor or brake of a joint row acts.

    Attributes:
        on_triangles: links that roll on triangles now, and their axes in their principal axes.
    """

    events = COMMANDED

    def __init__(self, flies: Callable[[int, int], bool], loaded: Callable[[], AbstractSet[int]],
                 find_pairs: Callable[[], None], holding: Callable[[int], float]) -> None:
        self._flies, self._loaded, self._find_pairs = flies, loaded, find_pairs
        self._holding, self._cone = holding, True
        self.on_triangles: Dict[LinkKey, Vec3] = {}
        self._rollers: Dict[LinkKey, _Roller] = {}
        self._rolling: Dict[LinkKey, collision_groups.Filter] = {}
        self._kept_at_rest: Dict[int, Pose] = {}
        self._landed: Set[int] = set()   # in this step, and the bodies on which they land
        self._moving: Set[int] = set()
        self._triangle_floors: Set[int] = set()   # floors of triangles
        self.body_tables = (self.on_triangles, self._rollers, self._rolling, self._kept_at_rest,
                            self._moving, self._triangle_floors)

    def configure(self, cone: bool) -> None:
        """Drop the points of all wheels (friction cone), or of those without a strong motor."""
        self._cone = cone

    def add(self, body: Body) -> None:
        """Register a new body; only moving links that are cylinders about one axis matter."""
        if body.moves:
            self._moving.add(body.uid)
        elif any(isinstance(each.geometry, (Heightmap, Mesh)) for part in body.parts
                 for each in part.link.collisions):
            self._triangle_floors.update(set(body.uids) - body.with_role("faces"))
        rows = {axis.index: axis.row for axis in body.axes}
        total = sum(part.mass for part in body.parts)
        for part in body.parts if body.moves else ():
            axis = axis_of(part.link)
            if axis is not None:
                self._rollers[body.uid, part.index] = _Roller(
                    body, part, rotate(conjugate(part.link_from_com.orientation), axis),
                    collision_groups.moving(part.link),
                    part.link.collisions[0].surface.kp >= SOFT, rows.get(part.index, -1),
                    _LARGEST_LAG * total * _largest_radius(part.link))

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Treat a rigid body as rolling after a command changed its pose or velocity.

        A force or a motor target matters only for cylinders at rest on their side; upright
        cylinders keep their points.
        """
        if event in ACTUATED and body.uid not in self._kept_at_rest:
            return
        self._kept_at_rest.pop(body.uid, None)
        roller = self._rollers.get((body.uid, BASE)) if body.rigid else None
        if roller is not None:
            roller.still = roller.wait = 0
            roller.seen = None
            self._rolling[body.uid, BASE] = roller.collision_filter

    def landed(self, uid: int, other: int, normal: Vec3) -> None:
        """Keep the contact points of a landing in this step; for an upright cylinder longer."""
        if self._rolling:
            self._landed |= {uid, other}
        roller = self._rollers.get((uid, BASE))
        if roller is not None and (uid, BASE) in self._rolling:
            turn = pybullet.getBasePositionAndOrientation(uid)[1]
            if abs(dot(normal, rotate(turn, roller.axis))) > _UPRIGHT:
                del self._rolling[uid, BASE]

    def rolls(self, uid: int) -> bool:
        """Whether a rigid body rolls on its side."""
        return (uid, BASE) in self._rolling

    @property
    def can_roll_on_triangles(self) -> bool:
        """Whether something may roll on triangles."""
        return bool(self._triangle_floors and self._rollers)

    def has_triangles(self, uid: int) -> bool:
        """Whether a body is a floor of triangles."""
        return uid in self._triangle_floors

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Find rolling links periodically, and drop their contact points."""
        if step % EVERY == 0 and self._rollers:
            loaded = self._loaded()
            for key, roller in self._rollers.items():
                if roller.wait:
                    roller.wait -= 1
                elif self._flies(key[0], step):
                    continue
                elif self._rolls(roller, dt, gravity, roller.body.uid in loaded):
                    self._rolling[key] = roller.collision_filter
                else:
                    self._rolling.pop(key, None)
            if self._triangle_floors:
                self.on_triangles.clear()
                self.on_triangles.update((key, self._rollers[key].axis) for key in self._rolling
                                     if self._rollers[key].on_triangles)
        for uid in self._kept_at_rest:
            linear, angular = pybullet.getBaseVelocity(uid)
            if (linear != ZERO3 or angular != ZERO3) and _slow(linear, angular):
                pybullet.resetBaseVelocity(uid, ZERO3, ZERO3)
        flies, landed = self._flies, self._landed
        rolling = [key for key in self._rolling
                   if key[0] not in landed and not flies(key[0], step)]
        landed.clear()
        if self.on_triangles:
            self._clear_contacts([key for key in rolling if key not in self.on_triangles])
            if not self._moving.issubset({uid for uid, _ in self.on_triangles}):
                self._find_pairs()
            rolling = [key for key in rolling if key in self.on_triangles]
        self._clear_contacts(rolling)

    def _clear_contacts(self, links: Iterable[LinkKey]) -> None:
        """Discard the contact points of links.

        Bullet does so when a filter group is set, and finds new ones in the next step.
        """
        for key in links:
            self._rolling[key].set(*key)

    def due(self, step: int) -> int:
        """Each step while a link rolls or is kept at rest, otherwise the step of the next check."""
        if self._rolling or self._kept_at_rest:
            return step
        return next_multiple(step, EVERY) if self._rollers else FAR

    def _rolls(self, roller: _Roller, dt: float, gravity: Vec3, loaded: bool) -> bool:
        """Whether a link lies on its side and moves; if it is at rest, keep it there."""
        uid, index = roller.body.uid, roller.part.index
        if roller.body.rigid:
            linear, angular = pybullet.getBaseVelocity(uid)
            seen, roller.seen = roller.seen, None
            roller.still = roller.still + 1 if linear == angular == ZERO3 else 0
            if roller.still:
                if roller.still >= _ASLEEP:
                    self._kept_at_rest.pop(uid, None)
                    roller.wait = _LONG_WAIT
                return False
        elif self._keeps_points(roller, norm(gravity)):
            roller.wait = _JOINT_WAIT
            return False
        elif index != BASE and abs(pybullet.getJointState(uid, index)[1]) < _TURNING:
            return False
        contacts = pybullet.getContactPoints(bodyA=uid, linkIndexA=index)
        depth, least, most, on_moving, on_triangles = 0.0, 1.0, 0.0, False, False
        # Without contacts the pose is not needed.
        at = Pose(*read_com_pose(uid, index)) if contacts else IDENTITY
        x, y, z = rotate(at.orientation, roller.axis)
        for contact in contacts:
            a, b, c = contact[NORMAL]
            along = abs(a * x + b * y + c * z)
            least, most = min(least, along), max(most, along)
            depth = max(depth, -contact[DISTANCE])
            on_moving = on_moving or contact[OTHER_BODY] in self._moving
            on_triangles = on_triangles or contact[OTHER_BODY] in self._triangle_floors
        if roller.hard:
            usual = on_moving or on_triangles and not roller.body.rigid
            self._set_separation_rate(roller, 0.0 if usual else depth, dt, norm(gravity))
        if not contacts:
            roller.wait = _JOINT_WAIT if roller.body.base is None else 0   # an arm
            return (uid, index) in self._rolling
        roller.on_triangles = on_triangles
        if most > _LYING:
            roller.wait = _LONG_WAIT if least > _UPRIGHT else 0
            return False
        if roller.body.rigid:
            before = self._kept_at_rest.pop(uid, None)
            roller.seen = at
            rocks = seen is not None and norm(linear) < _CREEP + norm(gravity) * dt and _slow(
                *_mean(seen, at, EVERY * dt))
            if ((rocks or _slow(linear, angular)) and not loaded and not roller.body.ties
                    and not on_moving and _is_level(contacts, gravity)):
                self._keep_at_rest(uid, at, before)
                return False
            roller.wait = int(not on_moving and not on_triangles and norm(linear) > _STEADY)
            roller.seen = None if roller.wait else at
        else:
            roller.wait = _JOINT_WAIT
        return True

    def _keeps_points(self, roller: _Roller, weight: float) -> bool:
        """Whether a wheel keeps its points, because its motor resists the torque of their lag.

        Not in worlds with triangles, whose edges push a wheel against its way.
        """
        return (not self._cone and roller.joint_row >= 0 and not self._triangle_floors
                and self._holding(roller.joint_row) >= roller.lag_torque * weight > 0.0)

    def _set_separation_rate(self, roller: _Roller, depth: float, dt: float, weight: float) -> None:
        """Set the separation rate of overlaps of a link with static bodies; `depth`: in m.

        Wheels on triangles keep the usual rate; a higher one at edges would accelerate them.
        `weight`: gravity, m/s^2.
        """
        share = least = min(_LARGEST_SHARE, _USUAL_SEPARATION * dt)
        key = roller.body.uid, roller.part.index
        if depth > 0.0 and key in self._rolling:
            share = min(_LARGEST_SHARE, max(least, _SEPARATION_FACTOR * weight * dt * dt / depth))
        if abs(share - (roller.share or least)) > _SHARE_TOLERANCE * share:
            roller.share = share
            pybullet.changeDynamics(*key, contactStiffness=_STIFFNESS,
                                    contactDamping=dt * _STIFFNESS * (1.0 / share - 1.0))

    def _keep_at_rest(self, uid: int, at: Pose, before: Optional[Pose]) -> None:
        """Keep a body at rest; set it back to its pose at the last check if it only drifted."""
        if before is not None and dist(at.position, before.position) < _SHIFT:
            x, y, _ = before.position
            at = Pose((x, y, at.position[2]), before.orientation)
            pybullet.resetBasePositionAndOrientation(uid, at.position, at.orientation)
        self._kept_at_rest[uid] = at


def _is_level(contacts: Tuple[Any, ...], gravity: Vec3) -> bool:
    """Whether all contacts of a body are with level floors.

    Points without overlap, as of triangle edges beside it, may be inclined.
    """
    limit = _LEVEL * norm(gravity)
    return all(contact[DISTANCE] > 0.0 or norm(cross(contact[NORMAL], gravity)) <= limit
               for contact in contacts)


def _slow(linear: Vec3, angular: Vec3) -> bool:
    return norm(linear) < _CREEP and norm(angular) < _CREEP_RATE


def _mean(before: Pose, after: Pose, duration: float) -> Tuple[Vec3, Vec3]:
    """Return the mean linear and angular velocity between two poses, `duration` s apart."""
    turn = rotation_vector(multiply(after.orientation, conjugate(before.orientation)))
    return (scale(subtract(after.position, before.position), 1.0 / duration),
            scale(turn, 1.0 / duration))


def axis_of(link: Link) -> Optional[Vec3]:
    """Return the common axis of a link's cylinders and capsules, in the link frame, or None."""
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


def _largest_radius(link: Link) -> float:
    """Return the largest radius of the cylinders and capsules of a link, m."""
    return max(collision.geometry.radius for collision in link.collisions
               if isinstance(collision.geometry, (Cylinder, Capsule)))
