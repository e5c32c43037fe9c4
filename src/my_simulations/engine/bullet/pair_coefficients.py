"""Apply the smaller friction and restitution of each pair, although PyBullet multiplies them.

PyBullet multiplies the stored coefficients of two surfaces; Gazebo takes the smaller one (its ODE
backend, ODEPhysics::Collide). So the logarithms x of the stored values must satisfy
x_i + x_j = log min(c_i, c_j) for each pair. Where that has no solution, the weighted least squares
solution is used, and the largest remaining error is reported once.
"""
from __future__ import annotations

import itertools
import math
from typing import Any, Callable, Dict, FrozenSet, List, Mapping, NamedTuple, Sequence, Set, Tuple

import numpy as np
import pybullet

from ...geometry import STILL, Vec3
from . import surface_coefficients
from .agenda import Agenda
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import LINK, LOAD, OTHER_BODY, OTHER_LINK, LinkKey
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import WorldParameters

Misfit = Callable[[int, str, float], None]
"""Called with a body, a text for users, and the relative error of its coefficient."""

_Pair = FrozenSet[LinkKey]

EVERY = 4
"""Steps between two checks of the contacts."""

_LONGEST_WAIT = 4           # checks until a surface with unchanged contacts is read again, at most
_WAIT_AT_REST = 16          # the same for a body at rest
_RING_EVERY = 8             # checks between two solutions of a ring
_LEAST_WEIGHT = 1e-3        # of a contact without load
_WARNING_LOAD = 0.1         # share of the largest load: contacts below it cause no warning
_FRICTION_TOLERANCE = 0.03  # tolerated relative error
_LEAST_COEFFICIENT = 1e-6   # the logarithm of 0 is not finite
_NO_PAIRS: FrozenSet[_Pair] = frozenset()

_MOVING_PAIR_WEIGHT = 0.05  # weight of a pair of moving surfaces; of one with a static surface: 1
_MOST_KINDS = 60  # with more, pairs of moving surfaces are ignored
_RESTITUTION_TOLERANCE = 0.05  # tolerated relative error


def _fit_coefficients(pairs: Sequence[Any], smaller: Sequence[float], fixed: Mapping[Any, float],
            weights: np.ndarray) -> Tuple[Dict[Any, float], np.ndarray]:
    """Return the values to store, and the relative error of each pair.

    Args:
        pairs: two surfaces each.
        smaller: the smaller coefficient of each pair.
        fixed: the stored values of surfaces that keep theirs.
        weights: of the pairs.
    """
    free = sorted({each for pair in pairs for each in pair if each not in fixed})
    column = {each: n for n, each in enumerate(free)}
    rows = np.zeros((len(pairs), len(free)))
    targets = np.array([math.log(value) for value in smaller])
    for n, pair in enumerate(pairs):
        for each in pair:
            if each in column:
                rows[n, column[each]] += 1.0
            else:
                targets[n] -= math.log(fixed[each])
    solution = np.linalg.lstsq(rows * weights[:, None], targets * weights, rcond=None)[0]
    return (dict(zip(free, np.exp(solution).tolist())),
            np.abs(np.expm1(rows @ solution - targets)))


class FrictionBalance(StepHelper):
    """Updates the stored friction of surfaces with mu other than 1 to match their contacts.

    Surfaces with mu 1, and static ones, keep the coefficients that `surface_coefficients` computes,
    which are exact for pairs among them. The values of the others depend on their touching pairs. A
    stack, or any other tree of contacts, has an exact solution. Rings of contacts are
    over-determined, as of two boxes that stand on the ground side by side; their pairs are weighted
    by the loads of the contacts. A world without such surfaces has no extra cost.
    """

    events = COMMANDED

    def __init__(self, misfit: Misfit) -> None:
        self._misfit = misfit
        self._mu: Dict[LinkKey, float] = {}
        self._fixed: Dict[LinkKey, float] = {}
        self._free: Dict[LinkKey, float] = {}
        self._touching: Dict[LinkKey, Set[_Pair]] = {}
        self._agenda: Agenda[LinkKey] = Agenda()
        self._wait: Dict[LinkKey, int] = {}   # checks from one reading to the next
        self._rigid: Set[int] = set()
        self.body_tables = (self._mu, self._fixed, self._free, self._touching, self._agenda,
                            self._wait, self._rigid)
        self._pairs: Dict[_Pair, float] = {}  # and their loads, N
        self._ring = FAR   # the step of the next solution of a ring

    def add(self, body: Body) -> None:
        if body.rigid:
            self._rigid.add(body.uid)
        for uid, part in body.surfaces:
            node = (uid, part.index)
            self._mu[node] = max(part.mu, _LEAST_COEFFICIENT)
            if body.moves and part.mu != 1.0:
                self._free[node] = part.friction
                self._agenda.plan(node, 0)
            else:
                self._fixed[node] = max(part.friction, _LEAST_COEFFICIENT)

    def forget(self, body: Body) -> None:
        for uid, part in body.surfaces:
            for pair in list(self._touching.get((uid, part.index), ())):
                self._remove_pair(pair)
        super().forget(body)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check the contacts of a moved or activated body soon."""
        for part in body.colliders:
            if (body.uid, part.index) in self._free:
                self._agenda.plan((body.uid, part.index), 0)

    def due(self, step: int) -> int:
        """The step of the next check in which a surface is read or a ring is solved."""
        return next_multiple(max(step, min(self._agenda.next, self._ring)), EVERY)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Check contacts periodically; if pairs have changed, store new coefficients.

        Rings are also solved periodically, because the loads of their contacts change.
        """
        if step % EVERY:
            return
        if not self._read_due(step) and step < self._ring:
            return
        self._ring = FAR
        pairs = sorted(self._pairs, key=sorted)
        if any(node in self._free for pair in pairs for node in pair):
            self._solve(pairs, step)

    def _read_due(self, step: int) -> bool:
        """Read the contacts of the surfaces that are due. Returns whether a pair has changed."""
        changed = False
        for node in self._agenda.take(step):
            if node[0] in self._rigid and pybullet.getBaseVelocity(node[0]) == STILL:
                checks = _WAIT_AT_REST
            elif self._read_surface(node):
                changed, checks = True, 1
            else:
                checks = min(2 * self._wait.get(node, 1), _LONGEST_WAIT)
            self._wait[node] = checks
            self._agenda.plan(node, step + checks * EVERY)
        return changed

    def _solve(self, pairs: List[_Pair], step: int) -> None:
        loads = np.array([self._pairs[pair] for pair in pairs])
        weights = loads / max(float(loads.max()), 1e-9) + _LEAST_WEIGHT
        values, off = _fit_coefficients(
            pairs, [min(self._mu[node] for node in pair) for pair in pairs], self._fixed, weights)
        if float(off.max()) > 1e-6:
            self._ring = step + _RING_EVERY * EVERY
        off = off * (weights > _WARNING_LOAD)
        worst = int(off.argmax())
        if off[worst] > _FRICTION_TOLERANCE:
            self._misfit(min(node for node in pairs[worst] if node in self._free)[0],
                         "touches others in a ring, for which no friction fits all pairs: it is"
                         " {:.0f} % off", float(off[worst]))
        for node, value in values.items():
            if abs(value - self._free[node]) > 1e-9:
                self._free[node] = value
                pybullet.changeDynamics(*node, lateralFriction=value)

    def _read_surface(self, node: LinkKey) -> bool:
        """Store the pairs and normal forces, N, of a surface. Returns whether pairs changed."""
        found: Dict[_Pair, float] = {}
        uid, index = node
        contacts = [(each[OTHER_BODY], each[OTHER_LINK], each[LOAD])
                    for each in pybullet.getContactPoints(bodyA=uid, linkIndexA=index)]
        if uid not in self._rigid:  # PyBullet lists a self-contact for one of the two links
            contacts += [(uid, each[LINK], each[LOAD]) for each in pybullet.getContactPoints(
                bodyA=uid, bodyB=uid, linkIndexB=index)]
        for other_uid, other_index, force in contacts:
            other = other_uid, other_index
            if other in self._mu and other != node:
                pair = frozenset((node, other))
                found[pair] = found.get(pair, 0.0) + force
        before = self._touching.get(node, _NO_PAIRS)
        changed = before != found.keys()
        for pair in before - found.keys():
            self._remove_pair(pair)
        for pair in found if changed else ():
            for one in pair:
                self._touching.setdefault(one, set()).add(pair)
        self._pairs.update(found)
        return changed

    def _remove_pair(self, pair: _Pair) -> None:
        """Remove the pair of two surfaces that no longer touch."""
        self._pairs.pop(pair, None)
        for one in pair:
            self._touching[one].discard(pair)


class _Kind(NamedTuple):
    """Surfaces with the same stored value.

    Attributes:
        never_bounces: whether the threshold prevents bounces, unless the other one allows them.
    """

    moves: bool
    restitution: float
    never_bounces: bool


class _Bouncing(NamedTuple):
    """A surface that bounces, with its threshold, m/s, and the number of its model."""

    kind: _Kind
    threshold: float
    model_id: int


class PairRestitution(StepHelper):
    """Updates the stored restitutions to match the surfaces of the world.

    PyBullet multiplies the stored restitutions when two shapes touch, so the stored values must fit
    all pairs that can ever collide. They do if all moving surfaces that bounce are equal.
    Otherwise pairs with static surfaces have a higher weight.

    A pair bounces if the threshold of one surface allows it (Gazebo takes the smaller one). So a
    surface that never bounces by itself (SDF's default threshold) bounces on one that does; if two
    of the former could collide, the moving one is stored as 0. PyBullet has one threshold for the
    world; the smallest of all is used.

    Values are computed only after a surface that bounces was added or removed.
    """

    def __init__(self, parameters: WorldParameters, misfit: Misfit) -> None:
        self._parameters, self._misfit = parameters, misfit
        self._changed = False
        self._surfaces: Dict[LinkKey, _Bouncing] = {}
        self._stored: Dict[LinkKey, float] = {}
        self.body_tables = (self._surfaces, self._stored)

    def add(self, body: Body) -> None:
        for uid, part in body.surfaces:
            surface = surface_coefficients.of_link(part.link)
            if surface.restitution > 0.0:
                self._changed = True
                never_bounces = surface.bounce_threshold >= surface_coefficients.NEVER_BOUNCES
                self._surfaces[uid, part.index] = _Bouncing(
                    _Kind(body.moves, surface.restitution, never_bounces), surface.bounce_threshold,
                    body.model_id)
                self._stored[uid, part.index] = surface_coefficients.restitution(surface)

    def forget(self, body: Body) -> None:
        count = len(self._surfaces)
        super().forget(body)
        self._changed |= len(self._surfaces) != count

    def due(self, step: int) -> int:
        """The next step after surfaces were added or removed, otherwise `FAR`."""
        return step if self._changed else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Store the restitutions for the current surfaces, if these have changed."""
        if not self._changed:
            return
        self._changed = False
        if not self._surfaces:
            return
        self._parameters.set_slowest_bounce(min(each.threshold for each in
                                                self._surfaces.values()))
        values = self._fit_kinds()
        for node, surface in self._surfaces.items():
            value = values.get(surface.kind, 0.0)
            if abs(value - self._stored[node]) > 1e-9:
                self._stored[node] = value
                pybullet.changeDynamics(*node, restitution=value)

    def _fit_kinds(self) -> Dict[_Kind, float]:
        """Return the value to store for each kind; 0 for missing kinds."""
        models: Dict[_Kind, Set[int]] = {}
        for surface in self._surfaces.values():
            models.setdefault(surface.kind, set()).add(surface.model_id)
        if all(kind.never_bounces for kind in models):
            return {}
        one_model = sum(len(found) for kind, found in models.items() if kind.never_bounces) == 1
        kinds = sorted(kind for kind in models
                       if one_model or not (kind.moves and kind.never_bounces))
        few = len(kinds) <= _MOST_KINDS
        pairs = [(one, other) for one, other in itertools.combinations_with_replacement(kinds, 2)
                 if (one.moves or other.moves) and not (one.never_bounces and other.never_bounces)
                 and (few or not (one.moves and other.moves))
                 and (one is not other or len(models[one]) > 1)]
        own = {kind: kind.restitution for kind in kinds}
        if not pairs:
            return own
        values, off = _fit_coefficients(
            pairs, [min(one.restitution, other.restitution) for one, other in pairs], {},
            np.array([_MOVING_PAIR_WEIGHT if one.moves and other.moves else 1.0
                      for one, other in pairs]))
        worst = int(off.argmax())
        if off[worst] > _RESTITUTION_TOLERANCE:
            moving = next(kind for kind in pairs[worst] if kind.moves)
            self._misfit(min(node for node, each in self._surfaces.items()
                             if each.kind == moving)[0],
                         "may bounce off another moving model {:.0f} % off the smaller restitution:"
                         " no values fit all pairs", float(off[worst]))
        return {**own, **values}
