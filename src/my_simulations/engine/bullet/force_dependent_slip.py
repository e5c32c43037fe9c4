"""Force-dependent slip (slip1, slip2): the slip velocity is the slip times the friction force.

Source: ODE's manual, "Contact". Gazebo Classic 11 adds the slips of the two surfaces, and applies
the sum to the whole pair, for any number of contact points. Bullet's friction has no such slip. So
it is reduced to a share of 0.001 for such links, and this module applies friction as an external
force. With the slip velocity v, the slip s and the force F of the last step, the next force is

    F' = (h F - v) / (s + h),  at most mu times the normal force,

where h is the velocity change per force in one step, s/kg. In a steady state v = -s F exactly.
For a slip below h the overshoot decays quickly. A slip far below h (a wheel that hardly turns)
counts as no slip, and Bullet's friction acts.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, Iterable, Iterator, List, Optional, Tuple

import pybullet

from ...description.link_surface import counting_collision
from ...description.model import Link
from ...description.shapes import Surface
from ...geometry import (
    ZERO3,
    Vec3,
    add,
    cross,
    dot,
    norm,
    rotate,
    scale,
    subtract,
)
from ..drive_commands import WheelSlip
from .bodies import Axis, Body, Part
from .contact_points import (
    DISTANCE,
    LINK,
    LOAD,
    NORMAL,
    OTHER_BODY,
    OTHER_LINK,
    PLACE,
    ContactPoint,
    LinkKey,
)
from .extra_surfaces import anisotropy, first_direction
from .link_states import Motion, motion
from .surface_coefficients import directed, of_link

_STIFF = 0.02           # of h: a smaller slip counts as none
_LEFT = 1e-3            # share of Bullet's friction that stays where this module applies friction
_NEAR = 0.05            # m: a contact point that moved further in one step is a different one
_LEAST_MOMENT = 1e-9    # kg m^2

Contacts = List[ContactPoint]


@dataclass
class _Slippery:
    """A registered link.

    Attributes:
        slips: m/(N s), along and across `first`; both are equal without `first`.
        first: the first direction, in the principal axes; None if the slip is isotropic.
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
        """Whether it has a slip."""
        return any(self.slips)


@dataclass
class _Pair:
    """Two links in contact: the friction on the first, along and across, N; and by point."""

    force: Tuple[float, float] = (0.0, 0.0)
    points: Dict[Vec3, Vec3] = field(default_factory=dict)


def slips(link: Link) -> bool:
    """Whether the surface of a link has a slip."""
    surface = of_link(link)
    return bool(surface.slip1 or (surface.slip2 and any(surface.fdir1)))


class ForceDependentSlip:
    """Applies friction with force-dependent slip to links."""

    def __init__(self) -> None:
        self._links: Dict[LinkKey, _Slippery] = {}
        self._rows: Dict[int, List[LinkKey]] = {}
        self._axes: Dict[int, Tuple[Body, Axis]] = {}
        self._slides: Dict[LinkKey, _Slippery] = {}
        self._pairs: Dict[Tuple[LinkKey, LinkKey], _Pair] = {}
        self._wheels: Dict[int, WheelSlip] = {}

    @property
    def idle(self) -> bool:
        """True if no link has a slip."""
        return not self._slides

    def add(self, body: Body) -> None:
        """Register the links of a body, each with the surface that decides."""
        for axis in body.axes:
            self._axes[axis.row] = (body, axis)
        for uid, part in body.surfaces:
            self._add(body, (uid, part.index), part)

    def _add(self, body: Body, key: LinkKey, part: Part) -> None:
        collision = counting_collision(part.link)
        surface = Surface() if collision is None else collision.surface
        slips, first = (surface.slip1, surface.slip1), None
        if collision is not None and any(surface.fdir1):
            slips, first = (surface.slip1, surface.slip2), first_direction(collision, part)
        known = _Slippery(part, body.moves, slips, first, (
            surface.mu, surface.mu2 if directed(surface) else surface.mu))
        self._links[key] = known
        self._rows.setdefault(part.row, []).append(key)
        if known.slides:
            self._slides[key] = known

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body."""
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

    def set_wheels(self, wheels: Iterable[WheelSlip]) -> None:
        """Set slips of wheels that depend on their speed; wheels of removed links are ignored."""
        for wheel in wheels:
            if wheel.row in self._rows and wheel.joint_row in self._axes:
                self._wheels[wheel.row] = wheel
                self._slides.update({key: self._links[key] for key in self._rows[wheel.row]})

    def friction(self, uid: int, index: int, at: Vec3) -> Vec3:
        """Return the friction on a link at a contact besides Bullet's, N, world axes."""
        best, found = _NEAR, ZERO3
        for (one, _), pair in self._pairs.items():
            for point, force in pair.points.items() if one == (uid, index) else ():
                away = norm(subtract(at, point))
                if away < best:
                    best, found = away, force
        return found

    def forces_on(self, uid: int) -> Iterator[Tuple[int, Vec3, Vec3]]:
        """Yield the friction on a body in the last step: link index, force, point; world axes."""
        for (one, two), pair in self._pairs.items():
            for at, force in pair.points.items():
                if one[0] == uid:
                    yield one[1], force, at
                if two[0] == uid:
                    yield two[1], scale(force, -1.0), at

    def apply(self, dt: float) -> None:
        """Apply the friction of the next step, of `dt` s."""
        for wheel in self._wheels.values():
            self._turn(wheel)
        before, self._pairs = self._pairs, {}
        for key, link in self._slides.items():
            found: Dict[LinkKey, Contacts] = {}
            for contact in pybullet.getContactPoints(bodyA=key[0]):
                if contact[LINK] == key[1] and contact[LOAD] > 0.0 and contact[DISTANCE] <= 0.0:
                    found.setdefault((contact[OTHER_BODY], contact[OTHER_LINK]), []).append(contact)
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
        """Set the slips of a wheel from its rate."""
        body, axis = self._axes[wheel.joint_row]
        rate = pybullet.getJointState(body.uid, axis.index)[1]
        share = wheel.radius * abs(rate) / wheel.normal_force
        for key in self._rows[wheel.row]:
            self._links[key].slips = (share * wheel.lateral, share * wheel.longitudinal)

    # -- pairs -------------------------------------------------------------------------------------

    def _rub(self, key: LinkKey, other: LinkKey, contacts: Contacts, pair: _Pair,
             dt: float) -> List[bool]:
        """Compute and apply the friction of two links; return the directions that have a slip."""
        one, two = self._links[key], self._links[other]
        mine, theirs = motion(*key), motion(*other)
        carried = sum(contact[LOAD] for contact in contacts)
        normal = scale(contacts[0][NORMAL], 1.0 / norm(contacts[0][NORMAL]))
        along = _along(one, mine, normal) or _along(two, theirs, normal) or _any_across(normal)
        across = cross(normal, along)
        velocities = [subtract(mine.velocity_at(contact[PLACE]), theirs.velocity_at(contact[PLACE]))
                      for contact in contacts]
        slip = ZERO3
        for contact, velocity in zip(contacts, velocities):
            slip = add(slip, scale(velocity, contact[LOAD] / carried))
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
            share = scale(force, contact[LOAD] / carried)
            turning = subtract(velocity, slip)
            for n, axis in enumerate((along, across)):
                if slides[n]:   # slip from rotation about the centre of the contact
                    share = add(share, scale(axis, -dot(turning, axis)
                                             / (len(contacts) * (soft[n] + gain))))
            pair.points[contact[PLACE]] = share
            if one.moves:
                pybullet.applyExternalForce(*key, share, contact[PLACE], pybullet.WORLD_FRAME)
            if two.moves:
                pybullet.applyExternalForce(*other, scale(share, -1.0), contact[PLACE],
                                            pybullet.WORLD_FRAME)
        return slides


def _take(key: LinkKey, link: _Slippery, ours: Tuple[bool, bool]) -> None:
    """Reduce Bullet's friction in the directions in which this module applies friction."""
    if ours == link.ours:
        return
    link.ours = ours
    left = _LEFT if ours[0] else 1.0, _LEFT if ours[1] else 1.0
    pybullet.changeDynamics(
        *key, anisotropicFriction=anisotropy(link.mus, link.first or ZERO3, left))


def _along(link: _Slippery, state: Motion, normal: Vec3) -> Optional[Vec3]:
    """Return the first direction in the contact plane, or None."""
    if link.first is None:
        return None
    first = rotate(state.orientation, link.first)
    flat = subtract(first, scale(normal, dot(first, normal)))
    size = norm(flat)
    return scale(flat, 1.0 / size) if size > 1e-6 else None


def _any_across(normal: Vec3) -> Vec3:
    x, y, z = normal
    found = (0.0, -z, y) if abs(z) > 0.7 else (-y, x, 0.0)
    return scale(found, 1.0 / norm(found))


def _ease(link: _Slippery, state: Motion, contacts: Contacts) -> float:
    """Return an upper bound of the acceleration of a link per force at a contact, 1/kg."""
    if not link.moves or link.part.mass <= 0.0:
        return 0.0
    arm = max(norm(subtract(contact[PLACE], state.position)) for contact in contacts)
    return 1.0 / link.part.mass + arm * arm / max(_LEAST_MOMENT, min(link.part.moments))
