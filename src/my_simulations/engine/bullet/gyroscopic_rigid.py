"""Conserve the angular momentum of bodies that tumble freely.

Bullet integrates the gyroscopic torque to first order: a body with three different moments that
turns at 10 rad/s loses 3 to 5 % of its momentum and 10 % of its energy in 20 s. Without torque the
momentum L = R I R^T w is constant (Euler's equations), so the attitude follows q' = w(q) q / 2 with
w = R I^-1 R^T L. After each 8 ms of free flight the attitude is set to the Runge-Kutta 4 solution.
A body flies freely if gravity alone has changed its velocity. For a damped body, L is reduced by
the damping after each step.

Only bodies that turn fast are corrected; a periodic check finds them.
"""
from __future__ import annotations

from math import ceil, sqrt
from typing import Callable, Dict, NamedTuple, Set

import pybullet

from ...geometry import Quat, Vec3, conjugate, norm, normalised, rotate, scale
from .agenda import Agenda
from .approach import flies
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .step_helper import StepHelper, next_multiple

_EVERY = 16          # steps between two checks of a body that does not turn fast
_CONTACT_EVERY = 32  # steps until the next check of a fast body that touched something
_FAST = 1.0          # rad/s
_ROUND = 0.02        # relative difference below which moments count as equal
_SPAN = 8.1e-3       # s of free flight after which an attitude is corrected
_ANGLE = 0.05        # rad, largest rotation in a Runge-Kutta step


class _Flight(NamedTuple):
    """A body before a step: attitude of its principal axes, and velocities in world axes."""

    turn: Quat
    linear: Vec3
    angular: Vec3


class GyroscopicRigid(StepHelper):
    """Corrects free, fast, asymmetric rigid bodies."""

    events = COMMANDED | {BodyEvent.STATE_SET, BodyEvent.STATE_REPAIRED}

    def __init__(self, loaded: Callable[[], Set[int]]) -> None:
        """`loaded` returns the rows of the links on which a timed force acts in this step."""
        self._loaded = loaded
        self._flights: Dict[int, _Flight] = {}
        self._agenda: Agenda[int] = Agenda()
        self._steps = 1                          # between two corrections
        self._moments: Dict[int, Vec3] = {}
        self._bodies: Dict[int, Body] = {}
        self._damped: Set[int] = set()
        self.body_tables = (self._flights, self._agenda, self._moments, self._bodies, self._damped)

    def add(self, body: Body) -> None:
        """Register a body; only rigid, moving ones with different moments matter."""
        moments = body.parts[0].moments
        if body.rigid and body.moves and max(moments) - min(moments) > _ROUND * max(moments):
            self._moments[body.uid] = moments
            self._bodies[body.uid] = body
            self._agenda.plan(body.uid, 0)
            if body.parts[0].link.linear_decay or body.parts[0].link.angular_decay:
                self._damped.add(body.uid)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Discard the state of a body that was recorded before a command; check it soon."""
        if body.uid in self._bodies:
            self._flights.pop(body.uid, None)
            self._agenda.plan(body.uid, 0)

    def due(self, step: int) -> int:
        """The start or end of the next free flight of 8 ms; each step for damped bodies."""
        begins = max(step, self._agenda.next)
        if not self._flights:
            return begins
        damped = not self._damped.isdisjoint(self._flights)
        return min(begins, step if damped else next_multiple(step + 1, self._steps) - 1)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Check bodies that are due; record the motion of those that turn fast."""
        self._steps = next((n for n in (8, 4, 2) if n * dt <= _SPAN), 1)
        loaded = self._loaded()
        for uid in self._agenda.take(step):
            linear, angular = pybullet.getBaseVelocity(uid)
            if norm(angular) <= _FAST or self._bodies[uid].parts[0].row in loaded:
                self._agenda.plan(uid, next_multiple(step + _EVERY, _EVERY))
            elif step % self._steps and uid not in self._damped:
                self._agenda.plan(uid, next_multiple(step, self._steps))
            else:
                turn = pybullet.getBasePositionAndOrientation(uid)[1]
                self._flights[uid] = _Flight(turn, linear, angular)

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Set attitude and velocity of freely flying bodies to match their angular momentum."""
        ends = (step + 1) % self._steps == 0
        for uid, flight in list(self._flights.items()):
            body, damped = self._bodies[uid], uid in self._damped
            if not (ends or damped):
                continue
            del self._flights[uid]
            follows = step + 1
            span = dt if damped else self._steps * dt
            if self._met_something(body, flight, span, gravity):
                follows = next_multiple(step + _CONTACT_EVERY, self._steps)
            elif not (body.ties or body.parts[0].row in self._loaded()):
                self._correct(uid, flight, span)
            self._agenda.plan(uid, follows)

    def _met_something(self, body: Body, flight: _Flight, span: float, gravity: Vec3) -> bool:
        """Whether anything but gravity has changed the velocity of a body in `span` s."""
        if body.uid in self._damped:
            return bool(pybullet.getContactPoints(bodyA=body.uid))
        return not flies(body, flight.linear, pybullet.getBaseVelocity(body.uid)[0],
                         scale(gravity, span))

    def _correct(self, uid: int, flight: _Flight, span: float) -> None:
        """Correct a body after `span` s of free flight to match its angular momentum."""
        moments = self._moments[uid]
        momentum = scale(_momentum(flight.turn, flight.angular, moments),
                         self._bodies[uid].angular_velocity_kept)
        turn, parts = flight.turn, ceil(span * norm(flight.angular) / _ANGLE)
        for _ in range(parts):
            turn = _integrate_attitude(turn, momentum, moments, span / parts)
        linear = pybullet.getBaseVelocity(uid)[0]  # read first: setting the pose resets it
        pybullet.resetBasePositionAndOrientation(
            uid, pybullet.getBasePositionAndOrientation(uid)[0], turn)
        pybullet.resetBaseVelocity(uid, linear, _velocity(turn, momentum, moments))


def _momentum(turn: Quat, angular: Vec3, moments: Vec3) -> Vec3:
    """L = R I R^T w, world axes."""
    own = rotate(conjugate(turn), angular)
    return rotate(turn, (own[0] * moments[0], own[1] * moments[1], own[2] * moments[2]))


def _velocity(turn: Quat, momentum: Vec3, moments: Vec3) -> Vec3:
    """w = R I^-1 R^T L, world axes; any length of the quaternion.

    Written without matrices for speed: each correction calls it several times.
    """
    x, y, z, w = turn
    one = 1.0 / sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x * one, y * one, z * one, w * one
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    wx, wy, wz = w * x, w * y, w * z
    a1, a2, a3 = 1.0 - 2.0 * (yy + zz), 2.0 * (xy + wz), 2.0 * (xz - wy)
    b1, b2, b3 = 2.0 * (xy - wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz + wx)
    c1, c2, c3 = 2.0 * (xz + wy), 2.0 * (yz - wx), 1.0 - 2.0 * (xx + yy)
    m1, m2, m3 = momentum
    a = (a1 * m1 + a2 * m2 + a3 * m3) / moments[0]
    b = (b1 * m1 + b2 * m2 + b3 * m3) / moments[1]
    c = (c1 * m1 + c2 * m2 + c3 * m3) / moments[2]
    return (a1 * a + b1 * b + c1 * c, a2 * a + b2 * b + c2 * c, a3 * a + b3 * b + c3 * c)


def _integrate_attitude(turn: Quat, momentum: Vec3, moments: Vec3, dt: float) -> Quat:
    """Return the attitude `dt` s later: one Runge-Kutta 4 step of q' = w(q) q / 2."""
    x, y, z, w = turn
    at, total = turn, (0.0, 0.0, 0.0, 0.0)
    for weight, span in ((1.0, dt / 2), (2.0, dt / 2), (2.0, dt), (1.0, 0.0)):
        p, q, r = _velocity(at, momentum, moments)
        i, j, k, e = at
        slope = (0.5 * (p * e + q * k - r * j), 0.5 * (q * e + r * i - p * k),
                 0.5 * (r * e + p * j - q * i), -0.5 * (p * i + q * j + r * k))
        total = (total[0] + weight * slope[0], total[1] + weight * slope[1],
                 total[2] + weight * slope[2], total[3] + weight * slope[3])
        at = (x + span * slope[0], y + span * slope[1], z + span * slope[2], w + span * slope[3])
    share = dt / 6
    return normalised((x + share * total[0], y + share * total[1], z + share * total[2],
                       w + share * total[3]))
