"""Apply the forces of each step: timed forces, weightless links, dampers, springs.

PyBullet forgets external forces and joint torques after one step.
"""
from __future__ import annotations

from typing import Callable, Dict, FrozenSet, List, Optional, Sequence, Set, Tuple

import pybullet

from ...geometry import (
    ZERO3,
    Quat,
    Vec3,
    add,
    conjugate,
    cross,
    is_finite,
    rotate,
    scale,
)
from ..api import CommandRefusedError
from ..ring import pose_and_twist
from ..run_state import LoopMemory, RunState
from ..timed_forces import TimedEffort, TimedForce, TimedWrench
from ..wrench_laws import AT_REST, WrenchLaw
from .bodies import Axis, Body, Part, set_sleep
from .body_events import BodyEvent
from .carried_weight import add_velocity
from .implicit_axes import ImplicitAxes, Motor
from .joint_pid import MOST_EFFORT, PidController
from .joint_servos import JointServos
from .link_rows import ROW
from .link_states import read_com_pose
from .step_helper import FAR, StepHelper

_NOBODY: FrozenSet[int] = frozenset()


class Forces(StepHelper):
    """Applies forces and efforts before each step.

    Attributes:
        servos: the servos of joint axes.
    """

    events = frozenset((BodyEvent.STATE_SET, BodyEvent.STATE_REPAIRED, BodyEvent.FIXED_AT_REST,
                        BodyEvent.RELEASED, BodyEvent.MOTOR_TARGET_CHANGED))

    def __init__(self, wake: Callable[[List[Body]], None],
                 loops_changed: Callable[[Set[int]], None],
                 release: Callable[[Body, Axis], None],
                 motor_of: Callable[[int], Motor],
                 read_links: Callable[[Tuple[int, ...]], bytes],
                 read_axes: Callable[[Tuple[int, ...]], List[float]]) -> None:
        """`loops_changed` is called with the axis rows that PID loops drive, when these change.

        `release` restores the motor or friction of an axis after a servo. `motor_of` returns
        the motor of the axis of a row. `read_links` returns the current rows of links,
        `read_axes` the position and rate of axes.
        """
        self._motor_of, self._read_links, self._read_axes = motor_of, read_links, read_axes
        # Forces and torques that wrench laws gave in the last step, by force id.
        self._by_law: Dict[int, Tuple[Vec3, Vec3]] = {}
        self._wake = wake
        self._loops_changed = loops_changed
        self._timed: Dict[int, TimedForce] = {}
        self._acting: Dict[int, TimedForce] = {}
        self._loops: Dict[int, PidController] = {}
        self._resumed: Dict[int, LoopMemory] = {}   # of loops that act from the next step on
        self._parts: Dict[int, Tuple[Body, Part]] = {}
        self._axes: Dict[int, Tuple[Body, Axis]] = {}
        self._weightless: Dict[int, Tuple[Body, Part]] = {}
        self._implicit: Dict[int, ImplicitAxes] = {}
        self._limits: Dict[int, Tuple[float, float]] = {}
        self._efforts: Tuple[int, Dict[int, float]] = -1, {}   # step count, efforts by axis row
        self.servos = JointServos(self._axes, wake, release)

    def add(self, body: Body) -> None:
        for part in body.parts:
            self._parts[part.row] = (body, part)
            if not part.link.gravity and body.moves:
                self._weightless[part.row] = (body, part)
        for axis in body.axes:
            self._axes[axis.row] = (body, axis)

    def set_limits(self, row: int, effort: float, rate: float) -> None:
        """Limit efforts and rate on the axis of `row`; negative for no limit (SDF, axis/limit)."""
        self._limits.pop(row, None)
        if effort >= 0.0 or rate >= 0.0:
            self._limits[row] = (effort, rate)

    def set_implicit(self, body: Body, axes: Optional[ImplicitAxes]) -> None:
        """Set the springs and dampers of the axes of a body; None removes them."""
        self._implicit.pop(body.uid, None)
        if axes is not None:
            self._implicit[body.uid] = axes

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Reset servos and dampers after joints were set; omit dampers of a body fixed at rest."""
        axes = self._implicit.get(body.uid)
        if event in (BodyEvent.STATE_SET, BodyEvent.STATE_REPAIRED):
            self.servos.reset_after_jump(body)
            if axes is not None:
                axes.reset_after_jump()
        elif axes is not None and event is BodyEvent.MOTOR_TARGET_CHANGED:
            axes.is_cancelled = False
        elif axes is not None:   # a servo can move the body at any time
            axes.pause(event is BodyEvent.FIXED_AT_REST and not self.servos.drives(body))

    def forget(self, body: Body) -> None:
        """Discard a removed body and the timed forces on it."""
        self.set_implicit(body, None)
        self.servos.forget(body)
        rows = {part.row for part in body.parts}
        axes = {axis.row for axis in body.axes}
        self.drop([force.force_id for force in self._timed.values()
                   if force.row in (rows if isinstance(force, TimedWrench) else axes)])
        for part in body.parts:
            self._parts.pop(part.row, None)
            self._weightless.pop(part.row, None)
        for axis in body.axes:
            self._axes.pop(axis.row, None)
            self._limits.pop(axis.row, None)

    def queue(self, forces: Sequence[TimedForce]) -> None:
        """Queue timed forces. Raises CommandRefusedError before any is queued."""
        for force in forces:
            if force.row not in (self._parts if isinstance(force, TimedWrench) else self._axes):
                raise CommandRefusedError(
                    "the link or joint of the wrench or effort does not exist")
        self._timed.update({force.force_id: force for force in forces})

    def drop(self, force_ids: Sequence[int]) -> None:
        """Remove timed forces by id."""
        ended = [self._loops.pop(force_id, None) for force_id in force_ids]
        for force_id in force_ids:
            self._timed.pop(force_id, None)
            self._by_law.pop(force_id, None)
            force = self._acting.pop(force_id, None)
            if force is not None:
                body = self._target(force)
                body.force_count -= 1
                if not body.force_count:
                    set_sleep(body)
        if any(ended):
            self._update_loop_rows()

    def _update_loop_rows(self) -> None:
        rows = {self._acting[number].row for number in self._loops if number in self._acting}
        self.servos.disable_for_loops(rows)
        self._loops_changed(rows)

    def run_state(self) -> RunState:
        """Return the states of servos, PID loops, springs and dampers, for `resume`."""
        return RunState(
            servos=self.servos.memories(),
            loops=tuple((number, loop.memory) for number, loop in self._loops.items()),
            dampers=tuple((axes.first_row, axes.memory) for axes in self._implicit.values()))

    def resume(self, state: RunState) -> None:
        """Continue from saved states; PID loops resume theirs when they start."""
        self.servos.resume(state.servos)
        self._resumed = dict(state.loops)
        for row, memory in state.dampers:
            self._implicit[self._axes[row][0].uid].resume(memory)

    @property
    def wrenched_links(self) -> Set[int]:
        """Rows of the links that a timed wrench acts on in this step."""
        return {force.row for force in self._acting.values() if isinstance(force, TimedWrench)}

    def acting_on(self, row: int) -> Tuple[Vec3, Vec3]:
        """The timed wrenches of the last step on a link: force and torque about its centre of mass.

        N and N m, world axes.
        """
        force, torque = ZERO3, ZERO3
        for wrench in self._acting.values():
            if isinstance(wrench, TimedWrench) and wrench.row == row:
                body, part = self._parts[row]
                one, other = self._by_law.get(wrench.force_id) or _in_world(
                    wrench, part, read_com_pose(body.uid, part.index)[1])
                force, torque = add(force, one), add(torque, other)
        return force, torque

    @property
    def loaded_bodies(self) -> Set[int]:
        """PyBullet's numbers of the bodies that timed forces or splines move in this step."""
        return {self._target(force).uid for force in self._acting.values()} | self.servos.moving

    def due(self, step: int) -> int:
        """Each step while any force acts, otherwise the next check of cancelled dampers."""
        if self._timed or self._weightless or not self.servos.idle:
            return step
        return min((axes.due(step) for axes in self._implicit.values()), default=FAR)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Apply all forces of the step that begins at count `step`."""
        efforts: Dict[int, float] = {}
        self._efforts = step, efforts
        if self._timed:
            self._begin_and_end(step)
            for force in self._acting.values():
                if isinstance(force, TimedWrench):
                    self._apply_wrench(force, dt)
                elif isinstance(force, TimedEffort):
                    efforts[force.row] = efforts.get(force.row, 0.0) + self._limited(force, dt)
        if not self.servos.idle:
            self.servos.act(efforts, {self._axes[row][0].uid for row in efforts}
                            | self._implicit.keys() if efforts or self._implicit else _NOBODY,
                            step)
        for implicit in self._implicit.values():
            if implicit.due(step) == step:
                implicit.add_to(efforts, self._motor_of)
        if efforts:
            self._apply_efforts(efforts)
        for body, part in self._weightless.values():
            at = read_com_pose(body.uid, part.index)[0]
            pybullet.applyExternalForce(body.uid, part.index, scale(gravity, -part.mass), at,
                                        pybullet.WORLD_FRAME)

    def effort_on(self, row: int, step: int) -> float:
        """Return the effort on an axis in the step that begins at count `step`, N m or N.

        Efforts of motors are not included.
        """
        at, efforts = self._efforts
        if at != step:
            return 0.0
        effort = efforts.get(row)
        return self.servos.effort_of(row) if effort is None else effort

    def _apply_efforts(self, efforts: Dict[int, float]) -> None:
        """Apply efforts by row, one call per body; a call per axis takes four times as long."""
        bodies: Dict[int, Tuple[List[int], List[float]]] = {}
        for row, effort in efforts.items():
            body, axis = self._axes[row]
            indices, given = bodies.setdefault(body.uid, ([], []))
            indices.append(axis.index)
            given.append(effort)
        for uid, (indices, given) in bodies.items():
            pybullet.setJointMotorControlArray(uid, indices, pybullet.TORQUE_CONTROL, forces=given)

    def _limited(self, force: TimedEffort, dt: float) -> float:
        """Return a timed effort within the limits of its axis, each by itself as in Gazebo.

        The effort is 0 if it would accelerate an axis that is above its velocity limit.
        """
        effort = force.effort
        effort_limit, rate_limit = self._limits.get(force.row, (-1.0, -1.0))
        rate = 0.0
        if force.pid is not None or rate_limit >= 0.0:
            body, axis = self._axes[force.row]
            position, rate = pybullet.getJointState(body.uid, axis.index)[:2]
        if force.pid is not None:
            most = effort_limit if effort_limit >= 0.0 else MOST_EFFORT
            effort = self._loops[force.force_id].effort(position, rate, dt, most)
        if effort_limit >= 0.0:
            effort = max(-effort_limit, min(effort_limit, effort))
        if rate_limit >= 0.0 and abs(rate) > rate_limit and rate * effort > 0.0:
            return 0.0
        return effort

    def _begin_and_end(self, step: int) -> None:
        beginning = []
        loops = len(self._loops)
        for force_id, force in list(self._timed.items()):
            if step >= force.stop:
                self.drop([force_id])
            elif step >= force.start and force_id not in self._acting:
                self._acting[force_id] = force
                if isinstance(force, TimedEffort) and force.pid is not None:
                    self._loops[force_id] = PidController(force.pid)
                    if force_id in self._resumed:
                        self._loops[force_id].resume(self._resumed.pop(force_id))
                beginning.append(force)
        if len(self._loops) != loops:
            self._update_loop_rows()
        if beginning:
            targets = [self._target(force) for force in beginning]
            self._wake(targets)
            for body in targets:
                # As in Gazebo, a force keeps its body awake.
                body.force_count += 1
                if body.force_count == 1:
                    set_sleep(body)

    def _target(self, force: TimedForce) -> Body:
        if isinstance(force, TimedWrench):
            return self._parts[force.row][0]
        return self._axes[force.row][0]

    def _apply_wrench(self, wrench: TimedWrench, dt: float) -> None:
        body, part = self._parts[wrench.row]
        if not body.moves:
            return
        at, turn = read_com_pose(body.uid, part.index)
        force, torque = _in_world(wrench, part, turn) if wrench.law is None \
            else self._wrench_of_law(wrench, wrench.law, part.link_from_com.position)
        if force != ZERO3 and body.rigid and body.ties:   # as `CarriedWeight`
            add_velocity(body, scale(force, dt / part.mass))
        elif force != ZERO3:
            pybullet.applyExternalForce(body.uid, part.index, force, at, pybullet.WORLD_FRAME)
        if torque != ZERO3 and body.rigid:
            # Compensates Bullet's damping, which reduces the added velocity in this step.
            _spin_up(body.uid, turn, part.moments, scale(torque, dt / body.angular_velocity_kept))
        elif torque != ZERO3:
            pybullet.applyExternalTorque(body.uid, part.index, torque, pybullet.WORLD_FRAME)

    def _wrench_of_law(self, wrench: TimedWrench, law: WrenchLaw, com: Vec3) -> Tuple[Vec3, Vec3]:
        """Return force and torque for the state of the link; zero if they are not finite."""
        pose, twist = pose_and_twist(ROW.unpack(self._read_links((wrench.row,))))
        joint = AT_REST
        if wrench.axis_row >= 0:
            position, rate = self._read_axes((wrench.axis_row,))
            joint = position, rate
        force, torque = law.wrench(pose, twist, com, joint)
        found = (force, torque) if is_finite(*force, *torque) else (ZERO3, ZERO3)
        self._by_law[wrench.force_id] = found
        return found


def _in_world(wrench: TimedWrench, part: Part, turn: Quat) -> Tuple[Vec3, Vec3]:
    """Return force, and torque about the centre of mass, in world axes.

    `turn`: the orientation of the principal axes.
    """
    force, torque, point = wrench.force, wrench.torque, wrench.point
    if wrench.in_link_axes:
        # PyBullet's frame has the principal axes, the wrench is given in the link's axes.
        back = conjugate(part.link_from_com.orientation)
        force, torque, point = (rotate(turn, rotate(back, v)) for v in (force, torque, point))
    return force, add(torque, cross(point, force)) if any(point) else torque


def _spin_up(uid: int, turn: Quat, moments: Vec3, impulse: Vec3) -> None:
    """Add angular momentum `impulse` to a rigid body (N m s, world axes).

    This replaces a torque for two reasons. Bullet's friction does not include torques, so a body
    held by friction would creep by the velocity that a torque adds in one step. Bullet updates
    the inertia tensor only at the end of a step. In the first step of a body a torque would use
    the inertia of its shape; in the first step after a new pose, that of the former attitude.
    """
    linear, angular = pybullet.getBaseVelocity(uid)
    a, b, c = rotate(conjugate(turn), impulse)
    gained = rotate(turn, (a / moments[0], b / moments[1], c / moments[2]))
    pybullet.resetBaseVelocity(uid, linear, add(angular, gained))
