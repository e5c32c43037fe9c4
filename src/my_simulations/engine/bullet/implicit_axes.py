"""Integrate springs and dampers of joint axes implicitly, stable for any stiffness.

Bullet's joint damping is explicit: it is wrong above a tenth of I / dt and diverges above 2 I / dt,
and an explicit spring does so above 4 I / dt^2. For the axes of one body, with the mobility matrix
A (acceleration per torque with all other axes free), dampers D, springs K with reference r, and the
acceleration a by all other forces, the rates after the step are

    (1 + dt F A (D + s dt K)) w' = w + dt F (a - A K (q - r)),  F = (e^x - 1) / x,  x = dt A_ii D_i

which for one axis is the exact decay of a damper. Soft springs (s near 0) act on the position
before the step, as in the rest of the integrator, and conserve energy. Stiff springs (s = 1) act on
the position after it. The torques with this result are A^-1 ((w' - w) / dt - a). Known efforts
enter a directly; the rest of a is estimated from the steps before.

A motor that keeps its rate cancels the damper of its axis. If both act, the solver must cancel them
in each step, and does not converge within its iterations: wheels of 10 g with dampers of
1 N m s/rad turned 0.6 and 0 % too fast. So such a damper acts only if the motor cannot overcome it.
While the motors of a body cancel all its dampers, this is checked again only after a new motor
target and every few steps; the dampers take no time in between.

Bullet computes dampers below d dt / I = 0.01 (`joint_axes`). A stronger one with less than 0.5 % of
the effort of its motor can act for half a step only, until the axis has its rate: it is left out.
"""
from __future__ import annotations

import math
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import pybullet

from ...description.model import JointAxis
from ..run_state import DamperMemory
from .bodies import Axis, Body
from .mass_matrix import MassMatrix
from .step_helper import FAR, next_multiple

_NEWEST_WEIGHT = 0.5  # weight of the newest estimate of the acceleration by other forces
_MOST_MOTION = 0.05   # rad or m of an axis until the mobility is computed again
_MOST_AGE = 100       # steps until it is computed again anyway: other axes can change it
_STIFF = 10.0         # s is this times (w dt)^2 of the spring with angular frequency w, at most 1
_MOST_DECAYS = 50.0   # of x: e^x must be finite
_AT_RATE = 0.02       # of the rate of a motor: within it, the motor keeps the rate
_NEGLIGIBLE = 5e-3    # of a motor's largest effort: a damper below it does not matter
_WEAK = 0.05          # of a motor's largest effort: a damper below it can use an old mobility
_CHECK_EVERY = 8      # steps between two checks whether motors still cancel all dampers

Motor = Optional[Tuple[float, float]]
"""The rate of a motor, rad/s or m/s, and its largest effort, N m or N; None without a motor."""


class _Bounds(NamedTuple):
    """Bounds within which the motor of an axis cancels its damper, in SI units; none by default.

    Attributes:
        largest_rate: at which the damper has the largest effort of the motor.
        target: rate of the motor.
        tolerance: of the target.
        load: effort of the damper at the target.
        most: largest effort of the motor.
    """

    largest_rate: float = -1.0
    target: float = 0.0
    tolerance: float = -1.0
    load: float = 0.0
    most: float = 0.0

    def is_below(self, share: float, rate: float) -> bool:
        """Whether the damper is weaker than a share of the largest motor effort."""
        return abs(rate) <= share * self.largest_rate

    def cancels(self, rate: float, load: float) -> bool:
        """Whether the motor keeps its rate against the damper and another load, N m or N."""
        return abs(rate - self.target) <= self.tolerance and abs(load + self.load) <= self.most


class ImplicitAxes:
    """The springs and dampers of some axes of one body.

    Attributes:
        is_cancelled: whether motors cancelled all dampers at the last check; a new target of a
            motor sets it to False.
    """

    def __init__(self, body: Body, axes: List[Axis], specs: List[JointAxis], dt: float) -> None:
        self._body = body
        self._dt = dt
        self._rows = [axis.row for axis in axes]
        self._indices = [axis.index for axis in axes]
        self._damping = np.array([spec.damping for spec in specs])
        self._stiffness = np.array([spec.spring_stiffness for spec in specs])
        self._reference = np.array([spec.spring_reference for spec in specs])
        self._has_springs = bool(self._stiffness.any())
        self._is_paused = False
        self._smoothing = 1.0 - _NEWEST_WEIGHT, _NEWEST_WEIGHT / dt, _NEWEST_WEIGHT
        self._mass_matrix: Optional[MassMatrix] = None
        self._mobility = np.eye(len(self._rows))
        self._mobility_axes: List[int] = []   # axes whose position changes the mobility
        self._is_mobility_constant = False    # no joint of the body changes it
        self._prepared_at: Optional[List[float]] = None   # positions for which it was computed
        self._mobility_age = 0
        self.reset_after_jump()

    def reset_after_jump(self) -> None:
        """Discard the estimates after the joints were set."""
        self._other_accelerations = [0.0] * len(self._rows)
        self._rates: Optional[List[float]] = None
        self._own_accelerations: List[float] = []
        self._efforts = [0.0] * len(self._rows)
        self._motor_efforts: Optional[List[float]] = None   # of the last step, from a saved state
        self.is_cancelled = False
        self._motors: List[Motor] = []
        self._bounds: List[_Bounds] = []            # for these motors

    def pause(self, is_at_rest: bool) -> None:
        """Omit the dampers of a body from now on that is fixed at rest, or (False) use them again.

        Springs are not omitted.
        """
        is_paused = is_at_rest and not self._has_springs
        if is_paused != self._is_paused:
            self._is_paused = is_paused
            self.reset_after_jump()

    @property
    def first_row(self) -> int:
        return self._rows[0]

    @property
    def memory(self) -> DamperMemory:
        """The state of the estimates, for `resume`."""
        states = pybullet.getJointStates(self._body.uid, self._indices)
        return DamperMemory(
            tuple(self._other_accelerations), None if self._rates is None else tuple(self._rates),
            tuple(self._own_accelerations), tuple(self._efforts),
            tuple(self._motor_efforts or [state[3] for state in states]), self.is_cancelled)

    def resume(self, memory: DamperMemory) -> None:
        """Continue from a saved state."""
        self._other_accelerations, self._own_accelerations = list(memory.other), list(memory.given)
        self._rates = None if memory.rates is None else list(memory.rates)
        self._efforts, self._motor_efforts = list(memory.efforts), list(memory.spent)
        self.is_cancelled = memory.cancelled

    def due(self, step: int) -> int:
        """Return the first step, `step` or later, in which `add_to` must be called."""
        if self._is_paused:
            return FAR
        return next_multiple(step, _CHECK_EVERY) if self.is_cancelled else step

    def add_to(self, efforts: Dict[int, float], motor_of: Callable[[int], Motor]) -> None:
        """Add the efforts of the next step, N m or N by row, to the other efforts.

        `motor_of` returns the motor of the axis of a row.
        """
        states = pybullet.getJointStates(self._body.uid, self._indices)
        rates = [state[1] for state in states]
        # Efforts of motors in the last step, in which the dampers had `_efforts`.
        motor_efforts = self._motor_efforts or [state[3] for state in states]
        self._motor_efforts = None
        motors = [motor_of(row) for row in self._rows]
        if motors != self._motors:
            self._motors, self._bounds = motors, self._bounds_of(motors)
        cancelled = [n for n, bounds in enumerate(self._bounds)
                     if bounds.cancels(rates[n], motor_efforts[n] + self._efforts[n])]
        self.is_cancelled = all(n in cancelled or bounds.is_below(_NEGLIGIBLE, rates[n])
                                for n, bounds in enumerate(self._bounds))
        if self.is_cancelled:
            self._rates, self._efforts = None, [0.0] * len(rates)   # the estimate starts again
            return
        positions = [state[0] for state in states]
        if self._rates is not None:
            # Acceleration by all other forces: (w - w_before) / dt - own, exponentially smoothed.
            kept, per_rate, newest = self._smoothing
            self._other_accelerations = [
                kept * other + per_rate * (rate - before) - newest * own
                for other, rate, before, own in zip(
                    self._other_accelerations, rates, self._rates, self._own_accelerations)]
        if self._prepared_at is None or not all(
                n in cancelled or bounds.is_below(_WEAK, rates[n])
                for n, bounds in enumerate(self._bounds)):
            self._update_mobility(positions)
        known = [efforts.get(row, 0.0) for row in self._rows]
        state = rates + positions + self._other_accelerations + known
        result = (self._step_matrix @ np.array(state) + self._step_constant).tolist()
        if not math.isfinite(sum(result)):
            self.reset_after_jump()
            return
        self._rates, self._own_accelerations = rates, result[len(rates):]
        self._efforts = result[:len(rates)]
        if cancelled:
            for n in cancelled:
                self._efforts[n] = 0.0
            self._own_accelerations = (self._mobility @ np.add(self._efforts, known)).tolist()
        for row, before, effort in zip(self._rows, known, self._efforts):
            efforts[row] = before + effort

    def _bounds_of(self, motors: Sequence[Motor]) -> List[_Bounds]:
        """Return the bounds of each axis; an axis with a spring has none."""
        found = []
        for motor, damping, stiffness in zip(motors, self._damping.tolist(), self._stiffness):
            if motor is None or stiffness:
                found.append(_Bounds())
                continue
            target, most = motor
            found.append(_Bounds(most / abs(damping) if damping else math.inf, target,
                                 _AT_RATE * abs(target), damping * target, most))
        return found

    def _update_mobility(self, positions: List[float]) -> None:
        """Recompute the mobility if it may have changed; turning wheels do not change it."""
        before = self._prepared_at
        if before is not None and self._is_mobility_constant:
            return
        self._mobility_age += 1
        if before is None or self._mobility_age >= _MOST_AGE or any(
                abs(positions[n] - before[n]) > _MOST_MOTION for n in self._mobility_axes):
            self._prepared_at, self._mobility_age = positions, 0
            self._compute_step()

    def _compute_step(self) -> None:
        """Compute `_step_matrix` and `_step_constant`: a step is an affine map.

        Input: rates, positions, other accelerations, known efforts. Output: efforts of springs and
        dampers, and the accelerations that these and the known efforts give.
        """
        dt, count = self._dt, len(self._rows)
        if self._mass_matrix is None:
            self._mass_matrix = MassMatrix(self._body.uid)
            wheels = self._mass_matrix.wheels()
            self._mobility_axes = [n for n, index in enumerate(self._indices)
                                   if index not in wheels]
            self._is_mobility_constant = self._mass_matrix.moves_only_by(wheels)
        matrix = self._mobility = mobility(self._mass_matrix, self._indices)
        one = np.eye(count)
        decays = np.minimum(dt * np.diag(matrix) * self._damping, _MOST_DECAYS)
        spread = np.where(decays > 1e-9, np.expm1(decays) / np.maximum(decays, 1e-9), 1.0)
        stiff = float(np.abs(matrix * self._stiffness).sum(axis=1).max()) * dt * dt
        share = min(1.0, _STIFF * stiff)
        keep = np.linalg.inv(one + dt * spread[:, None] * matrix * (
            self._damping + share * dt * self._stiffness))
        gain = keep * spread                      # of a dt in w'
        pull = -(gain @ (matrix * self._stiffness))  # acceleration by springs per position
        own = np.hstack([(keep - one) / dt, pull, gain - one, (gain - one) @ matrix])
        given = own.copy()
        given[:, 3 * count:] += matrix
        inertia = _inverse(matrix)
        self._step_matrix = np.vstack([inertia @ own, given])
        self._step_constant = np.concatenate([inertia @ (-pull @ self._reference),
                                              -pull @ self._reference])


def mobility(tree: MassMatrix, indices: List[int]) -> np.ndarray:
    """Return the acceleration of each joint per effort on each; other joints move freely.

    (n, n), 1/kg or 1/(kg m^2), in the present configuration.
    """
    mass = tree.compute()
    if not np.isfinite(mass).all():  # it has diverged; the next check restores it
        return np.eye(len(indices))
    # An axis with equal limits is welded and does not move.
    moving = [n for n, index in enumerate(indices) if index in tree.columns]
    chosen = [tree.columns[indices[n]] for n in moving]
    result = np.zeros((len(indices), len(indices)))
    result[np.ix_(moving, moving)] = _inverse(mass)[np.ix_(chosen, chosen)]
    return result


def _inverse(matrix: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:  # a degree of freedom without mass
        return np.linalg.pinv(matrix)
