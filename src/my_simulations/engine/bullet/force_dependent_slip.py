"""Force-dependent slip (slip1, slip2): a surface that slips by its slip times the friction force.

Source: ODE's manual, "Contact"; Gazebo Classic 11 adds up the slips of the two surfaces, and counts
them for the whole pair, however many points touch. Bullet's friction knows no slip, so it is taken
away from such links (a share of 0.001 stays) and acts as an external force of ours. With the slip
velocity v, the slip s and the force F of the step before, the next one is

    F' = (h F - v) / (s + h),  at most mu times the normal force,

where h is how much velocity a force gives in one step: where nothing changes any more v = -s F
exactly, and a slip that is stiff against the step (s less than h) does not overshoot for long. One
that is stiffer still (a wheel that hardly turns) is none, and Bullet's friction acts.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Iterable, Iterator, List, Optional, Tuple

import pybullet

from ...description.link_surface import counting_collision
from ...description.model import Link
from ...description.shapes import Surface
from ...geometry import (
    ZERO3,
    Vec3,
    add,
    conjugate,
    cross,
    dot,
    norm,
    rotate,
    scale,
    subtract,
)
from ..body_plan import BASE
from ..drive_commands import WheelSlip
from .bodies import Axis, Body, Part
from .extra_surfaces import anisotropy
from .surface_coefficients import directed, of_link

_STIFF = 0.02           # of h: a slip below it is none
_LEFT = 1e-3            # share of Bullet's friction that stays where ours acts
_NEAR = 0.05            # m: a point that has moved further in one step is another one
_LEAST_MOMENT = 1e-9    # kg m^2

Key = Tuple[int, int]   # body uid, link index
Contacts = List[Tuple[Any, ...]]  # as PyBullet tells them


@dataclass
class _Slippery:
    """A link that is known.

    Attributes:
        slips: m/(N s), along and across `first`; across is along where there is no `first`.
        first: the first direction, in the principal axes; None where slips have no direction.
        mus: coefficients along and across.
    """

    part: Part
    moves: bool
    slips: Tuple[float, float]
    first: Optional[Vec3]
    mus: Tuple[float, float]
    ours: Tuple[bool, bool] = (False, False)   # directions in which Bullet's friction is off

    @property
    def slides(self) -> bool:
        """Whether it slips by itself."""
        return any(self.slips)


@dataclass
class _Pair:
    """Two links that touch: what acts on the first, along and across, N."""

    force: Tuple[float, float] = (0.0, 0.0)
    points: Dict[Vec3, Vec3] = field(default_factory=dict)


def slips(link: Link) -> bool:
    """Whether a link slips by itself."""
    surface = of_link(link)
    return bool(surface.slip1 or (surface.slip2 and any(surface.fdir1)))


class ForceDependentSlip:
    """Lets links slip."""

    def __init__(self) -> None:
        self._links: Dict[Key, _Slippery] = {}
        self._rows: Dict[int, List[Key]] = {}
        self._axes: Dict[int, Tuple[Body, Axis]] = {}
        self._slides: Dict[Key, _Slippery] = {}
        self._pairs: Dict[Tuple[Key, Key], _Pair] = {}
        self._wheels: Dict[int, WheelSlip] = {}

    @property
    def idle(self) -> bool:
        """True when nothing slips."""
        return not self._slides

    def add(self, body: Body, part: Part, link: Link) -> None:
        """Know a link of a body; of its surfaces the one that counts."""
        collision = counting_collision(link)
        surface = Surface() if collision is None else collision.surface
        slips, first = (surface.slip1, surface.slip2), None
        if collision is not None and any(surface.fdir1):
            first = rotate(conjugate(part.link_from_com.orientation),
                           rotate(collision.pose.orientation, surface.fdir1))
            first = scale(first, 1.0 / norm(first))
        else:
            slips = (surface.slip1, surface.slip1)
        known = _Slippery(part, body.moves, slips, first, (
            surface.mu, surface.mu2 if directed(surface) else surface.mu))
        for axis in body.axes:
            self._axes[axis.row] = (body, axis)
        for uid in body.uids:
            key = (uid, part.index)
            self._links[key] = known
            self._rows.setdefault(part.row, []).append(key)
            if known.slides:
                self._slides[key] = known

    def forget(self, body: Body) -> None:
        """A body is gone."""
        for axis in body.axes:
            self._axes.pop(axis.row, None)
        for part in body.colliders:
            self._wheels.pop(part.row, None)
            for key in self._rows.pop(part.row, []):
                self._links.pop(key, None)
                self._slides.pop(key, None)
        for pair in [pair for pair in self._pairs
                     if pair[0][0] in body.uids or pair[1][0] in body.uids]:
            del self._pairs[pair]

    def clear(self) -> None:
        """All bodies are gone."""
        for table in (self._links, self._rows, self._axes, self._slides, self._pairs,
                      self._wheels):
            table.clear()

    def set_wheels(self, wheels: Iterable[WheelSlip]) -> None:
        """Let wheels slip by their own speed; those of links that have gone are ignored."""
        for wheel in wheels:
            if wheel.row in self._rows and wheel.joint_row in self._axes:
                self._wheels[wheel.row] = wheel
                self._slides.update({key: self._links[key] for key in self._rows[wheel.row]})

    def friction(self, uid: int, index: int, at: Vec3) -> Vec3:
        """What acts on a link at a contact besides Bullet's friction, N, world axes."""
        best, found = _NEAR, ZERO3
        for (one, _), pair in self._pairs.items():
            for point, force in pair.points.items() if one == (uid, index) else ():
                away = norm(subtract(at, point))
                if away < best:
                    best, found = away, force
        return found

    def forces_on(self, uid: int) -> Iterator[Tuple[int, Vec3, Vec3]]:
        """What acted on the links of a body in the last step: index, force, where; world axes."""
        for (one, two), pair in self._pairs.items():
            for at, force in pair.points.items():
                if one[0] == uid:
                    yield one[1], force, at
                if two[0] == uid:
                    yield two[1], scale(force, -1.0), at

    def apply(self, dt: float) -> None:
        """Act before the next step of `dt` s."""
        for wheel in self._wheels.values():
            self._turn(wheel)
        before, self._pairs = self._pairs, {}
        for key, link in self._slides.items():
            found: Dict[Key, Contacts] = {}
            for contact in pybullet.getContactPoints(bodyA=key[0]):
                if contact[3] == key[1] and contact[9] > 0.0 and contact[8] <= 0.0:
                    found.setdefault((contact[2], contact[4]), []).append(contact)
            ours = [False, False]
            for other, contacts in found.items():
                if other in self._links and not (other in self._slides and other < key):
                    pair = self._pairs[key, other] = before.get((key, other), _Pair())
                    for n, soft in enumerate(self._rub(key, other, contacts, pair, dt)):
                        ours[n] = ours[n] or soft
            if found:
                _take(key, link, (ours[0], ours[1]))

    # -- links -------------------------------------------------------------------------------------

    def _turn(self, wheel: WheelSlip) -> None:
        """Slips of a wheel from how fast it turns."""
        body, axis = self._axes[wheel.joint_row]
        rate = pybullet.getJointState(body.uid, axis.index)[1]
        share = wheel.radius * abs(rate) / wheel.normal_force
        for key in self._rows[wheel.row]:
            self._links[key].slips = (share * wheel.lateral, share * wheel.longitudinal)

    # -- pairs -------------------------------------------------------------------------------------

    def _rub(self, key: Key, other: Key, contacts: Contacts, pair: _Pair,
             dt: float) -> List[bool]:
        """Work out and apply the friction of two links; in which directions there is a slip."""
        one, two = self._links[key], self._links[other]
        mine, theirs = _state(key), _state(other)
        carried = sum(contact[9] for contact in contacts)
        normal = scale(contacts[0][7], 1.0 / norm(contacts[0][7]))
        along = _along(one, mine, normal) or _along(two, theirs, normal) or _any_across(normal)
        across = cross(normal, along)
        velocities = [subtract(_velocity(mine, contact[5]), _velocity(theirs, contact[5]))
                      for contact in contacts]
        slip = ZERO3
        for contact, velocity in zip(contacts, velocities):
            slip = add(slip, scale(velocity, contact[9] / carried))
        gain = dt * (_ease(one, mine, contacts) + _ease(two, theirs, contacts))
        soft = [one.slips[n] + two.slips[n] for n in (0, 1)]
        slides = [each > _STIFF * gain for each in soft]
        forces = []
        for n, axis in enumerate((along, across)):
            wanted = (gain * pair.force[n] - dot(slip, axis)) / (soft[n] + gain) if slides[n] else 0
            most = min(one.mus[n], two.mus[n]) * carried
            forces.append(max(-most, min(most, wanted)))
        if one.first is None and two.first is None:     # a cone
            size, most = (forces[0] ** 2 + forces[1] ** 2) ** 0.5, min(
                one.mus[0], two.mus[0]) * carried
            forces = [force * min(1.0, most / size) if size else 0.0 for force in forces]
        pair.force = (forces[0], forces[1])
        force = add(scale(along, forces[0]), scale(across, forces[1]))
        pair.points = {}
        for contact, velocity in zip(contacts, velocities):
            share = scale(force, contact[9] / carried)
            turning = subtract(velocity, slip)
            for n, axis in enumerate((along, across)):
                if slides[n]:   # what turns about the contact's middle
                    share = add(share, scale(axis, -dot(turning, axis)
                                             / (len(contacts) * (soft[n] + gain))))
            pair.points[contact[5]] = share
            if one.moves:
                pybullet.applyExternalForce(*key, share, contact[5], pybullet.WORLD_FRAME)
            if two.moves:
                pybullet.applyExternalForce(*other, scale(share, -1.0), contact[5],
                                            pybullet.WORLD_FRAME)
        return slides


def _take(key: Key, link: _Slippery, ours: Tuple[bool, bool]) -> None:
    """Take Bullet's friction away in the directions in which ours acts."""
    if ours == link.ours:
        return
    link.ours = ours
    left = _LEFT if ours[0] else 1.0, _LEFT if ours[1] else 1.0
    pybullet.changeDynamics(
        *key, anisotropicFriction=anisotropy(link.mus, link.first or ZERO3, left))


_State = Tuple[Vec3, Any, Vec3, Vec3]   # position, orientation, velocities


def _state(key: Key) -> _State:
    uid, index = key
    if index == BASE:
        return (*pybullet.getBasePositionAndOrientation(uid), *pybullet.getBaseVelocity(uid))
    found = pybullet.getLinkState(uid, index, computeLinkVelocity=1, computeForwardKinematics=1)
    return (found[0], found[1], found[6], found[7])


def _velocity(state: _State, at: Vec3) -> Vec3:
    return add(state[2], cross(state[3], subtract(at, state[0])))


def _along(link: _Slippery, state: _State, normal: Vec3) -> Optional[Vec3]:
    """The first direction in the plane of contact, or none."""
    if link.first is None:
        return None
    first = rotate(state[1], link.first)
    flat = subtract(first, scale(normal, dot(first, normal)))
    size = norm(flat)
    return scale(flat, 1.0 / size) if size > 1e-6 else None


def _any_across(normal: Vec3) -> Vec3:
    x, y, z = normal
    found = (0.0, -z, y) if abs(z) > 0.7 else (-y, x, 0.0)
    return scale(found, 1.0 / norm(found))


def _ease(link: _Slippery, state: _State, contacts: Contacts) -> float:
    """How easily a force at a contact accelerates a link, at most, 1/kg."""
    if not link.moves or link.part.mass <= 0.0:
        return 0.0
    arm = max(norm(subtract(contact[5], state[0])) for contact in contacts)
    return 1.0 / link.part.mass + arm * arm / max(_LEAST_MOMENT, min(link.part.moments))
