"""The smaller coefficient of each pair, where PyBullet's product gives something else.

PyBullet multiplies the stored coefficients of two surfaces; Gazebo takes the smaller mu (its ODE
backend, surface/friction). Surfaces with mu 1, and static ones, keep what `surfaces` stores, which
is exact for pairs among them. The others get values for what they touch just now: the logarithms x
of the stored values must satisfy x_i + x_j = log min(mu_i, mu_j) for every touching pair, which a
stack or any other tree of contacts satisfies exactly. Contacts in rings over-determine them; the
least squares solution is then used.

A world without such surfaces pays nothing.
"""
from __future__ import annotations

import math
from typing import Dict, FrozenSet, Set, Tuple

import numpy as np
import pybullet

from .bodies import Body

EVERY = 4
"""Steps between two looks at the contacts."""

_SMALLEST = 1e-6
_NO_VELOCITY = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

Node = Tuple[int, int]  # body uid, link index
Pair = FrozenSet[Node]


class FrictionBalance:
    """Keeps the stored friction of surfaces with unusual coefficients right for their contacts."""

    def __init__(self) -> None:
        self._mu: Dict[Node, float] = {}
        self._fixed: Dict[Node, float] = {}
        self._free: Dict[Node, float] = {}
        self._pairs: Set[Pair] = set()

    def add(self, body: Body) -> None:
        """Know a new body."""
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
        for part in body.parts:
            for uid in body.uids:
                for table in (self._mu, self._fixed, self._free):
                    table.pop((uid, part.index), None)
        self._pairs = set()

    def clear(self) -> None:
        """All bodies are gone."""
        for table in (self._mu, self._fixed, self._free):
            table.clear()
        self._pairs = set()

    @property
    def idle(self) -> bool:
        """True when every pair there can be is exact as stored."""
        return not self._free

    def balance(self) -> None:
        """Look at the contacts; when they are others than before, store new values."""
        pairs = self._touching()
        if pairs == self._pairs:
            return
        self._pairs = pairs
        nodes = sorted({node for pair in pairs for node in pair if node in self._free})
        if not nodes:
            return
        column = {node: n for n, node in enumerate(nodes)}
        rows, targets = [], []
        for pair in sorted(pairs, key=sorted):
            row, target = np.zeros(len(nodes)), math.log(min(self._mu[node] for node in pair))
            for node in pair:
                if node in column:
                    row[column[node]] += 1.0
                else:
                    target -= math.log(self._fixed[node])
            rows.append(row)
            targets.append(target)
        solution = np.linalg.lstsq(np.array(rows), np.array(targets), rcond=None)[0]
        for node, value in zip(nodes, np.exp(solution).tolist()):
            if abs(value - self._free[node]) > 1e-9:
                self._free[node] = value
                pybullet.changeDynamics(*node, lateralFriction=value)

    def _touching(self) -> Set[Pair]:
        found: Set[Pair] = set()
        for uid in {node[0] for node in self._free}:
            if pybullet.getBaseVelocity(uid) == _NO_VELOCITY:
                found.update(pair for pair in self._pairs if any(n[0] == uid for n in pair))
                continue
            for contact in pybullet.getContactPoints(bodyA=uid):
                pair = frozenset(((contact[1], contact[3]), (contact[2], contact[4])))
                if len(pair) == 2 and all(node in self._mu for node in pair) and any(
                        node in self._free for node in pair):
                    found.add(pair)
        return found
