"""What acts on bodies anew in every step: timed loads, weightless links, stiff dampers, springs.

PyBullet forgets external forces and joint torques after one step.
"""
from __future__ import annotations

from typing import Callable, Dict, List, Optional, Set, Tuple

import pybullet

from ...geometry import Quat, Vec3, add, conjugate, cross, rotate, scale
from ..commands import Load
from ..plan import BASE
from .bodies import Axis, Body, Part
from .implicit import ImplicitAxes
from .servos import MOST_EFFORT, Loop

_NOTHING = (0.0, 0.0, 0.0)


class Forces:
    """All that `apply` must do before the next step."""

    def __init__(self, wake: Callable[[List[Body]], None]) -> None:
        self._wake = wake
        self._loads: Dict[int, Load] = {}
        self._acting: Dict[int, Load] = {}
        self._loops: Dict[int, Loop] = {}
        self._parts: Dict[int, Tuple[Body, Part]] = {}
        self._axes: Dict[int, Tuple[Body, Axis]] = {}
        self._weightless: Dict[int, Tuple[Body, Part]] = {}
        self._implicit: Dict[int, ImplicitAxes] = {}
        self._limits: Dict[int, Tuple[float, float]] = {}
        self._placed: Set[int] = set()

    def add_body(self, body: Body) -> None:
        """Know the rows of a new body."""
        self._placed.add(body.uid)
        for part in body.parts:
            self._parts[part.row] = (body, part)
            if not part.gravity and body.moves:
                self._weightless[part.row] = (body, part)
        for axis in body.axes:
            self._axes[axis.row] = (body, axis)

    def set_limits(self, row: int, effort: float, rate: float) -> None:
        """Limit what loads may do on the axis of `row`; negative: not (SDF, axis/limit)."""
        self._limits.pop(row, None)
        if effort >= 0.0 or rate >= 0.0:
            self._limits[row] = (effort, rate)

    def set_implicit(self, body: Body, axes: Optional[ImplicitAxes]) -> None:
        """Let these springs and dampers, or none, act on the axes of a body."""
        self._implicit.pop(body.uid, None)
        if axes is not None:
            self._implicit[body.uid] = axes

    def disturbed(self, body: Body) -> None:
        """A body was put somewhere, or its joints were set."""
        self._placed.add(body.uid)
        if body.uid in self._implicit:
            self._implicit[body.uid].disturbed()

    def forget(self, body: Body) -> None:
        """Drop a body and every load on it."""
        self._placed.discard(body.uid)
        self._implicit.pop(body.uid, None)
        for part in body.parts:
            self._parts.pop(part.row, None)
            self._weightless.pop(part.row, None)
        for axis in body.axes:
            self._axes.pop(axis.row, None)
            self._limits.pop(axis.row, None)
        rows = {part.row for part in body.parts}
        axes = {axis.row for axis in body.axes}
        self.clear([load.load_id for load in self._loads.values()
                    if load.row in (rows if load.effort is None else axes)])

    def add_loads(self, loads: Tuple[Load, ...]) -> str:
        """Queue loads; returns why not, or ""."""
        for load in loads:
            if load.row not in (self._parts if load.effort is None else self._axes):
                return "the link or joint of the load does not exist"
        self._loads.update({load.load_id: load for load in loads})
        return ""

    def clear(self, load_ids: "List[int] | Tuple[int, ...]") -> None:
        """Drop loads by id."""
        for load_id in load_ids:
            self._loads.pop(load_id, None)
            self._acting.pop(load_id, None)
            self._loops.pop(load_id, None)

    def clear_all(self) -> None:
        """Drop every load."""
        for table in (self._loads, self._acting, self._loops):
            table.clear()

    @property
    def idle(self) -> bool:
        """True when a step needs nothing from here, now or later."""
        return not (self._loads or self._weightless or self._implicit)

    @property
    def loaded_links(self) -> Set[int]:
        """Rows of the links that a load acts on in this step."""
        return {load.row for load in self._acting.values() if load.effort is None}

    def apply(self, step: int, dt: float, gravity: Vec3) -> None:
        """Everything that acts in the step that begins at count `step`."""
        efforts: Dict[int, float] = {}
        if self._loads:
            self._turn_over(step)
            for load in self._acting.values():
                if load.effort is None:
                    self._push(load, dt)
                else:
                    efforts[load.row] = efforts.get(load.row, 0.0) + self._allowed(load, dt)
        for implicit in self._implicit.values():
            implicit.add_to(efforts)
        for row, effort in efforts.items():
            body, axis = self._axes[row]
            pybullet.setJointMotorControl2(body.uid, axis.index, pybullet.TORQUE_CONTROL,
                                           force=effort)
        for body, part in self._weightless.values():
            at = self._com(body, part)[0]
            pybullet.applyExternalForce(body.uid, part.index, scale(gravity, -part.mass), at,
                                        pybullet.WORLD_FRAME)
        self._placed.clear()

    def stepped(self) -> None:
        """A step was made without `apply`."""
        self._placed.clear()

    def _allowed(self, load: Load, dt: float) -> float:
        """An effort within the limits of its axis, each load by itself as in Gazebo.

        Nothing in the direction in which the axis moves faster than its velocity limit.
        """
        effort = load.effort or 0.0
        effort_limit, rate_limit = self._limits.get(load.row, (-1.0, -1.0))
        rate = 0.0
        if load.servo is not None or rate_limit >= 0.0:
            body, axis = self._axes[load.row]
            position, rate = pybullet.getJointState(body.uid, axis.index)[:2]
        if load.servo is not None:
            most = effort_limit if effort_limit >= 0.0 else MOST_EFFORT
            effort = self._loops[load.load_id].effort(position, rate, dt, most)
        if effort_limit >= 0.0:
            effort = max(-effort_limit, min(effort_limit, effort))
        if rate_limit >= 0.0 and abs(rate) > rate_limit and rate * effort > 0.0:
            return 0.0
        return effort

    def _turn_over(self, step: int) -> None:
        starting = []
        for load_id, load in list(self._loads.items()):
            if step >= load.stop:
                self.clear([load_id])
            elif step >= load.start and load_id not in self._acting:
                self._acting[load_id] = load
                if load.servo is not None:
                    self._loops[load_id] = Loop(load.servo)
                starting.append(load)
        if starting:
            self._wake([self._target(load) for load in starting])

    def _target(self, load: Load) -> Body:
        return (self._parts if load.effort is None else self._axes)[load.row][0]

    def _push(self, load: Load, dt: float) -> None:
        body, part = self._parts[load.row]
        if not body.moves:
            return
        at, turn = self._com(body, part)
        force, torque, point = load.force, load.torque, load.point
        if load.in_link_axes:
            # The link's axes, not the principal ones that PyBullet's frame follows.
            x, y, z, w = part.link_from_com.orientation
            inverse_turn = (-x, -y, -z, w)
            force, torque, point = (rotate(turn, rotate(inverse_turn, v))
                                    for v in (force, torque, point))
        torque = add(torque, cross(point, force))
        if force != _NOTHING:
            pybullet.applyExternalForce(body.uid, part.index, force, at, pybullet.WORLD_FRAME)
        if torque != _NOTHING and body.rigid and body.uid in self._placed:
            _spin_up(body.uid, turn, part.moments, scale(torque, dt))
        elif torque != _NOTHING:
            pybullet.applyExternalTorque(body.uid, part.index, torque, pybullet.WORLD_FRAME)

    @staticmethod
    def _com(body: Body, part: Part) -> "tuple":
        if part.index == BASE:
            return pybullet.getBasePositionAndOrientation(body.uid)
        return pybullet.getLinkState(body.uid, part.index, computeForwardKinematics=1)[:2]


def _spin_up(uid: int, turn: Quat, moments: Vec3, impulse: Vec3) -> None:
    """Give a rigid body angular momentum (N m s, world axes).

    In its first step, and in the first after it was put somewhere, a torque would meet the inertia
    of its shape, or of its former attitude: Bullet turns the inertia along at the end of a step.
    """
    linear, angular = pybullet.getBaseVelocity(uid)
    a, b, c = rotate(conjugate(turn), impulse)
    gained = rotate(turn, (a / moments[0], b / moments[1], c / moments[2]))
    pybullet.resetBaseVelocity(uid, linear, add(angular, gained))
