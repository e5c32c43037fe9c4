"""A backend without dynamics, for tests without PyBullet."""
from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any, Callable, Dict, Iterable, List, Tuple

from my_simulations.description.model import Model
from my_simulations.engine.api import CommandRefusedError, Event, RemovedError
from my_simulations.engine.commands import (
    Clear,
    Command,
    ConnectModels,
    ContinuePreparation,
    DisconnectModels,
    JointWrench,
    LinkState,
    LoadModel,
    PhysicsSettings,
    PinModels,
    PrepareModel,
    ReadContacts,
    ReadJointWrenches,
    RemoveModel,
    Restart,
    SetAxes,
    SetJoints,
    SetLinkState,
    SetModelState,
)
from my_simulations.engine.drive_commands import (
    JointMotor,
    JointServo,
    PlanarVelocity,
    ReadEfforts,
    SetMotors,
    SetPlanarVelocities,
    SetServos,
    SetWheelSlips,
    WheelSlip,
)
from my_simulations.engine.ring import JOINT_WIDTH, LINK_WIDTH
from my_simulations.engine.ring_rows import axis_rows
from my_simulations.engine.run_state import ReadRunState, RunState, SetRunState
from my_simulations.engine.timed_forces import AddTimedForces, ClearTimedForces
from my_simulations.geometry import Pose, Quat, add, compose, inverse, multiply, normalised, scale

_LINK = struct.Struct(f"={LINK_WIDTH}d")


class KinematicBackend:
    """Links move with constant twists, without gravity and contacts; timed forces are stored."""

    def __init__(self) -> None:
        self.settings = PhysicsSettings()
        self.links: Dict[int, LinkState] = {}
        self.joints: Dict[int, Tuple[float, float]] = {}
        self.models: Dict[int, Tuple[Model, int, int, bool]] = {}
        self.timed_forces: Dict[int, object] = {}
        self.held: Tuple[int, ...] = ()
        self.connected: Dict[str, ConnectModels] = {}
        self.motors: Dict[int, JointMotor] = {}
        self.planar: Dict[int, PlanarVelocity] = {}
        self.servos: Dict[int, JointServo] = {}
        self.wheel_slips: Dict[int, WheelSlip] = {}
        self.joint_wrenches: Dict[Tuple[int, str], JointWrench] = {}
        self._dirty = True
        self._appliers: Dict[type, Callable[[Any], object]] = {
            LoadModel: self._load,
            PrepareModel: lambda _: False,
            ContinuePreparation: lambda _: False,
            RemoveModel: lambda c: self._remove(c.model_id),
            Clear: self._clear,
            Restart: self._restart,
            SetModelState: self._set_model,
            SetLinkState: self._set_link,
            SetJoints: self._set_joints,
            SetAxes: self._set_axes,
            PinModels: self._hold,
            SetMotors: lambda c: self.motors.update({motor.row: motor for motor in c.motors}),
            SetPlanarVelocities: self._set_planar,
            SetServos: lambda c: self.servos.update({servo.row: servo for servo in c.servos}),
            ReadEfforts: lambda c: (0.0,) * len(c.rows),
            SetWheelSlips: lambda c: self.wheel_slips.update(
                {wheel.row: wheel for wheel in c.wheels}),
            ReadContacts: lambda _: (),
            ReadRunState: lambda _: RunState(),
            SetRunState: lambda _: None,
            ConnectModels: lambda c: self.connected.update({c.joint.name: c}),
            DisconnectModels: lambda c: [self.connected.pop(name, None) for name in c.names],
            ReadJointWrenches: lambda command: tuple(
                self.joint_wrenches.get(key) for key in command.joints),
            AddTimedForces: lambda c: self.timed_forces.update(
                {force.force_id: force for force in c.forces}
            ),
            ClearTimedForces: lambda c: [
                self.timed_forces.pop(number, None) for number in c.force_ids
            ],
        }

    def apply(self, command: Command) -> object:
        self._dirty = True
        handler = self._appliers.get(type(command))
        if handler is None:
            raise CommandRefusedError(f"a kinematic world knows no {type(command).__name__}")
        return handler(command)

    def configure(self, settings: PhysicsSettings) -> None:
        """Set the step size; other settings are ignored."""
        self.settings = settings

    def step(self, first: int, count: int) -> None:
        """Move every link along its twist, step by step: the sums are the same in any batches."""
        for _ in range(count):
            self._turn_motors(self.settings.step_size)
            if not self._move(self.settings.step_size) and not self.motors:
                return

    def _move(self, span: float) -> bool:
        """Move for `span` s; returns whether anything moves."""
        moves = False
        for row, state in self.links.items():
            pose, twist = state.pose, state.twist
            if not any(twist.linear) and not any(twist.angular):
                continue
            moves = True
            spin: Quat = (*scale(twist.angular, span / 2.0), 1.0)
            self.links[row] = LinkState(
                Pose(add(pose.position, scale(twist.linear, span)),
                     normalised(multiply(spin, pose.orientation))), twist)
        self._dirty = self._dirty or moves
        return moves

    def read(self) -> bool:
        """Whether something may have changed."""
        dirty, self._dirty = self._dirty, False
        return dirty

    def read_poses(self) -> bool:
        """Whether something may have changed; the next `read` reports it again."""
        return self._dirty

    def read_rows(self, link_rows: Tuple[int, ...]) -> bytes:
        links = self.tables()[0]
        size = _LINK.size
        return b"".join(bytes(links[row * size:(row + 1) * size]).ljust(size, b"\0")
                        for row in link_rows)

    def read_world(self) -> memoryview:
        return self.tables()[0]

    def read_axes(self, joint_rows: Tuple[int, ...]) -> List[float]:
        return [value for row in joint_rows for value in self.joints.get(row, (0.0, 0.0))]

    def tables(self) -> Tuple[memoryview, memoryview]:
        links = bytearray(_LINK.size * (max(self.links, default=-1) + 1))
        for row, state in self.links.items():
            _LINK.pack_into(links, row * _LINK.size, *state.pose.position,
                            *state.pose.orientation, *state.twist.linear, *state.twist.angular)
        joints = bytearray(8 * JOINT_WIDTH * (max(self.joints, default=-1) + 1))
        for row, values in self.joints.items():
            struct.pack_into("=2d", joints, row * 8 * JOINT_WIDTH, *values)
        return memoryview(links), memoryview(joints)

    def events(self) -> List[Event]:
        return []

    def close(self) -> None:
        """Does nothing."""

    def _clear(self, _: Clear) -> None:
        for model_id in list(self.models):
            self._remove(model_id)
        self.timed_forces.clear()
        self.motors.clear()
        self.planar.clear()
        self.servos.clear()

    def _restart(self, command: Restart) -> None:
        before = {number: self.models[number] for number, _ in command.models}
        self._clear(Clear())
        states = command.states or (None,) * len(command.models)
        for (number, pose), state in zip(command.models, states):
            model, first_link, first_joint, _ = before[number]
            self._load(LoadModel(number, model, pose, first_link, first_joint, state=state))

    def _set_planar(self, command: SetPlanarVelocities) -> None:
        self.planar = {one.model_id: one for one in command.velocities}

    def _turn_motors(self, span: float) -> None:
        """Move axes with a motor at its rate, without acceleration."""
        for row, motor in self.motors.items():
            if motor.effort > 0.0 and row in self.joints:
                self.joints[row] = (self.joints[row][0] + motor.rate * span, motor.rate)
                self._dirty = True

    def _check(self, model_ids: Iterable[int]) -> None:
        for model_id in model_ids:
            if model_id not in self.models:
                raise RemovedError("the model no longer exists")

    def _set_joints(self, command: SetJoints) -> None:
        self._check(command.of)
        self.joints.update({row: (at, rate) for row, at, rate in command.joints})

    def _set_link(self, command: SetLinkState) -> None:
        self._check(command.of)
        self.links[command.row] = LinkState(
            command.pose, command.twist or self.links[command.row].twist)

    def _set_axes(self, command: SetAxes) -> None:
        model, *rows = self.models[command.model_id]
        self.models[command.model_id] = (replace(model, joints=list(command.joints)),
                                         rows[0], rows[1], bool(rows[2]))

    def _hold(self, command: PinModels) -> None:
        self.held = command.model_ids

    def _load(self, command: LoadModel) -> None:
        model, inherited = command.model, {}
        if command.inherit:
            before, first, _, _ = self.models[command.inherit]
            inherited = {link.name: compose(self.links[first + n].pose, inverse(link.pose))
                         for n, link in enumerate(before.links)}
        self.models[command.model_id] = (model, command.first_link_row, command.first_joint_row,
                                         model.static)
        for n, link in enumerate(model.links):
            state = LinkState(compose(inherited.get(link.name, command.pose), link.pose))
            self.links[command.first_link_row + n] = (
                command.state.links[n] if command.state else state)
        for n, _ in enumerate(axis_rows(model)):
            self.joints[command.first_joint_row + n] = (
                command.state.joints[n] if command.state else (0.0, 0.0))

    def _remove(self, model_id: int) -> None:
        self._check([model_id])
        model, first_link, first_joint, _ = self.models.pop(model_id)
        for n in range(len(model.links)):
            del self.links[first_link + n]
        for n in range(len(axis_rows(model))):
            del self.joints[first_joint + n]
        for name, joint in list(self.connected.items()):
            if {joint.parent_row, joint.child_row} & set(range(first_link,
                                                               first_link + len(model.links))):
                del self.connected[name]

    def _set_model(self, command: SetModelState) -> None:
        self._check((command.model_id, *command.of))
        model, first, _, static = self.models[command.model_id]
        wanted = command.pose
        if command.frame is not None:
            at = compose(self.links[command.frame.row].pose, command.frame.offset)
            wanted = compose(at, wanted)
        current = compose(self.links[first].pose, inverse(model.links[0].pose))
        for n in range(len(model.links)):
            old = self.links[first + n]
            twist = old.twist if command.twist is None or static else command.twist
            self.links[first + n] = LinkState(
                compose(wanted, compose(inverse(current), old.pose)), twist)
