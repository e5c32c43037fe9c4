"""The smaller coefficient of each pair, where PyBullet's product gives something else.

PyBullet multiplies the stored coefficients of two surfaces; Gazebo takes the smaller mu (its ODE
backend, surface/friction). Surfaces with mu 1, and static ones, keep what `surfaces` stores, which
is exact for pairs among them. The others get values for what they touch just now: the logarithms x
of the stored values must satisfy x_i + x_j = log min(mu_i, mu_j) for every touching pair, which a
stack or any other tree of contacts satisfies exactly. Contacts in rings over-determine them, as two
boxes do that stand on the ground side by side; the least squares solution is then used, in which a
contact counts as much as it carries. What is off all the same is told once.

A world without such surfaces pays nothing.
"""
from __future__ import annotations

import math
from typing import Callable, Dict, FrozenSet, List, Set, Tuple

import numpy as np
import pybullet

from .bodies import Body

EVERY = 4
"""Steps between two looks at the contacts."""

_RING_EVERY = 8       # looks between two solutions of a ring
_LEAST_WEIGHT = 1e-3  # of a contact that carries nothing
_COUNTS = 0.1         # a contact that carries this share of the most is worth a warning
_TOLERATED = 0.03
_SMALLEST = 1e-6
_NO_VELOCITY = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

Node = Tuple[int, int]  # body uid, link index
Pair = FrozenSet[Node]


class FrictionBalance:
    """Keeps the stored friction of surfaces with unusual coefficients right for their contacts.

    Args:
        misfit: told, once, of a body and the share by which its friction is off.
    """

    def __init__(self, misfit: Callable[[int, float], None]) -> None:
        self._misfit = misfit
        self._told = False
        self._mu: Dict[Node, float] = {}
        self._fixed: Dict[Node, float] = {}
        self._free: Dict[Node, float] = {}
        self._rigid: Set[int] = set()
        self._pairs: Dict[Pair, float] = {}
        self._ring = 0

    def add(self, body: Body) -> None:
        """Know a new body."""
        if body.rigid:
            self._rigid.add(body.uid)
        for part in body.parts:
            for uid in body.uids:
                node = (uid, part.index)
                self._mu[node] = max(part.mu, _SMALLEST)
                if body.moves and part.mu != 1.0:
                    self._free[node] = part.friction
                else:
                    self._fixed[node] = max(part.friction, _SMALLEST)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._rigid.discard(body.uid)
        for part in body.parts:
            for uid in body.uids:
                for table in (self._mu, self._fixed, self._free):
                    table.pop((uid, part.index), None)
        self._pairs = {}

    def clear(self) -> None:
        """All bodies are gone."""
        for table in (self._mu, self._fixed, self._free):
            table.clear()
        self._rigid.clear()
        self._pairs = {}
        self._told = False

    @property
    def idle(self) -> bool:
        """True when every pair there can be is exact as stored."""
        return not self._free

    def balance(self) -> None:
        """Look at the contacts; when they are others than before, store new values.

        In rings also now and then, as what the contacts carry changes.
        """
        pairs = self._touching()
        same = pairs.keys() == self._pairs.keys()
        self._pairs = pairs
        if same:
            if not self._ring:
                return
            self._ring -= 1
            if self._ring:
                return
        nodes = sorted({node for pair in pairs for node in pair if node in self._free})
        if nodes:
            self._solve(nodes, sorted(pairs, key=sorted))

    def _solve(self, nodes: List[Node], pairs: List[Pair]) -> None:
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
        self._ring = _RING_EVERY if float(off.max()) > 1e-6 else 0
        self._tell(pairs, off * (weights > _COUNTS))
        for node, value in zip(nodes, np.exp(solution).tolist()):
            if abs(value - self._free[node]) > 1e-9:
                self._free[node] = value
                pybullet.changeDynamics(*node, lateralFriction=value)

    def _tell(self, pairs: List[Pair], off: np.ndarray) -> None:
        worst = int(off.argmax())
        if off[worst] > _TOLERATED and not self._told:
            self._told = True
            node = next(node for node in sorted(pairs[worst]) if node in self._free)
            self._misfit(node[0], float(off[worst]))

    def _touching(self) -> Dict[Pair, float]:
        """The pairs that touch, and the normal forces they carry, N."""
        found: Dict[Pair, float] = {}
        seen: Set[int] = set()
        resting: Set[int] = set()
        for uid in sorted({node[0] for node in self._free}):
            if uid in self._rigid and pybullet.getBaseVelocity(uid) == _NO_VELOCITY:
                resting.add(uid)
                continue
            for contact in pybullet.getContactPoints(bodyA=uid):
                if contact[1] in seen or contact[2] in seen:
                    continue  # it was counted from the other side
                pair = frozenset(((contact[1], contact[3]), (contact[2], contact[4])))
                if len(pair) == 2 and all(node in self._mu for node in pair) and any(
                        node in self._free for node in pair):
                    found[pair] = found.get(pair, 0.0) + contact[9]
            seen.add(uid)
        for pair, force in self._pairs.items():
            if any(node[0] in resting for node in pair):
                found.setdefault(pair, force)
        return found
