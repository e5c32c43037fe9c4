"""Friction of sliding wheels: mu N against the slip, for any heading.

Bullet's solver for articulated bodies computes friction along the world axes. With its pyramid, the
friction on a body that slides diagonally is up to 1.41 mu N. With its cone, the mobility of the
link weights the two directions, so that a driven wheel has hardly any friction along its axle. A
skid-steered base turned at 0.68 to 1.08 rad/s or at 0.09 to 0.73 rad/s, depending on the solver's
friction model and the heading; Coulomb's law gives 0.73 rad/s.

So once a link on a joint slides on a static body, Bullet's friction is reduced to a share of 0.001
along each axis, and Coulomb friction acts as an external force at each contact. If `mu` applies
along `fdir1` and `mu2` across it, M is the tensor of both in the floor plane. At the slip v the
friction is -N M (M v) / |M v|. Of all forces within the ellipse of M, this one dissipates the most
power.

At a slip of a few centimetres per second or less, the full force would overshoot within a step; so
there it is proportional to the slip. To come to rest, a slow link gets Bullet's friction back every
64 steps, for as long as that slows it down. It keeps it once Bullet holds all such links of its
body.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, List, Optional, Set, Tuple

import pybullet

from ...description.link_surface import counting_collision
from ...description.shapes import Collision
from ...geometry import Quat, Vec3, dot, norm, rotate, scale
from .bodies import Body, Part
from .body_events import BodyEvent
from .contact_points import DISTANCE, LINK, LOAD, NORMAL, OTHER_BODY, PLACE, ContactPoint, LinkKey
from .edge_loads import Loads, axle_of, carrying, shared
from .extra_surfaces import anisotropy, first_direction
from .force_dependent_slip import slips
from .link_states import Motion, motion, motions
from .step_helper import FAR, StepHelper, next_multiple
from .surface_coefficients import directed

EVERY = 16
"""Steps between two checks for sliding links."""

_SELDOM = 4        # checks until a body with a fixed base is checked again
_SLIDES = 2e-3     # m/s of slip: links at rest stay below it
_HELD = 5e-4       # m/s of slip: a link below it is held
_SOFT = 1.5        # steps of braking: friction is reduced on a slip that would end sooner
_TRY = 64          # steps between two tests whether Bullet's friction holds a slow link
_SLOWS = 0.98      # of the slip of the step before: a test continues while the slip is below it
_LOST = 20         # steps without contact after which a link no longer slides
_NONE = (0.0, 0.0, 0.0)
_OURS = (1e-3,) * 3
_BULLETS = (1.0,) * 3

Contacts = List[ContactPoint]


@dataclass(frozen=True)
class _Directions:
    """Two coefficients of a surface.

    Attributes:
        first: the direction in which `mu` holds, of length 1, in PyBullet's frame of the link.
        mu, mu2: along it and across it.
    """

    first: Vec3
    mu: float
    mu2: float

    @property
    def shares(self) -> Vec3:
        """PyBullet's anisotropicFriction."""
        return anisotropy((self.mu, self.mu2), self.first)


@dataclass
class _Slide:
    """A link that slides.

    Attributes:
        axle: axis of a wheel (`edge_loads`), or None.
        directions: two coefficients and their direction; None for one coefficient.
        forces: friction in the next step, N, by contact point, world axes.
        loads: normal forces, N, by contact point.
        slip: mean velocity across the floor after the last step, m/s.
        trying: whether Bullet's friction acts in this step, as a test.
        held: whether Bullet's friction holds it.
        slow: whether its friction is reduced, as its slip would end within a few steps.
        apart: steps since it last touched something.
    """

    part: Part
    mass: float
    slip: Vec3
    axle: Optional[Vec3]
    directions: Optional[_Directions]
    forces: Dict[Vec3, Vec3] = field(default_factory=dict)
    loads: Dict[Vec3, float] = field(default_factory=dict)
    trying: bool = False
    held: bool = False
    slow: bool = False
    apart: int = 0


class Sliding(StepHelper):
    """Applies Coulomb friction to links of joints that slide on static bodies."""

    # A new force or motor target does not end the sliding of a wheel.
    events = frozenset({BodyEvent.ACTIVATED})

    def __init__(self) -> None:
        self._parts: Dict[int, Dict[int, Part]] = {}
        self._directions: Dict[LinkKey, _Directions] = {}
        self._mass: Dict[int, float] = {}
        self._fixed: Set[int] = set()
        self._static: Dict[int, float] = {}
        self._slides: Dict[LinkKey, _Slide] = {}
        self._wanted = True

    def configure(self, wanted: bool) -> None:
        """Enable (friction cone) or disable (friction pyramid, left to Bullet) this module."""
        self._wanted = wanted
        if not wanted:
            for key in list(self._slides):
                self._give_back(key)

    def add(self, body: Body) -> None:
        """Register a new body. Bullet's friction stays on floors with two coefficients."""
        for uid, part in body.surfaces:
            collision = counting_collision(part.link)
            if collision is not None and not slips(part.link):
                self._add(body, uid, part, collision)

    def _add(self, body: Body, uid: int, part: Part, collision: Collision) -> None:
        surface = collision.surface
        if not body.moves:
            if not directed(surface):
                self._static[uid] = part.mu
        elif part.mu > 0.0 and any(axis.index == part.index for axis in body.axes):
            self._parts.setdefault(body.uid, {})[part.index] = part
            self._mass[body.uid] = sum(each.mass for each in body.parts)
            if directed(surface):
                self._directions[body.uid, part.index] = _Directions(
                    first_direction(collision, part), surface.mu, surface.mu2)
            if body.base is None:
                self._fixed.add(body.uid)

    def leave(self, body: Body, part: Part) -> None:
        """Stop the friction of a link, for which another module is responsible."""
        if (body.uid, part.index) in self._slides:
            self._give_back((body.uid, part.index))
        self._parts.get(body.uid, {}).pop(part.index, None)

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body."""
        self._fixed.discard(body.uid)
        for uid in body.uids:
            for table in (self._static, self._parts, self._mass):
                table.pop(uid, None)
        for part in body.parts:
            self._slides.pop((body.uid, part.index), None)
            self._directions.pop((body.uid, part.index), None)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Restore Bullet's friction for the links of a body."""
        for key in [key for key in self._slides if key[0] == body.uid]:
            self._give_back(key)

    def friction(self, uid: int, index: int, at: Vec3) -> Vec3:
        """Return the friction on a link at a contact besides Bullet's, N, world axes."""
        slide = self._slides.get((uid, index))
        return _NONE if slide is None else slide.forces.get(at, _NONE)

    def load(self, uid: int, index: int, at: Vec3) -> Optional[float]:
        """Return the normal force on a sliding link at a contact, N; None for other contacts."""
        slide = self._slides.get((uid, index))
        return None if slide is None else slide.loads.get(at)

    @property
    def busy(self) -> bool:
        """True while a link slides."""
        return bool(self._slides)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Apply the friction of the next step."""
        for (uid, index), slide in self._slides.items():
            for at, force in slide.forces.items():
                pybullet.applyExternalForce(uid, index, force, at, pybullet.WORLD_FRAME)

    def due(self, step: int) -> int:
        """Each step while a link slides, otherwise the step of the next check."""
        if self._slides:
            return step
        return next_multiple(step, EVERY) if self._wanted and self._parts else FAR

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Compute friction after the step that began at count `step`; periodically find slides."""
        if step % EVERY == 0 and self._wanted:
            seldom = step % (_SELDOM * EVERY) == 0
            for uid, parts in self._parts.items():
                if seldom or uid not in self._fixed:
                    self._look(uid, parts)
        if self._slides:
            least = norm(gravity)
            found = self._loads()
            for key in list(self._slides):
                self._go_on(key, *found[key], step, dt, least)
            self._keep_alike()
            self._give_back_held()

    def _look(self, uid: int, parts: Dict[int, Part]) -> None:
        """Find the links of a body that slide."""
        found: Dict[int, Contacts] = {}
        for contact in pybullet.getContactPoints(bodyA=uid):
            if contact[LINK] in parts and contact[LOAD] > 0.0 and contact[DISTANCE] <= 0.0:
                found.setdefault(contact[LINK], []).append(contact)
        for index, contacts in found.items():
            if (uid, index) in self._slides or self._touches_moving(contacts):
                continue
            slip = _slips(motion(uid, index), *carrying(contacts))[1]
            if norm(slip) > _SLIDES:
                part = parts[index]
                self._slides[uid, index] = _Slide(part, self._mass[uid], slip,
                                                  axle_of(part, part.link),
                                                  self._directions.get((uid, index)))
                pybullet.changeDynamics(uid, index, anisotropicFriction=_OURS)

    def _touches_moving(self, contacts: Contacts) -> bool:
        return any(contact[OTHER_BODY] not in self._static for contact in contacts)

    def _loads(self) -> Dict[LinkKey, Tuple[Motion, Loads]]:
        """Return motion and loads of each sliding link; wheels of a body share their load."""
        bodies: Dict[int, List[int]] = {}
        for uid, index in self._slides:
            bodies.setdefault(uid, []).append(index)
        found: Dict[LinkKey, Tuple[Motion, Loads]] = {}
        for uid, indices in bodies.items():
            wheels: List[Tuple[Motion, Vec3, Contacts]] = []
            names: List[Tuple[LinkKey, Motion]] = []
            for index, moves in zip(indices, motions(uid, indices)):
                slide = self._slides[uid, index]
                contacts = pybullet.getContactPoints(bodyA=uid, linkIndexA=index)
                if slide.axle is None or slide.trying:
                    found[uid, index] = moves, carrying(contacts)
                else:
                    wheels.append((moves, slide.axle, contacts))
                    names.append(((uid, index), moves))
            told = shared(wheels) if len(wheels) > 1 else [carrying(each[2]) for each in wheels]
            for (key, moves), loads in zip(names, told):
                found[key] = moves, loads
        return found

    def _go_on(self, key: LinkKey, moves: Motion, carried_by: Loads, step: int, dt: float,
               gravity: float) -> None:
        """Compute the friction of the next step, or restore Bullet's friction."""
        slide = self._slides[key]
        contacts, loads = carried_by
        slide.forces = {}
        slide.loads = {contact[PLACE]: load for contact, load in zip(contacts, loads)}
        slide.apart = 0 if contacts else slide.apart + 1
        if slide.apart > _LOST or self._touches_moving(contacts):
            self._give_back(key)
        if not contacts or key not in self._slides:
            return
        slips, slip = _slips(moves, contacts, loads)
        before = slide.slip
        slide.slip = slip
        if slide.trying:
            slide.held = norm(slip) < _HELD
            if slide.held:
                return
            if norm(slip) < _SLOWS * norm(before):
                return
            self._try(key, slide, False)
        soft = _SOFT * dt * max(gravity, sum(loads) / slide.mass)
        slow = False
        for contact, load, velocity in zip(contacts, loads, slips):
            most = self._static[contact[OTHER_BODY]]
            if slide.directions is None:
                mu = min(slide.part.mu, most)
                speed, along = norm(velocity), velocity
            else:
                mu, speed, along = _weighed(velocity, slide.directions, moves.orientation,
                                            contact[NORMAL], most)
            slow = slow or speed < soft * mu
            if speed > 0.0:
                slide.forces[contact[PLACE]] = scale(along, -mu * load / max(speed, soft * mu))
        # A slip that has grown is the effect of a command.
        turned = dot(slip, before) < 0.0 and norm(slip) < norm(before) + _HELD
        slide.slow = slow
        if turned or (slow and step % _TRY == 0):
            self._try(key, slide, True)

    def _keep_alike(self) -> None:
        """End the test of Bullet's friction on links while other links of their body slide slowly.

        Bullet's friction holds at once, the friction of a slow link grows with the slip: a base of
        which Bullet held two wheels did not turn.
        """
        slow = {uid for (uid, _), slide in self._slides.items() if slide.slow and not slide.trying}
        if slow:
            for key, slide in self._slides.items():
                if slide.trying and key[0] in slow:
                    self._try(key, slide, False)

    def _give_back_held(self) -> None:
        """Restore Bullet's friction for the links of a body together, once it holds all of them.

        Bullet stops a slip sooner: a base with different friction on its wheels would turn.
        """
        sliding = {uid for (uid, _), slide in self._slides.items() if not slide.held}
        for key in [key for key in self._slides if key[0] not in sliding]:
            self._give_back(key)

    @staticmethod
    def _try(key: LinkKey, slide: _Slide, trying: bool) -> None:
        """Use Bullet's friction from the next step on, or that of this module again."""
        slide.trying, slide.held = trying, False
        if trying:
            slide.forces = {}
        pybullet.changeDynamics(*key, anisotropicFriction=_bullets(slide) if trying else _OURS)

    def _give_back(self, key: LinkKey) -> None:
        pybullet.changeDynamics(*key, anisotropicFriction=_bullets(self._slides.pop(key)))


def _bullets(slide: _Slide) -> Vec3:
    """Return PyBullet's anisotropicFriction of a link that does not slide."""
    return _BULLETS if slide.directions is None else slide.directions.shares


def _weighed(slip: Vec3, directions: _Directions, turn: Quat, normal: Vec3,
             most: float) -> Tuple[float, float, Vec3]:
    """Return a coefficient mu, a speed and a velocity; friction is -mu N velocity / speed.

    Velocity and speed have the size of |M (M v)| / mu, in m/s; with one coefficient this is the
    slip. `turn`: orientation of PyBullet's frame; `most`: the floor's coefficient.
    """
    first = rotate(turn, directions.first)
    mu, mu2 = min(directions.mu, most), min(directions.mu2, most)

    def coefficients_times(vector: Vec3) -> Vec3:
        along = (mu - mu2) * dot(first, vector)
        x, y, z = (mu2 * v + along * d for v, d in zip(vector, first))
        away = x * normal[0] + y * normal[1] + z * normal[2]
        return x - away * normal[0], y - away * normal[1], z - away * normal[2]

    once = coefficients_times(slip)
    twice = coefficients_times(once)
    size, force = norm(once), norm(twice)
    if force <= 0.0:
        return most, 0.0, slip
    against = force / size
    return against, size / against, scale(twice, size / (against * force))


def _slips(moves: Motion, contacts: Contacts, loads: List[float]) -> Tuple[List[Vec3], Vec3]:
    """Return the velocity of a link along the floor at each contact, and their mean, m/s.

    The mean is weighted by load: a wheel of a robot in a curve rolls on its loaded edge, while the
    other edge slips.
    """
    centre, _, (u, v, w), (p, q, r) = moves
    found: List[Vec3] = []
    mean_x = mean_y = mean_z = carried = 0.0
    for contact, load in zip(contacts, loads):
        (x, y, z), (a, b, c) = contact[PLACE], contact[NORMAL]
        x, y, z = x - centre[0], y - centre[1], z - centre[2]
        sx, sy, sz = u + q * z - r * y, v + r * x - p * z, w + p * y - q * x
        away = sx * a + sy * b + sz * c
        sx, sy, sz = sx - away * a, sy - away * b, sz - away * c
        found.append((sx, sy, sz))
        mean_x, mean_y, mean_z = mean_x + load * sx, mean_y + load * sy, mean_z + load * sz
        carried += load
    return found, (mean_x / carried, mean_y / carried, mean_z / carried)
