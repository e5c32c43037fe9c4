"""Apply the smaller restitution of each pair, although PyBullet multiplies them.

Gazebo (ODEPhysics::Collide) takes the smaller restitution_coefficient of two surfaces, and the
smaller threshold; PyBullet multiplies the stored restitutions when two shapes touch. So the
stored values must fit all pairs that can ever collide: their logarithms x are the least squares
solution of x_i + x_j = log min(e_i, e_j). It is exact if all moving surfaces that bounce are equal.
Otherwise pairs with static surfaces have a higher weight, and the error of other pairs is reported
once.

A pair bounces if the threshold of one surface allows it. So a surface that never bounces by itself
(SDF's default threshold) bounces on one that does; if two of the former could collide, the moving
one is stored as 0. PyBullet has one threshold for the world; the smallest of all is used.

Values are computed only after a surface that bounces was added or removed.
"""
from __future__ import annotations

import itertools
import math
from typing import Callable, Dict, List, NamedTuple, Set, Tuple

import numpy as np
import pybullet

from ...geometry import Vec3
from . import surface_coefficients
from .bodies import Body
from .contact_points import LinkKey
from .step_helper import FAR, StepHelper
from .world_parameters import WorldParameters

_AMONG_MOVING = 0.05     # weight of a pair of moving surfaces; of one with a static surface: 1
_MOST_KINDS = 60         # with more, pairs of moving surfaces are ignored
_TOLERATED = 0.05


class _Kind(NamedTuple):
    """Surfaces with the same stored value; `never`: they do not bounce by themselves."""

    moves: bool
    restitution: float
    never: bool


class PairRestitution(StepHelper):
    """Updates the stored restitutions to match the surfaces of the world.

    Args:
        parameters: solver parameters of the world.
        misfit: called once, with a body and the relative error of its restitution.
    """

    def __init__(self, parameters: WorldParameters,
                 misfit: Callable[[int, float], None]) -> None:
        self._parameters, self._misfit = parameters, misfit
        self._is_reported = False
        self._changed = False
        self._kinds: Dict[LinkKey, _Kind] = {}
        self._stored: Dict[LinkKey, float] = {}
        self._thresholds: Dict[LinkKey, float] = {}
        self._models: Dict[LinkKey, int] = {}

    def add(self, body: Body) -> None:
        for uid, part in body.surfaces:
            surface = surface_coefficients.of_link(part.link)
            if surface.restitution <= 0.0:
                continue
            node = (uid, part.index)
            self._changed = True
            self._kinds[node] = _Kind(body.moves, surface.restitution, surface.bounce_threshold
                                      >= surface_coefficients.NEVER_BOUNCES)
            self._stored[node] = surface_coefficients.restitution(surface)
            self._thresholds[node] = surface.bounce_threshold
            self._models[node] = body.model_id

    def forget(self, body: Body) -> None:
        for uid, part in body.surfaces:
            for table in (self._kinds, self._stored, self._thresholds, self._models):
                self._changed |= table.pop((uid, part.index), None) is not None

    def due(self, step: int) -> int:
        """The next step after surfaces were added or removed, otherwise `FAR`."""
        return step if self._changed else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Store the restitutions for the current surfaces, if these have changed."""
        if not self._changed:
            return
        self._changed = False
        if not self._kinds:
            return
        self._parameters.set_slowest_bounce(min(self._thresholds.values()))
        values = self._solved()
        for node, kind in self._kinds.items():
            value = values.get(kind, 0.0)
            if abs(value - self._stored[node]) > 1e-9:
                self._stored[node] = value
                pybullet.changeDynamics(*node, restitution=value)

    def _solved(self) -> Dict[_Kind, float]:
        """Return the value to store for each kind; 0 for missing kinds."""
        members: Dict[_Kind, Set[int]] = {}
        for node, kind in self._kinds.items():
            members.setdefault(kind, set()).add(self._models[node])
        if all(kind.never for kind in members):
            return {}
        alone = sum(len(models) for kind, models in members.items() if kind.never) == 1
        kinds = sorted(kind for kind in members if alone or not (kind.moves and kind.never))
        column = {kind: n for n, kind in enumerate(kinds)}
        pairs = self._pairs(kinds, members)
        if not pairs:
            return {kind: kind.restitution for kind in kinds}
        rows, targets = np.zeros((len(pairs), len(kinds))), np.zeros(len(pairs))
        for n, pair in enumerate(pairs):
            targets[n] = math.log(min(kind.restitution for kind in pair))
            for kind in pair:
                rows[n, column[kind]] += 1.0
        weights = np.array([_AMONG_MOVING if one.moves and other.moves else 1.0
                            for one, other in pairs])
        solution = np.linalg.lstsq(rows * weights[:, None], targets * weights, rcond=None)[0]
        self._report_misfit(pairs, np.abs(np.expm1(rows @ solution - targets)))
        met = rows.any(axis=0)
        return {kind: math.exp(solution[n]) if met[n] else kind.restitution
                for n, kind in enumerate(kinds)}

    @staticmethod
    def _pairs(kinds: List[_Kind], members: Dict[_Kind, Set[int]]) -> List[Tuple[_Kind, _Kind]]:
        few = len(kinds) <= _MOST_KINDS
        return [(one, other) for one, other in itertools.combinations_with_replacement(kinds, 2)
                if (one.moves or other.moves) and not (one.never and other.never)
                and (few or not (one.moves and other.moves))
                and (one is not other or len(members[one]) > 1)]

    def _report_misfit(self, pairs: List[Tuple[_Kind, _Kind]], off: np.ndarray) -> None:
        worst = int(off.argmax())
        if off[worst] > _TOLERATED and not self._is_reported:
            self._is_reported = True
            moving = next(kind for kind in pairs[worst] if kind.moves)
            uid = min(node for node, kind in self._kinds.items() if kind == moving)[0]
            self._misfit(uid, float(off[worst]))
