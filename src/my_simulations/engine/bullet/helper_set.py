"""Create and connect the helpers of a world: step helpers, and stores of body data."""
from __future__ import annotations

from functools import partial
from typing import Callable, Dict, List, Tuple

import pybullet

from ...description.model import Model
from ..commands import PhysicsSettings
from . import bodies, extra_surfaces, joint_axes
from .bodies import Body, Part
from .body_events import BodyEvent
from .carried_weight import CarriedWeight
from .commanded_motion import PinnedBodies, PlanarMotion
from .contact_settling import ContactSettling
from .divergence_stop import DivergenceStop
from .forces import Forces
from .gear_accuracy import GearAccuracy
from .gyroscopic_rigid import GyroscopicRigid
from .impact_watch import ImpactWatch
from .joint_constraints import ConstraintBook, InterModelJoints
from .joint_motors import JointMotors
from .joint_wrenches import JointKey, JointWrenches
from .notices import Notices
from .pair_coefficients import FrictionBalance, PairRestitution
from .residual_friction import ResidualFriction
from .rest import RestoredSleep
from .rolling_contacts import RollingContacts
from .row_reader import RowReader
from .seams import LevelSeams, TriangleSeams
from .state_readout import StateReadout
from .state_restore import Entry
from .state_setter import StateSetter
from .step_helper import StepLoop
from .velocity_decay import VelocityDecay
from .wake_up import WakeUp
from .wheel_friction import WheelFriction
from .world_parameters import WorldParameters


class HelperSet:
    """The helpers of a world; bodies added here are registered with each helper.

    Attributes:
        settings: the settings in use, see `configure`.
        loop: makes the steps and calls the helpers before and after them.
        notices: events for users about bodies.
        readout: the tables of states.
        row_reader: reads current values of single rows of these tables.
        waker: wakes the bodies that a command affects.
        mover: sets poses and velocities of models, links and joints.
        book: the constraints of joints.
        forces, motors, planar, pinned, wheel_friction, ties, wrenches: targets of commands.
        settling, divergence, restored_sleep: store parts of the run state (`RunState`).

    Args:
        models: by id.
        bodies_by_uid: of all models.
        rows: link rows to bodies and their parts.
        axes: joint rows to bodies and their axes.
    """

    def __init__(self, models: Dict[int, Entry], bodies_by_uid: Dict[int, Body],
                 rows: Dict[int, Tuple[Body, Part]],
                 axes: Dict[int, Tuple[Body, bodies.Axis]]) -> None:
        self.settings = PhysicsSettings()
        self._models, self._bodies, self._axes = models, bodies_by_uid, axes
        self.notices = Notices(models, bodies_by_uid)
        self.readout = StateReadout(self._on_diverged, self._on_fastest_rate)
        self.row_reader = RowReader(self.readout, rows, axes)
        self.waker = WakeUp(bodies_by_uid, self._on_activated)
        self.mover = StateSetter(rows, axes, self.readout, self.row_reader, self.waker,
                                 self._notify)
        self._measured_joints: Dict[JointKey, int] = {}
        self._create()

    def _create(self) -> None:
        """Create the helpers whose data concern bodies only; a clear of the world discards them."""
        self._parameters = WorldParameters()
        self._residual = ResidualFriction(lambda uid: self._rolling.rolls(uid))
        self._impacts = ImpactWatch(
            lambda uid, other, normal: self._rolling.landed(uid, other, normal), self._parameters)
        self._rolling = RollingContacts(self._impacts.flies, lambda: self.forces.loaded_bodies,
                                        self._parameters.find_pairs, self._holding)
        self._triangle_seams = TriangleSeams(self._rolling, self._parameters)
        self._level_seams = LevelSeams(lambda: self._residual.fast, self._parameters)
        self.wheel_friction = WheelFriction(
            self._holding, lambda row: self.motors.rate_of(row),
            lambda row, step: self.forces.effort_on(row, step))
        self.forces = Forces(self._waker_for(BodyEvent.FORCE_APPLIED),
                             lambda rows: self.motors.disable_for_loops(rows),
                             lambda body, axis: self.motors.restore(body, [axis]),
                             lambda row: self.motors.motor_of(row),
                             self.row_reader.read_links, self.row_reader.read_axes)
        self._friction = FrictionBalance(self.notices.misfit)
        self._restitution = PairRestitution(self._parameters, self.notices.misfit)
        self._gyroscopic = GyroscopicRigid(lambda: self.forces.wrenched_links)
        self.pinned = PinnedBodies(self.waker.around)
        self.book = ConstraintBook()
        self._gears = GearAccuracy(self.book, self._parameters)
        self.ties = InterModelJoints(self.book)
        self._carried_weight = CarriedWeight(lambda: self.ties.carried)
        self._decay = VelocityDecay()
        self.settling = ContactSettling(
            self._parameters, lambda: self.forces.loaded_bodies,
            lambda row: self.motors.rate_of(row) or self.forces.servos.rate_of(row),
            self._notify)
        self.restored_sleep = RestoredSleep(self.settling.hold)
        self.divergence = DivergenceStop(self.notices.stopped, lambda: self.forces.loaded_bodies,
                                         self.readout.mark_changed)
        self.motors = JointMotors(self._axes,
                                  partial(self._notify, BodyEvent.MOTOR_TARGET_CHANGED))
        self.planar = PlanarMotion(self._models, self.mover.present_model_pose,
                                   self._waker_for(BodyEvent.PLANAR_VELOCITY_CHANGED))
        self.wrenches = JointWrenches(self._models, self.forces, self.wheel_friction,
                                      self._measured_joints)
        # The step helpers, in the order in which they act.
        helpers = (
            self._friction,         # before: stores friction coefficients for pairs in contact
            self._restitution,      # before: stores restitutions for pairs that can collide
            self.settling,          # before: holds robots at rest, chooses the solver's accuracy
            self._gears,            # before: requests accuracy for gears that yield
            self._decay,            # before: reduces velocities (velocity_decay of SDFormat)
            self.forces,            # before: applies forces and efforts
            self._carried_weight,   # before: turns the weight of tied bodies into a velocity
            self.planar,            # before: sets velocities of models in the plane
            self._gyroscopic,       # after: corrects the attitude of bodies that tumble freely
            self._residual,         # after: removes friction of contacts without load
            self.wheel_friction,    # before: applies the friction of sliding wheels
            self.pinned,            # after: puts bodies that users drag back to their poses
            self._impacts,          # before: prepares impacts and landings
            self._rolling,          # before: drops old contact points of lying cylinders
            self._level_seams,      # after: removes pushes at seams between level floors
            self._triangle_seams,   # before: compensates forces at seams between triangles
            self.divergence,        # after: keeps models in place that were too fast or too far
            self.restored_sleep)    # before: puts bodies of a restored world to sleep
        self.loop = StepLoop(helpers, pybullet.stepSimulation, self._parameters.apply)
        self._observers = (*helpers, self.ties, self.motors, self.wrenches, self.readout, self.loop)
        self._handlers = {event: tuple(observer.handle_event for observer in self._observers
                                       if event in observer.events) for event in BodyEvent}

    def _waker_for(self, event: BodyEvent) -> Callable[[List[Body]], None]:
        """Return a function that wakes bodies and their contact islands, and sends them `event`."""
        return WakeUp(self._bodies, partial(self._notify, event)).around

    def configure(self, settings: PhysicsSettings) -> None:
        """Use these settings from the next step on, and have Bullet use them."""
        self.settings = settings
        self._parameters.configure(settings)
        self._decay.configure(settings.step_size)
        self._rolling.configure(settings.cone)
        self.wheel_friction.configure(settings.cone)
        self.divergence.configure(settings.step_size)

    def add(self, body: Body, model: Model) -> None:
        extra_surfaces.store(body, self.settings.step_size)
        for observer in self._observers:
            observer.add(body)
        self.set_up_axes(body, model)

    def set_up_axes(self, body: Body, model: Model) -> None:
        """Apply the limits, friction, springs and motors of a model to the axes of a body."""
        dt = self.settings.step_size
        joint_axes.set_up(body, model, self.forces, dt)
        self.motors.set_up(body, model)
        self.forces.servos.set_up(body, model, dt)

    def use_step_size(self, body: Body, model: Model) -> None:
        """Recompute all values of a body that depend on the step size."""
        self.set_up_axes(body, model)
        self._decay.add(body)

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body."""
        for observer in self._observers:
            observer.forget(body)

    def clear(self) -> None:
        """Discard the data of all bodies; `configure` must follow."""
        self.notices.forget_all()
        self.readout.clear()
        self._create()

    def _holding(self, row: int) -> float:
        """Return the effort, N m or N, with which the motor or brake of a joint row acts."""
        return max(self.motors.effort_of(row), self.forces.servos.motor_effort_of(row))

    def _notify(self, event: BodyEvent, body: Body) -> None:
        """Pass an event to those that handle it, in the order of the helpers."""
        for handle in self._handlers[event]:
            handle(event, body)

    def _on_activated(self, body: Body) -> None:
        self.notices.forget(body.model_id)
        self._notify(BodyEvent.ACTIVATED, body)

    def _on_diverged(self, body: Body) -> None:
        self.loop.invalidate_due_steps()
        self.mover.put_back(body)
        self.notices.diverged(body)

    def _on_fastest_rate(self, body: Body) -> None:
        self.notices.reached_fastest_rate(body, self.settings.step_size)
