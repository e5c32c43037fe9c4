"""PyBullet as a backend: models by number, commands, steps."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Callable, Dict, Iterable, List, Optional, Tuple, Type

import pybullet

from ...description.model import Model
from ...geometry import Pose, pose_is_finite
from ..api import CommandRefusedError, EngineBrokenError, Event
from ..body_plan import BodyPlanError, open_joints
from ..commands import (
    Clear,
    Command,
    ConnectModels,
    DisconnectModels,
    LoadModel,
    ModelState,
    PhysicsSettings,
    PinModels,
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
from ..timed_forces import AddTimedForces, ClearTimedForces
from . import bodies, extra_surfaces, joint_axes
from .bodies import Body, Part
from .body_builder import Builder
from .closing_joints import closing_joints
from .collision_shapes import ShapeError, ShapeFactory
from .constraint_book import ConstraintBook
from .contact_readout import read_contacts
from .contact_settling import ContactSettling
from .force_dependent_slip import slips
from .forces import Forces
from .gyroscopic_rigid import GyroscopicRigid
from .initial_state_cache import InitialStateCache, Start
from .inter_model_joints import InterModelJoints
from .joint_constraints import Constraints
from .joint_motors import JointMotors
from .joint_wrenches import JointWrenches
from .landing_contacts import LandingContacts
from .level_seams import LevelSeams
from .notices import Notices
from .pair_friction import FrictionBalance
from .pair_restitution import PairRestitution
from .pinned_bodies import PinnedBodies
from .planar_motion import PlanarMotion
from .residual_friction import ResidualFriction
from .rolling_contacts import RollingContacts
from .seam_contacts import SeamContacts
from .sliding import Sliding
from .solver_settings import configure_solver
from .state_readout import StateReadout
from .state_restore import Entry, inherited, restore
from .state_setter import StateSetter
from .step_helper import StepLoop
from .surface_stop import SurfaceStop
from .velocity_decay import VelocityDecay
from .wake_up import WakeUp


class BulletBackend:
    """One PyBullet world; there may be one in a process (module-wide client 0)."""

    def __init__(self) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._settings = PhysicsSettings()
        self._shapes = ShapeFactory()
        self._models: Dict[int, Entry] = {}
        self._bodies: Dict[int, Body] = {}
        self._rows: Dict[int, Tuple[Body, Part]] = {}
        self._axes: Dict[int, Tuple[Body, bodies.Axis]] = {}
        self._notices = Notices(self._models, self._bodies)
        self._readout = StateReadout(self._on_diverged, self._on_raced)
        self._residual = ResidualFriction()
        self._rolling = RollingContacts(lambda links, step: self._landing.see_rolling(links, step),
                                        lambda: self._forces.loaded_bodies)
        self._seams = SeamContacts(self._rolling)
        self._level = LevelSeams(lambda: self._residual.fast)
        self._sliding = Sliding()
        self._waker = WakeUp(self._bodies, self._touched)
        driver = WakeUp(self._bodies, self._driven)
        self._forces = Forces(driver.around, lambda rows: self._motors.yield_to(rows),
                              lambda body, axis: self._motors.restore(body, axis))
        self._friction = FrictionBalance(self._notices.misfit)
        self._bounces = PairRestitution(self._notices.odd_bounce)
        self._spin = GyroscopicRigid(lambda: self._forces.wrenched_links)
        self._holds = PinnedBodies(self._waker.around)
        self._book = ConstraintBook()
        self._ties = InterModelJoints(self._book)
        self._decay = VelocityDecay()
        self._settling = ContactSettling(
            lambda: self._forces.loaded_bodies,
            lambda row: self._motors.rate_of(row) or self._forces.servos.rate_of(row),
            self._on_held)
        self._landing = LandingContacts(self._rolling.landed, self._settling.solve_impact)
        self._stop = SurfaceStop()
        self._mover = StateSetter(self._rows, self._axes, self._readout, self._waker,
                                  self._forces, self._spin, self._holds)
        self._motors = JointMotors(self._axes, driver.around)
        self._planar = PlanarMotion(self._models, self._mover.model_pose, driver.around)
        self._wrenches = JointWrenches(self._models, self._forces, self._sliding)
        # What acts around the steps, in the order in which it does.
        helpers = (self._friction, self._bounces, self._settling, self._decay, self._forces,
                   self._planar, self._rolling, self._spin, self._residual, self._sliding,
                   self._holds, self._stop, self._landing, self._level, self._seams)
        self._loop = StepLoop(helpers, pybullet.stepSimulation)
        # Everything that remembers bodies one by one.
        self._keepers = (*helpers, self._ties, self._motors, self._wrenches,
                         self._readout, self._loop)
        # Whom it concerns that a command, or a force that begins, reaches a body.
        self._hearers = tuple(part.touched for part in (
            self._loop, self._friction, self._settling, self._residual, self._rolling,
            self._sliding, self._stop, self._landing, self._seams))
        self._starts = InitialStateCache(self._readout)
        self._put_off: Optional[List[Start]] = None
        self._is_fresh = True   # nothing has moved since the world began
        self._appliers: Dict[Type[Command], Callable[[Any], object]] = {
            LoadModel: self._load, RemoveModel: self._remove, Clear: self._clear,
            Restart: self._restart,
            SetModelState: self._set_model, SetLinkState: self._set_link,
            SetJoints: self._set_joints,
            SetAxes: self._set_axes, PinModels: self._hold,
            ConnectModels: self._connect,
            DisconnectModels: self._disconnect,
            SetMotors: lambda command: self._motors.set(command.motors),
            SetPlanarVelocities: lambda command: self._planar.set(command.velocities),
            ReadContacts: lambda command: read_contacts(
                self._bodies, command.limit, self._sliding.load, self._sliding.friction,
                self._forces.slip.friction),
            SetWheelSlips: self._set_wheel_slips,
            ReadJointWrenches: self._wrenches.read,
            SetServos: lambda command: self._forces.servos.set(
                command.servos, self._settings.step_size),
            ReadEfforts: lambda command: self._forces.servos.efforts(command.rows),
            AddTimedForces: self._add_timed_forces,
            ClearTimedForces: self._clear_timed_forces,
        }
        self._configure_bullet()

    # -- Backend ---------------------------------------------------------------------------------

    def apply(self, command: Command) -> object:
        """Carry out a command; raises `CommandRefusedError`."""
        if not isinstance(command, (Restart, Clear)):
            self._settle()
        self._loop.changed()
        return self._appliers[type(command)](command)

    def configure(self, settings: PhysicsSettings) -> None:
        """Use other settings from the next step on; a changed gravity wakes everything."""
        self._settle()
        self._loop.changed()
        before, self._settings = self._settings, settings
        if settings.gravity != before.gravity:
            self._waker.everything()  # first: Bullet tells only awake bodies of a new gravity
        self._configure_bullet()
        if settings.step_size != before.step_size:
            for entry in self._models.values():
                for body in entry.bodies:
                    self._set_up_axes(body, entry.model)
                    self._decay.add(body, settings.step_size)

    def step(self, first: int, count: int) -> None:
        """Make `count` steps."""
        self._settle()
        self._is_fresh = False
        self._readout.stepped()
        run, dt, gravity = self._loop.run, self._settings.step_size, self._settings.gravity
        if self._wrenches.idle:
            run(first, count, dt, gravity)
            return
        if count > 1:
            run(first, count - 1, dt, gravity)
        self._loop.changed()
        self._wrenches.before(count)
        run(first + count - 1, 1, dt, gravity)
        self._wrenches.after(dt, gravity)
        self._loop.changed()

    def read(self) -> bool:
        """Bring the tables up to date."""
        return self._put_off is not None or self._readout.read()

    def read_poses(self) -> bool:
        """Bring the poses in the link table up to date."""
        return self._put_off is not None or self._readout.read_poses()

    def tables(self) -> Tuple[memoryview, memoryview]:
        """The used rows."""
        return self._readout.tables()

    def events(self) -> List[Event]:
        """What has happened since the last call."""
        return self._notices.taken()

    def close(self) -> None:
        """Disconnect and remove scratch files."""
        pybullet.disconnect(self._client)
        self._shapes.close()

    # -- settings --------------------------------------------------------------------------------

    def _configure_bullet(self) -> None:
        settings = self._settings
        configure_solver(settings)
        self._settling.configure(settings.iterations, settings.step_size)
        self._sliding.configure(settings.cone)

    # -- models ----------------------------------------------------------------------------------

    def _load(self, command: LoadModel) -> None:
        self._check_load(command)
        try:
            builder = Builder(command, self._shapes)
        except (BodyPlanError, ShapeError) as fault:
            raise CommandRefusedError(str(fault)) from fault
        entry = self._enter(builder, command.model, command.pose)
        state = self._inherited(command) if command.inherit else command.state
        if state is not None:
            restore(entry, state)
        # In a fresh world all is awake. Looking for neighbours changes the order in which Bullet
        # finds contacts, and with it what follows: a restart, which need not look, must repeat it.
        if not self._is_fresh:
            self._waker.around(entry.bodies)

    def _enter(self, builder: Builder, model: Model, pose: Pose) -> Entry:
        """Build a model and know it."""
        dt, first_row = self._settings.step_size, builder.link_rows.start
        try:
            built = builder.build(pose)
        except ShapeError as fault:
            raise CommandRefusedError(str(fault)) from fault
        constraints = Constraints(self._book, model, builder.plans, built, pose,
                                  open_joints(model, builder.plans), first_row)
        entry = Entry(model, builder, built, first_row, pose, constraints)
        self._models[builder.model_id] = entry
        rows = builder.joint_rows
        self._readout.add_joints(rows, closing_joints(
            list(constraints.closing), model, pose, first_row, rows.start))
        for body in built:
            self._register(body)
            self._decay.add(body, dt)
            for part in body.parts:
                self._rolling.add(body, part, part.link)
                self._level.add(body, part, part.link)
                if not slips(part.link):
                    self._sliding.add(body, part, part.link)
            for part in body.colliders:
                link = part.link
                self._landing.add(body, part, link)
                extra_surfaces.store(body, part, link, dt)
                self._forces.slip.add(body, part, link)
            self._set_up_axes(body, model)
        return entry

    def _restart(self, command: Restart) -> None:
        """Show the world as it begins at once, where that is known, and build it when it is used.

        Whoever asked need not wait for that, and several resets in a row build it once. What the
        tables show is also what another engine would begin with, should this one end on the way.
        """
        self._notices.forget_all()
        starts = [(self._entry(number), pose) for number, pose in command.models]
        if len(starts) == len(self._models) and self._starts.show(starts):
            self._put_off = starts
        else:
            self._build_again(starts)
            self._starts.keep(starts)

    def _settle(self) -> None:
        """Do what was put off."""
        if self._put_off is not None:
            self._build_again(self._put_off)

    def _build_again(self, starts: List[Start]) -> None:
        self._clear(Clear())
        try:
            for entry, pose in starts:
                self._enter(entry.builder, entry.model, pose)
        except (CommandRefusedError, pybullet.error) as fault:
            # What could be built before: files have gone.
            raise EngineBrokenError(f"the world could not be built again: {fault}") from fault

    def _inherited(self, command: LoadModel) -> ModelState:
        self._readout.read()
        before = self._entry(command.inherit)
        return inherited(before, command.model, self._mover.model_pose(before),
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
        self._loop.add(body)
        self._forces.add_body(body)
        self._friction.add(body)
        self._bounces.add(body)
        self._spin.add(body)
        self._residual.add(body)
        self._settling.add(body)
        self._stop.add(body)
        self._readout.add(body)

    def _remove(self, command: RemoveModel) -> None:
        entry = self._entry(command.model_id)
        self._waker.around(entry.bodies)
        del self._models[command.model_id]
        self._notices.forget(command.model_id)
        entry.constraints.remove()
        self._readout.forget_joints(entry.builder.joint_rows)
        for body in entry.bodies:
            for keeper in self._keepers:
                keeper.forget(body)
            for uid in body.uids:
                del self._bodies[uid]
            for part in body.parts:
                del self._rows[part.row]
            for axis in body.axes:
                del self._axes[axis.row]
        entry.builder.remove(entry.bodies)

    def _connect(self, command: ConnectModels) -> None:
        self._ties.connect(command, self._rows)
        self._waker.around([self._rows[row][0] for row in (command.child_row, command.parent_row)
                            if row >= 0])

    def _disconnect(self, command: DisconnectModels) -> None:
        self._waker.around(self._ties.disconnect(command.names))

    def _clear(self, _: Clear) -> None:
        self._put_off = None
        self._is_fresh = True
        self._models.clear()
        self._notices.forget_all()
        for keeper in self._keepers:
            keeper.clear()
        self._book.clear()
        for table in (self._bodies, self._rows, self._axes):
            table.clear()
        # Half of what a reset costs, and not to be saved: of 60 piles of 60 bodies that were taken
        # out one by one instead and built again, 10 fell otherwise; after this, none (measured).
        pybullet.resetSimulation()
        self._shapes.forget_world()
        self._configure_bullet()

    def _entry(self, model_id: int) -> Entry:
        if model_id not in self._models:
            raise CommandRefusedError("the model is not there any more")
        return self._models[model_id]

    # -- states ----------------------------------------------------------------------------------

    def _set_model(self, command: SetModelState) -> None:
        self._check(command.of)
        self._mover.set_model(command, self._entry(command.model_id))

    def _set_link(self, command: SetLinkState) -> None:
        self._check(command.of)
        self._mover.set_link(command)

    def _set_joints(self, command: SetJoints) -> None:
        self._check(command.of)
        self._mover.set_joints(command)

    def _check(self, model_ids: Iterable[int]) -> None:
        for model_id in model_ids:
            self._entry(model_id)

    def _set_axes(self, command: SetAxes) -> None:
        entry = self._entry(command.model_id)
        entry.model = replace(entry.model, joints=list(command.joints))
        self._waker.around(entry.bodies)
        for body in entry.bodies:
            self._set_up_axes(body, entry.model)

    def _set_up_axes(self, body: Body, model: Model) -> None:
        joint_axes.set_up(body, model, self._forces, self._settings.step_size)
        self._motors.set_up(body, model)
        self._forces.servos.set_up(body, model, self._settings.step_size)

    def _set_wheel_slips(self, command: SetWheelSlips) -> None:
        for wheel in command.wheels:
            if wheel.row not in self._rows or wheel.joint_row not in self._axes:
                raise CommandRefusedError("the link or joint of the wheel does not exist")
            self._sliding.leave(*self._rows[wheel.row])
        self._forces.slip.set_wheels(command.wheels)

    def _hold(self, command: PinModels) -> None:
        self._holds.set(body for number in command.model_ids
                        for body in self._entry(number).bodies)

    # -- timed forces and events -----------------------------------------------------------------

    def _add_timed_forces(self, command: AddTimedForces) -> None:
        refusal = self._forces.add(command.forces)
        if refusal:
            raise CommandRefusedError(refusal)

    def _clear_timed_forces(self, command: ClearTimedForces) -> None:
        self._forces.drop(command.force_ids)

    def _touched(self, body: Body) -> None:
        """A command reached a body: it may be elsewhere."""
        self._notices.forget(body.model_id)
        self._readout.touch(body)
        self._tell(body)

    def _driven(self, body: Body) -> None:
        """A force or a motor acts on a body from the next step on: it is where it was."""
        self._readout.woken(body)
        self._tell(body)

    def _tell(self, body: Body) -> None:
        for hear in self._hearers:
            hear(body)

    def _on_held(self, body: Body, held: bool) -> None:
        self._forces.rest(body, held)
        self._loop.touched(body)

    def _on_diverged(self, body: Body) -> None:
        self._loop.changed()
        self._mover.put_back(body)
        self._notices.diverged(body)

    def _on_raced(self, body: Body) -> None:
        self._notices.raced(body, self._settings.step_size)
