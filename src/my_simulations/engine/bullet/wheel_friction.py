"""Apply Coulomb's law to sliding wheels and to surfaces with slip, for any heading.

Bullet's friction of articulated bodies depends on the heading, and has no slip that depends on the
force (slip1, slip2; ODE's manual, "Contact"), of which Gazebo Classic 11 applies the sum of both
surfaces to a pair. So Bullet's friction is reduced to a share of 0.001 for links with slip, and for
links on joints while they slide on static bodies (figures: doc/dev/contacts.md, "Friction"). A
force at each contact replaces it, by the law of `link_friction`. It is computed before a step from
the contacts of the last one.

While all links of a body without slip are held, or slide with all friction, it is computed every
few steps only. Once all links of a body that have no slip have stopped sliding, they get Bullet's
friction back.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Callable, Dict, Iterable, Iterator, List, NamedTuple, Set, Tuple

import pybullet

from ...geometry import ZERO3, Vec3, norm, scale
from ..body_plan import BASE
from ..drive_commands import WheelSlip
from .bodies import Axis, Body
from .body_events import BodyEvent
from .contact_points import (
    DISTANCE,
    LINK,
    OTHER_BODY,
    OTHER_LINK,
    POINT,
    ContactPoint,
    LinkKey,
)
from .contact_slip import mean_velocity
from .edge_loads import NEAR, loaded_contacts
from .extra_surfaces import anisotropy
from .link_friction import Drive, link_friction
from .link_loads import Reading, read_loads, with_other
from .link_states import Motion, child_states, motion
from .step_helper import FAR, StepHelper, next_multiple
from .surface_links import ContactMobility, SurfaceLink, contact_mobility, surface_links
from .wheel_edges import wheel_edges

EVERY = 16
"""Steps between two checks for sliding links."""

_SELDOM = 4                # checks until a body with a fixed base is checked again
_SLIDES = 2e-3             # m/s of slip: links at rest stay below it
_RESTS = 5e-4              # m/s of slip: a link below it is at rest
_LASTING = 0.02            # of the load: with more lasting friction (B), Bullet's is not restored
_REST_STEPS = 32           # steps at rest until Bullet's friction is restored
_GRIP_SHARE = 0.4          # of mu g: a wheel that accelerates less does not slide
_IMPACT_SHARE = 0.1        # of the load: a larger change is an impact
_PERIOD = 4e-3  # s between two computations of the friction on a link that goes on sliding
_REMAINING = (1e-3, 1e-3)  # shares of Bullet's friction that stay

Contacts = List[ContactPoint]


class ActingFriction(NamedTuple):
    """The friction on a link at a contact in the last step, N, world axes.

    Attributes:
        at: the contact, m.
        load: the normal force, N.
        other: the link that it touches.
    """

    at: Vec3
    force: Vec3
    load: float
    other: LinkKey


@dataclass
class _Slide:
    """The friction of this module on a link.

    Attributes:
        biases: B of `link_friction` by the other link, N, world axes.
        acting: fields of `ActingFriction`, by contact.
        rest_steps: steps for which it has not slid.
        load: N, at its last computation.
        steady: whether its friction needs no update for some steps.
    """

    biases: Dict[LinkKey, Vec3] = field(default_factory=dict)
    acting: List[Tuple[Vec3, Vec3, float, LinkKey]] = field(default_factory=list)
    rest_steps: int = 0
    load: float = 0.0
    steady: bool = False


class WheelFriction(StepHelper):
    """Applies Coulomb friction to links that slide on joints, and to links with slip.

    Args:
        holding: returns the effort, N m, with which the motor or brake of a joint row acts.
        rate: returns the rate, rad/s, to which it drives the joint.
        effort: returns the effort, N m, of loops, dampers and commands on a joint row in the step
            that begins at a count.
    """

    # A new force or motor target does not end the sliding of a wheel.
    events = frozenset({BodyEvent.ACTIVATED, BodyEvent.MOTOR_TARGET_CHANGED})

    def __init__(self, holding: Callable[[int], float], rate: Callable[[int], float],
                 effort: Callable[[int, int], float]) -> None:
        self._holding, self._rate, self._effort = holding, rate, effort
        self._commanded: Set[int] = set()
        self._links: Dict[LinkKey, SurfaceLink] = {}
        self._wheels: Dict[int, Dict[int, SurfaceLink]] = {}   # links that can slide, by body
        self._jointless: Dict[int, Dict[int, SurfaceLink]] = {}   # links on no joint, by body
        self._floors: Set[int] = set()                   # static bodies with one coefficient
        self._slides: Dict[LinkKey, _Slide] = {}
        self._next: Dict[int, int] = {}                  # next computation, step count, by body
        self._slipping: Set[LinkKey] = set()
        self._fixed: Set[int] = set()                    # bodies with a fixed base
        self._readings: Dict[LinkKey, Reading] = {}   # for the next step
        self._mobilities: Dict[LinkKey, ContactMobility] = {}
        self._rows: Dict[int, List[LinkKey]] = {}
        self._axes: Dict[int, Tuple[Body, Axis]] = {}
        self._slip_commands: Dict[int, WheelSlip] = {}
        self.body_tables = (self._links, self._wheels, self._jointless, self._floors, self._slides,
                            self._next, self._slipping, self._fixed, self._commanded,
                            self._readings, self._mobilities)
        self._cone = True

    # -- bodies ------------------------------------------------------------------------------------

    def configure(self, cone: bool) -> None:
        """Replace Bullet's friction on sliding links (friction cone), or keep it (pyramid)."""
        self._cone = cone
        if not cone:
            for key in self._slides.keys() - self._slipping:
                self._restore_friction(key)

    def add(self, body: Body) -> None:
        self._axes.update((axis.row, (body, axis)) for axis in body.axes)
        if body.base is None:
            self._fixed.add(body.uid)
        for key, link in surface_links(body).items():
            self._links[key] = link
            self._rows.setdefault(link.part.row, []).append(key)
            if any(link.slips):
                self._add_slipping(key)
            elif link.is_floor:
                self._floors.add(key[0])
            elif body.moves and not body.rigid and link.part.mu > 0.0:
                table = self._wheels if link.joint >= 0 else self._jointless
                table.setdefault(body.uid, {})[key[1]] = link

    def forget(self, body: Body) -> None:
        super().forget(body)
        for axis in body.axes:
            self._axes.pop(axis.row, None)
        for part in body.colliders:
            self._rows.pop(part.row, None)
            self._slip_commands.pop(part.row, None)

    def set_slips(self, wheels: Iterable[WheelSlip]) -> None:
        """Set slips of wheels that depend on their speed; wheels of removed links are ignored."""
        for wheel in wheels:
            if wheel.row in self._rows and wheel.joint_row in self._axes:
                self._slip_commands[wheel.row] = wheel
                for key in self._rows[wheel.row]:
                    self._add_slipping(key)
                    self._wheels.get(key[0], {}).pop(key[1], None)

    def _add_slipping(self, key: LinkKey) -> None:
        self._slipping.add(key)
        self._replace_friction(key)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Restore Bullet's friction for the links of a body, except those with slip."""
        self._next.pop(body.uid, None)
        if event is BodyEvent.MOTOR_TARGET_CHANGED:
            if self._cone and body.uid in self._wheels:
                self._commanded.add(body.uid)
            for key, slide in self._slides.items():
                if key[0] == body.uid:
                    slide.steady = False
            return
        for key in [key for key in self._slides if key[0] == body.uid]:
            if key in self._slipping:
                self._readings.pop(key, None)
                self._slides[key] = _Slide()
            else:
                self._restore_friction(key)

    # -- readings ----------------------------------------------------------------------------------

    def acting(self) -> Iterator[Tuple[LinkKey, ActingFriction]]:
        """Yield each link with friction besides Bullet's in the last step, and that friction.

        Links have moved on if it was computed some steps ago.
        """
        for key, slide in self._slides.items():
            for each in slide.acting:
                yield key, ActingFriction(*each)

    def forces_on(self, uid: int) -> Iterator[Tuple[int, Vec3, Vec3]]:
        """Yield the friction on a body in the last step: link index, force, point; world axes."""
        for key, slide in self._slides.items():
            for at, force, _, other in slide.acting:
                if key[0] == uid:
                    yield key[1], force, at
                if other[0] == uid:
                    yield other[1], scale(force, -1.0), at

    # -- steps -------------------------------------------------------------------------------------

    def due(self, step: int) -> int:
        """Each step while a link slides or has slip, otherwise the step of the next check."""
        if self._slides or self._commanded:
            return step
        return next_multiple(step, EVERY) if self._cone and self._wheels else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compute the friction that is due, and apply all friction of this module."""
        for uid in sorted(self._commanded):
            self._replace_if_driven(uid, norm(gravity) * dt)
        self._commanded.clear()
        self._compute(step, dt, gravity)
        # Bullet computes the lever of a force from the link poses of the last forward kinematics.
        # Other readers request these at any time, so they are requested here in each step.
        for uid, index in {uid: index for uid, index in self._slides if index != BASE}.items():
            child_states(uid, (index,), 0)
        for key, slide in self._slides.items():
            slips = key in self._slipping
            for at, force, _, other in slide.acting:
                pybullet.applyExternalForce(*key, force, at, pybullet.WORLD_FRAME)
                if slips and other in self._links and self._links[other].body.moves:
                    pybullet.applyExternalForce(*other, scale(force, -1.0), at,
                                                pybullet.WORLD_FRAME)

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Find links that slide, periodically; read the loads for friction that is due next."""
        if step % EVERY == 0 and self._cone:
            seldom = step % (_SELDOM * EVERY) == 0
            for uid, wheels in self._wheels.items():
                if seldom or uid not in self._fixed:
                    self._find_slides(uid, wheels)
        due = {uid for uid, _ in self._slides if self._next.get(uid, step + 1) <= step + 1}
        for uid in sorted(due):
            links = {key[1]: self._links[key] for key in self._slides if key[0] == uid}
            self._readings.update(((uid, index), reading) for index, reading in read_loads(
                uid, links, self._slipping).items())

    def _compute(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compute the friction that is due, for the efforts of the step that begins at `step`."""
        if not self._readings:
            return
        for wheel in self._slip_commands.values():
            self._set_slip(wheel)
        weight, later = norm(gravity), next_multiple(step + 1, max(1, int(_PERIOD / dt)))
        unsteady: Set[int] = set()
        for key, (_, (_, loads)) in self._readings.items():
            slide, load = self._slides[key], sum(loads)
            if not slide.steady or abs(load - slide.load) > _IMPACT_SHARE * slide.load:
                unsteady.add(key[0])
            slide.load = load
        for uid in {uid for uid, _ in self._readings}:
            self._next[uid] = step + 1 if uid in unsteady else later
        for key, (moves, (contacts, loads)) in list(self._readings.items()):
            self._update_friction(key, moves, contacts, loads, step, dt, weight)
        self._readings.clear()
        self._restore_at_rest()

    def _find_slides(self, uid: int, links: Dict[int, SurfaceLink]) -> None:
        """Replace Bullet's friction on the links of a body that slide on static bodies.

        If a wheel slides, on all wheels: a base with different friction on its wheels would turn.
        """
        found: Dict[int, Contacts] = {}
        for contact in pybullet.getContactPoints(bodyA=uid):
            if contact[LINK] in links and contact[DISTANCE] < NEAR and (
                    (uid, contact[LINK]) not in self._slides):
                found.setdefault(contact[LINK], []).append(contact)
        slides: Set[int] = set()
        for index, near in found.items():
            contacts, loads = loaded_contacts(near)
            if contacts and not self._touches_others(contacts):
                moves = motion(uid, index)
                edges = wheel_edges(links[index].axle, moves, near)
                if _SLIDES < max(norm(mean_velocity(moves, contacts, loads)),
                                 0.0 if edges is None else edges.slip):
                    slides.add(index)
        if any(links[index].axle is not None for index in slides):
            slides.update(index for index in found if links[index].axle is not None)
        for index in sorted(slides):
            self._replace_friction((uid, index))

    def _replace_if_driven(self, uid: int, gain: float) -> None:
        """Replace Bullet's friction on wheels if one cannot follow its motor without sliding.

        No link of a fixed arm is a wheel while its joints move nothing that touches something.
        `gain`: speed that gravity gives in a step, m/s.
        """
        wheels = self._wheels[uid]
        if uid in self._fixed and not any(
                contact[LINK] in wheels for contact in pybullet.getContactPoints(bodyA=uid)):
            return
        if any(link.axle is not None and abs(
                self._rate(link.joint) - pybullet.getJointState(uid, index)[1]) * link.radius
                > _GRIP_SHARE * min(1.0, link.mus[0]) * gain for index, link in wheels.items()):
            for index in (*wheels, *self._jointless.get(uid, ())):
                if (uid, index) not in self._slides:
                    self._replace_friction((uid, index))

    def _touches_others(self, contacts: Contacts) -> bool:
        return not self._floors.issuperset([contact[OTHER_BODY] for contact in contacts])

    def _update_friction(self, key: LinkKey, moves: Motion, contacts: Contacts, loads: List[float],
                         step: int, dt: float, weight: float) -> None:
        """Compute the friction on a link from count `step` to its next computation."""
        slide, slips, steps = self._slides[key], key in self._slipping, self._next[key[0]] - step
        link = self._links[key]
        slide.rest_steps += steps
        biases, slide.biases, slide.acting = slide.biases, {}, []
        if not contacts:   # a wheel can land in the next step; rollers of Mecanum wheels do
            slide.steady = not slips and link.joint < 0
            return
        if not slips and self._touches_others(contacts):
            self._restore_friction(key)
            return
        effort = self._effort(link.joint, step)
        slide.steady = not slips and not effort   # a loop can change it in each step
        others = {(contact[OTHER_BODY], contact[OTHER_LINK]): None for contact in contacts}
        for other in others:
            if other not in self._links or slips and other in self._slipping and other < key:
                continue
            points, carried = contacts, loads
            if len(others) > 1:
                points, carried = with_other(other, contacts, loads)
            under = self._links[other]
            mobility = None if link.body.rigid or under.body.moves else (
                self._mobility(link, points[0], min(link.mus) * weight))
            forces, bias, slip, ended = link_friction(
                link, under, moves, (points, carried), biases.get(other, ZERO3),
                Drive(effort, self._holding(link.joint), mobility), steps * dt, weight)
            slide.biases[other] = bias
            if link.joint >= 0 and (slip > _RESTS or norm(bias) > _LASTING * sum(carried)):
                slide.rest_steps = 0
            slide.steady &= slip <= _RESTS or slip > ended * _PERIOD / (steps * dt)
            slide.acting += [(contact[POINT], force, load, other)
                             for contact, force, load in zip(points, forces, carried)]

    def _mobility(self, link: SurfaceLink, contact: ContactPoint, share: float) -> ContactMobility:
        """Return the mobility of a body at a contact; computed once while the link slides.

        `share`: the largest friction at the contact per mass of the body, N/kg.
        """
        key = link.uid, link.part.index
        found = self._mobilities.get(key)
        if found is None:
            found = contact_mobility(
                link, contact,
                lambda row, lever: self._holding(row) >= share * link.total * lever)
            # Equal wheels of a body meet equal friction.
            rigid = next((each.rigid for (uid, _), each in self._mobilities.items()
                          if uid == link.uid), found.rigid)
            self._mobilities[key] = found = found._replace(rigid=rigid)
        return found

    # -- Bullet's friction -------------------------------------------------------------------------

    def _replace_friction(self, key: LinkKey) -> None:
        """Replace Bullet's friction on a link from the next step on."""
        link = self._links[key]
        if not any(uid == key[0] for uid, _ in self._slides):
            for other in [other for other in self._mobilities if other[0] == key[0]]:
                del self._mobilities[other]   # its joints may have moved
        self._slides.setdefault(key, _Slide())
        self._next.pop(key[0], None)
        pybullet.changeDynamics(*key, anisotropicFriction=anisotropy(
            link.mus, link.first or ZERO3, _REMAINING))

    def _restore_friction(self, key: LinkKey) -> None:
        link = self._links[key]
        del self._slides[key]
        self._readings.pop(key, None)
        pybullet.changeDynamics(*key, anisotropicFriction=anisotropy(link.mus, link.first or ZERO3))

    def _restore_at_rest(self) -> None:
        """Restore Bullet's friction for the links of a body together, once all are at rest.

        Bullet stops a slip sooner: a base with different friction on its wheels would turn.
        """
        slides = {uid for (uid, _), slide in self._slides.items() if slide.rest_steps < _REST_STEPS}
        for key in [key for key in self._slides if key[0] not in slides]:
            if key not in self._slipping:
                self._restore_friction(key)

    def _set_slip(self, wheel: WheelSlip) -> None:
        body, axis = self._axes[wheel.joint_row]
        rate = pybullet.getJointState(body.uid, axis.index)[1]
        share = wheel.radius * abs(rate) / wheel.normal_force
        for key in self._rows[wheel.row]:
            self._links[key].slips = (share * wheel.lateral, share * wheel.longitudinal)
