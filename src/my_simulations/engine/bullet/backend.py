"""Apply commands to a PyBullet world, make its steps, and read its state.

`HelperSet` lists the helpers that act before and after the steps; `StepLoop` calls them.
"""
from __future__ import annotations

from dataclasses import replace
from itertools import zip_longest
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Type

import pybullet

from ...description.model import Model
from ...geometry import Pose, pose_is_finite
from ..api import CommandRefusedError, EngineBrokenError, Event, RemovedError
from ..body_plan import open_joints
from ..commands import (
    Clear,
    Command,
    ConnectModels,
    ContinuePreparation,
    DisconnectModels,
    LoadModel,
    ModelState,
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
from ..drive_commands import ReadEfforts, SetMotors, SetPlanarVelocities, SetServos, SetWheelSlips
from ..ring import JOINTS, LINKS
from ..run_state import ReadRunState, RunState, SetRunState
from ..timed_forces import AddTimedForces, ClearTimedForces
from . import bodies
from .bodies import Body, Part
from .body_builder import Builder
from .closing_joints import closing_joints
from .collision_shapes import ShapeFactory
from .contact_readout import read_contacts
from .helper_set import HelperSet
from .joint_constraints import Constraints
from .shape_preparation import ShapePreparation
from .state_restore import Entry, Start, inherited, restore, show_initial_rows, store_initial_rows


class BulletBackend:
    """One PyBullet world. A process can have only one (PyBullet's default client 0)."""

    def __init__(self) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._shapes = ShapeFactory()
        self._preparation = ShapePreparation(self._shapes)
        self._models: Dict[int, Entry] = {}
        self._bodies: Dict[int, Body] = {}
        self._rows: Dict[int, Tuple[Body, Part]] = {}
        self._axes: Dict[int, Tuple[Body, bodies.Axis]] = {}
        self._helpers = HelperSet(self._models, self._bodies, self._rows, self._axes)
        self._readout, self._waker = self._helpers.readout, self._helpers.waker
        self._mover, self._notices = self._helpers.mover, self._helpers.notices
        self._row_reader = self._helpers.row_reader
        self._deferred_starts: Optional[List[Start]] = None
        self._is_fresh = True   # no step was made since the world was created or cleared
        self._appliers: Dict[Type[Command], Callable[[Any], object]] = {
            LoadModel: self._load, RemoveModel: self._remove, Clear: self._clear,
            Restart: self._restart,
            PrepareModel: self._preparation.begin,
            ContinuePreparation: self._preparation.advance,
            SetModelState: lambda command: self._mover.set_model(
                command, self._entry(command.model_id)),
            SetLinkState: self._mover.set_link, SetJoints: self._mover.set_joints,
            SetAxes: self._set_axes, PinModels: self._pin,
            ConnectModels: self._connect,
            DisconnectModels: self._disconnect,
            SetMotors: lambda command: self._helpers.motors.set(command.motors),
            SetPlanarVelocities: lambda command: self._helpers.planar.set(command.velocities),
            ReadContacts: lambda command: read_contacts(
                self._bodies, self._helpers.wheel_friction),
            SetWheelSlips: self._set_wheel_slips,
            ReadJointWrenches: lambda command: self._helpers.wrenches.read(command),
            SetServos: lambda command: self._helpers.forces.servos.set(
                command.servos, self._helpers.settings.step_size),
            ReadEfforts: lambda command: self._helpers.forces.servos.efforts(command.rows),
            AddTimedForces: lambda command: self._helpers.forces.queue(command.forces),
            ClearTimedForces: lambda command: self._helpers.forces.drop(command.force_ids),
            ReadRunState: self._read_run_state, SetRunState: self._set_run_state,
        }
        self._helpers.configure(self._helpers.settings)

    # -- Backend ---------------------------------------------------------------------------------

    def apply(self, command: Command) -> object:
        if not isinstance(command, (Restart, Clear)):
            self._build_deferred()
        self._helpers.loop.invalidate_due_steps()
        if isinstance(command, (SetModelState, SetLinkState, SetJoints)):
            for model_id in command.of:
                self._entry(model_id)
        return self._appliers[type(command)](command)

    def configure(self, settings: PhysicsSettings) -> None:
        """Use other settings from the next step on; a changed gravity wakes everything."""
        self._build_deferred()
        self._helpers.loop.invalidate_due_steps()
        before = self._helpers.settings
        if settings.gravity != before.gravity:
            self._waker.everything()  # first: Bullet sets a new gravity for awake bodies only
        self._helpers.configure(settings)
        if settings.step_size != before.step_size:
            for entry in self._models.values():
                for body in entry.bodies:
                    self._helpers.use_step_size(body, entry.model)

    def step(self, first: int, count: int) -> None:
        self._build_deferred()
        self._is_fresh = False
        self._readout.mark_stepped()
        self._helpers.restored_sleep.forget_commands()
        run, wrenches = self._helpers.loop.run, self._helpers.wrenches
        dt, gravity = self._helpers.settings.step_size, self._helpers.settings.gravity
        if wrenches.idle:
            run(first, count, dt, gravity)
            return
        # The wrenches of joints are measured in the last step only: no earlier one can be read.
        if count > 1:
            run(first, count - 1, dt, gravity)
        self._helpers.loop.invalidate_due_steps()
        wrenches.before(count)
        run(first + count - 1, 1, dt, gravity)
        wrenches.after(dt, gravity)
        self._helpers.loop.invalidate_due_steps()

    def read(self) -> bool:
        return self._deferred_starts is not None or self._readout.read()

    def read_poses(self) -> bool:
        return self._deferred_starts is not None or self._readout.read_poses()

    def read_rows(self, link_rows: Tuple[int, ...]) -> bytes:
        self._build_deferred()
        return self._row_reader.read_links(link_rows)

    def read_world(self) -> memoryview:
        self._build_deferred()
        self._readout.update()
        return self._readout.tables()[0]

    def read_axes(self, joint_rows: Tuple[int, ...]) -> List[float]:
        self._build_deferred()
        return self._row_reader.read_axes(joint_rows)

    def tables(self) -> Tuple[memoryview, memoryview]:
        return self._readout.tables()

    def events(self) -> List[Event]:
        return self._notices.take_events()

    def close(self) -> None:
        """Disconnect and remove scratch files."""
        pybullet.disconnect(self._client)
        self._shapes.close()

    # -- models ----------------------------------------------------------------------------------

    def _load(self, command: LoadModel) -> None:
        self._check_load(command)
        entry = self._enter(Builder(command, self._shapes), command.model, command.pose)
        state = self._inherited(command) if command.inherit else command.state
        if state is not None:
            restore(entry, state)
        # All bodies of a fresh world are awake. A search for neighbours changes the order of
        # Bullet's contacts, and so the run. A restart omits the search and must repeat the run.
        if not self._is_fresh:
            self._waker.around(entry.bodies)

    def _enter(self, builder: Builder, model: Model, pose: Pose) -> Entry:
        """Build a model and register its bodies."""
        first_row = builder.link_rows.start
        built = builder.build(pose)
        constraints = Constraints(self._helpers.book, model, builder.plans, built, pose,
                                  open_joints(model, builder.plans), first_row)
        entry = Entry(model, builder, built, first_row, pose, constraints)
        self._models[builder.model_id] = entry
        rows = builder.joint_rows
        self._readout.add_joints(rows, closing_joints(
            list(constraints.closing), model, pose, first_row, rows.start))
        for body in built:
            self._register(body)
            self._helpers.add(body, model)
        return entry

    def _restart(self, command: Restart) -> None:
        """Reset the world: show cached initial states at once, and build the bodies at first use.

        So the reset returns without delay, and several resets in a row build the bodies once.
        Without cached states the bodies are built now. If this engine process ends before the
        build, the tables already hold the states with which a new engine starts.
        """
        self._notices.forget_all()
        starts = [(self._entry(number), pose) for number, pose in command.models]
        if command.states:
            self._build_again(starts, command.states)
        elif len(starts) == len(self._models) and show_initial_rows(self._readout, starts):
            self._deferred_starts = starts
        else:
            self._build_again(starts)
            store_initial_rows(self._readout, starts)

    def _build_deferred(self) -> None:
        """Build the bodies of a reset whose build was deferred."""
        if self._deferred_starts is not None:
            self._build_again(self._deferred_starts)

    def _build_again(self, starts: List[Start], states: Sequence[ModelState] = ()) -> None:
        self._clear(Clear())
        try:
            for (entry, pose), state in zip_longest(starts, states):
                built = self._enter(entry.builder, entry.model, pose)
                if state is not None:
                    restore(built, state)
        except (CommandRefusedError, pybullet.error) as fault:
            # These models were built before, so a file has been removed since.
            raise EngineBrokenError(f"the world could not be built again: {fault}") from fault

    def _inherited(self, command: LoadModel) -> ModelState:
        self._readout.update()
        before = self._entry(command.inherit)
        return inherited(before, command.model, self._mover.present_model_pose(before),
                         self._mover.link_state, self._readout.joints)

    def _check_load(self, command: LoadModel) -> None:
        if command.model_id in self._models:
            raise CommandRefusedError(f"model number {command.model_id} is taken")
        if not pose_is_finite(command.pose):
            raise CommandRefusedError(f"the pose of model '{command.model.name}' is not finite")
        if (command.first_link_row + len(command.model.links) > LINKS
                or command.first_joint_row + len(command.model.joints) > JOINTS):
            raise CommandRefusedError(
                f"the world is full: {LINKS} links and {JOINTS} joints are its limit")

    def _register(self, body: Body) -> None:
        for uid in body.uids:
            self._bodies[uid] = body
        for part in body.parts:
            self._rows[part.row] = (body, part)
        for axis in body.axes:
            self._axes[axis.row] = (body, axis)

    def _remove(self, command: RemoveModel) -> None:
        entry = self._entry(command.model_id)
        self._waker.around(entry.bodies)
        del self._models[command.model_id]
        self._notices.forget(command.model_id)
        entry.constraints.remove()
        self._readout.forget_joints(entry.builder.joint_rows)
        for body in entry.bodies:
            self._helpers.forget(body)
            for uid in body.uids:
                del self._bodies[uid]
            for part in body.parts:
                del self._rows[part.row]
            for axis in body.axes:
                del self._axes[axis.row]
        entry.builder.remove(entry.bodies)

    def _connect(self, command: ConnectModels) -> None:
        self._helpers.ties.connect(command, self._rows)
        self._waker.around([self._rows[row][0] for row in (command.child_row, command.parent_row)
                            if row >= 0])

    def _disconnect(self, command: DisconnectModels) -> None:
        self._waker.around(self._helpers.ties.disconnect(command.names))

    def _clear(self, _: Clear) -> None:
        self._deferred_starts = None
        self._is_fresh = True
        self._models.clear()
        self._helpers.clear()
        for table in (self._bodies, self._rows, self._axes):
            table.clear()
        # This call takes half the time of a reset, but runs repeat only with it. When the bodies
        # were removed one by one instead, 10 of 60 piles of 60 bodies fell differently; with it,
        # none (measured).
        pybullet.resetSimulation()
        self._shapes.forget_world()
        self._helpers.configure(self._helpers.settings)

    def _entry(self, model_id: int) -> Entry:
        if model_id not in self._models:
            raise RemovedError("the model no longer exists")
        return self._models[model_id]

    # -- states ----------------------------------------------------------------------------------

    def _set_axes(self, command: SetAxes) -> None:
        entry = self._entry(command.model_id)
        entry.model = replace(entry.model, joints=list(command.joints))
        self._waker.around(entry.bodies)
        for body in entry.bodies:
            self._helpers.set_up_axes(body, entry.model)

    def _set_wheel_slips(self, command: SetWheelSlips) -> None:
        for wheel in command.wheels:
            if wheel.row not in self._rows or wheel.joint_row not in self._axes:
                raise CommandRefusedError("the link or joint of the wheel does not exist")
        self._helpers.wheel_friction.set_slips(command.wheels)

    def _pin(self, command: PinModels) -> None:
        self._helpers.pinned.set(body for number in command.model_ids
                                 for body in self._entry(number).bodies)

    def _read_run_state(self, _: ReadRunState) -> RunState:
        helpers = self._helpers
        resting = dict(helpers.settling.held)
        for body in self._bodies.values():
            place = helpers.restored_sleep.rest_pose_of(body)
            if place is not None:
                resting[body.lead_row] = place
        return replace(helpers.forces.run_state(), resting=tuple(resting.items()),
                       split_impulse_end=helpers.settling.split_impulse_end,
                       stopped=tuple(body.lead_row for body in helpers.divergence.stopped))

    def _set_run_state(self, command: SetRunState) -> None:
        state = command.state
        self._helpers.forces.resume(state)
        self._helpers.settling.resume_split_impulses(state.split_impulse_end)
        self._helpers.divergence.stop(self._rows[row][0] for row in state.stopped)
        self._helpers.restored_sleep.put(
            (self._rows[row][0], place) for row, place in state.resting)
