"""Apply the smaller friction coefficient of each pair, although PyBullet multiplies them.

PyBullet multiplies the stored coefficients of two surfaces; Gazebo takes the smaller mu (its ODE
backend, surface/friction). Surfaces with mu 1, and static ones, keep the coefficients that
`surface_coefficients` computes, which are exact for pairs among them. The values of the others
depend on their current contacts: the logarithms x of the stored values must satisfy
x_i + x_j = log min(mu_i, mu_j) for every touching pair. A stack, or any other tree of contacts, has
an exact solution. Rings of contacts are over-determined, as of two boxes that stand on the ground
side by side. Then the least squares solution is used, weighted by the loads of the contacts. The
largest remaining error is reported once.

A world without such surfaces has no extra cost.
"""
from __future__ import annotations

import math
from typing import Callable, Dict, FrozenSet, List, Set

import numpy as np
import pybullet

from ...geometry import Vec3
from .agenda import Agenda
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .contact_points import LINK, LOAD, OTHER_BODY, OTHER_LINK, LinkKey
from .step_helper import FAR, StepHelper, next_multiple

Pair = FrozenSet[LinkKey]

EVERY = 4
"""Steps between two checks of the contacts."""

_MOST_LOOKS = 4       # checks, at most, until the next turn of a surface with unchanged contacts
_AT_REST = 16         # the same for a body at rest
_RING_EVERY = 8       # checks between two solutions of a ring
_LEAST_WEIGHT = 1e-3  # of a contact without load
_COUNTS = 0.1         # share of the largest load: contacts below it cause no warning
_TOLERATED = 0.03
_SMALLEST = 1e-6
_NOTHING: FrozenSet[Pair] = frozenset()
_NO_VELOCITY = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class FrictionBalance(StepHelper):
    """Updates the stored friction of surfaces with mu other than 1 to match their contacts.

    Args:
        misfit: called once, with a body and the relative error of its friction.
    """

    events = COMMANDED

    def __init__(self, misfit: Callable[[int, float], None]) -> None:
        self._misfit = misfit
        self._is_reported = False
        self._mu: Dict[LinkKey, float] = {}
        self._fixed: Dict[LinkKey, float] = {}
        self._free: Dict[LinkKey, float] = {}
        self._touching: Dict[LinkKey, Set[Pair]] = {}
        self._agenda: Agenda[LinkKey] = Agenda()
        self._wait: Dict[LinkKey, int] = {}   # checks between two turns
        self._rigid: Set[int] = set()
        self.body_tables = (self._mu, self._fixed, self._free, self._touching, self._agenda,
                            self._wait, self._rigid)
        self._pairs: Dict[Pair, float] = {}
        self._ring = FAR   # the step of the next solution of a ring

    def add(self, body: Body) -> None:
        if body.rigid:
            self._rigid.add(body.uid)
        for uid, part in body.surfaces:
            node = (uid, part.index)
            self._mu[node] = max(part.mu, _SMALLEST)
            if body.moves and part.mu != 1.0:
                self._free[node] = part.friction
                self._agenda.plan(node, 0)
            else:
                self._fixed[node] = max(part.friction, _SMALLEST)

    def forget(self, body: Body) -> None:
        for uid, part in body.surfaces:
            for pair in list(self._touching.get((uid, part.index), ())):
                self._part(pair)
        super().forget(body)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Check the contacts of a moved or activated body soon."""
        for part in body.colliders:
            if (body.uid, part.index) in self._free:
                self._agenda.plan((body.uid, part.index), 0)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Check contacts periodically; if pairs have changed, store new coefficients.

        Rings are also solved periodically, because the loads of their contacts change.
        """
        if step % EVERY:
            return
        if not self._read_due(step) and step < self._ring:
            return
        self._ring = FAR
        nodes = sorted({node for pair in self._pairs for node in pair if node in self._free})
        if nodes:
            self._solve(nodes, sorted(self._pairs, key=sorted), step)

    def due(self, step: int) -> int:
        """The step of the next check at which a surface is due."""
        return next_multiple(max(step, min(self._agenda.next, self._ring)), EVERY)

    def _read_due(self, step: int) -> bool:
        """Read the contacts of the surfaces that are due. Returns whether a pair has changed."""
        changed = False
        for node in self._agenda.take(step):
            if node[0] in self._rigid and pybullet.getBaseVelocity(node[0]) == _NO_VELOCITY:
                looks = _AT_REST
            elif self._read_surface(node):
                changed, looks = True, 1
            else:
                looks = min(2 * self._wait.get(node, 1), _MOST_LOOKS)
            self._wait[node] = looks
            self._agenda.plan(node, step + looks * EVERY)
        return changed

    def _solve(self, nodes: List[LinkKey], pairs: List[Pair], step: int) -> None:
        column = {node: n for n, node in enumerate(nodes)}
        rows, targets = np.zeros((len(pairs), len(nodes))), np.zeros(len(pairs))
        for n, pair in enumerate(pairs):
            targets[n] = math.log(min(self._mu[node] for node in pair))
            for node in pair:
                if node in column:
                    rows[n, column[node]] += 1.0
                else:
                    targets[n] -= math.log(self._fixed[node])
        carried = np.array([self._pairs[pair] for pair in pairs])
        weights = carried / max(float(carried.max()), 1e-9) + _LEAST_WEIGHT
        solution = np.linalg.lstsq(rows * weights[:, None], targets * weights, rcond=None)[0]
        off = np.abs(np.expm1(rows @ solution - targets))
        if float(off.max()) > 1e-6:
            self._ring = step + _RING_EVERY * EVERY
        self._report_misfit(pairs, off * (weights > _COUNTS))
        for node, value in zip(nodes, np.exp(solution).tolist()):
            if abs(value - self._free[node]) > 1e-9:
                self._free[node] = value
                pybullet.changeDynamics(*node, lateralFriction=value)

    def _report_misfit(self, pairs: List[Pair], off: np.ndarray) -> None:
        worst = int(off.argmax())
        if off[worst] > _TOLERATED and not self._is_reported:
            self._is_reported = True
            node = next(node for node in sorted(pairs[worst]) if node in self._free)
            self._misfit(node[0], float(off[worst]))

    def _read_surface(self, node: LinkKey) -> bool:
        """Store the pairs and normal forces, N, of a surface. Returns whether pairs changed."""
        found: Dict[Pair, float] = {}
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
        before = self._touching.get(node, _NOTHING)
        changed = before != found.keys()
        if changed:
            for pair in before - found.keys():
                self._part(pair)
            for pair in found:
                for one in pair:
                    self._touching.setdefault(one, set()).add(pair)
        self._pairs.update(found)
        return changed

    def _part(self, pair: Pair) -> None:
        """Remove the pair of two surfaces that no longer touch."""
        self._pairs.pop(pair, None)
        for one in pair:
            self._touching[one].discard(pair)
