"""Commands of the engine: every change of the world is one of them.

Commands are applied between steps, also while paused. The simulator identifies a model by its id, a
link by its row in the ring's link table, a joint axis by its row in the joint table.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Dict, Optional, Tuple, TypeVar, Union

from ..description.model import Joint, Model, SoftLimits
from ..description.shapes import MeshData
from ..geometry import IDENTITY_QUAT, STILL, ZERO3, Pose, Quat, Twist, Vec3
from .spline import Spline

FOREVER = 1 << 62
"""A step count that is never reached: no horizon."""


@dataclass(frozen=True)
class Frame:
    """A moving reference: the link at `row`, and `offset` the wanted frame from that link."""

    row: int
    offset: Pose


@dataclass(frozen=True)
class LinkState:
    """World pose of a link frame and world-axes twist at its origin."""

    pose: Pose
    twist: Twist = STILL


@dataclass(frozen=True)
class ModelState:
    """Links in the description's order; joints (position, rate) likewise, fixed ones left out."""

    links: Tuple[LinkState, ...]
    joints: Tuple[Tuple[float, float], ...] = ()


@dataclass(frozen=True)
class PhysicsSettings:
    """`step_size` s; `gravity` m/s^2; `rate` steps a wall second, 0 = as fast as possible.

    `cone`: the friction of bodies with joints is a cone, else a pyramid along the world's axes.
    """

    step_size: float = 0.001
    gravity: Vec3 = (0.0, 0.0, -9.8)
    rate: float = 1000.0
    iterations: int = 50
    cone: bool = True


@dataclass(frozen=True)
class JointPid:
    """A PID controller of a joint axis, computed in every step (see `engine.bullet.joint_pid`).

    Attributes:
        target: rad or m, or with `rate` per second.
        rate: True to control the velocity, False for the position.
        p, i, d: gains: effort by error, by its integral over time, and by its rate.
    """

    target: float
    rate: bool = False
    p: float = 1.0
    i: float = 0.1
    d: float = 0.01


@dataclass(frozen=True)
class TimedWrench:
    """A wrench on a link, exact to the step.

    Acts in steps `start` (the first step whose beginning is at this count) to `stop` - 1.

    Attributes:
        force_id: id, to clear it.
        row: link row.
        start, stop: step counts; `stop` FOREVER for until cleared.
        force, torque: N and N m, world axes, at the centre of mass.
        in_link_axes: force, torque and point are in link axes and turn with the link.
        point: m, from the centre of mass to where the force is applied, same axes as the force.
    """

    force_id: int
    row: int
    start: int
    stop: int
    force: Vec3 = (0.0, 0.0, 0.0)
    torque: Vec3 = (0.0, 0.0, 0.0)
    in_link_axes: bool = False
    point: Vec3 = (0.0, 0.0, 0.0)

    def begun(self, step: int) -> "TimedWrench":
        """The same with its full duration from `step` on, if its start has passed."""
        return _begun(self, step)


@dataclass(frozen=True)
class TimedEffort:
    """An effort on a joint axis, exact to the step.

    Attributes:
        force_id: id, to clear it.
        row: joint row.
        start, stop: as of `TimedWrench`.
        effort: N m or N; ignored with `pid`.
        pid: computes the effort in every step.
    """

    force_id: int
    row: int
    start: int
    stop: int
    effort: float = 0.0
    pid: Optional[JointPid] = None

    def begun(self, step: int) -> "TimedEffort":
        """The same with its full duration from `step` on, if its start has passed."""
        return _begun(self, step)


TimedForce = Union[TimedWrench, TimedEffort]
_Timed = TypeVar("_Timed", TimedWrench, TimedEffort)


def _begun(force: _Timed, step: int) -> _Timed:
    late = step - force.start
    if late <= 0:
        return force
    return replace(force, start=step,
                   stop=FOREVER if force.stop == FOREVER else force.stop + late)


class Command:
    """Base of all commands; each documents the `value` of its reply (None if not documented)."""


@dataclass(frozen=True)
class LoadModel(Command):
    """Add a model to the world.

    Attributes:
        model_id: new id.
        model: flattened (no nested models).
        pose: world pose of the model frame.
        first_link_row, first_joint_row: rows of its links (in order) and of its movable joints'
            axes (in order, see `ring_rows.axis_rows`).
        meshes: meshes of its collisions, by `mesh_key`.
        state: state of its links and joints; None for the initial state at `pose`.
        articulated: build articulated bodies even without joints, as prismatic joints to other
            models require.
        inherit: id of a model whose present states are taken over by links and joints of the same
            names; poses of links in the model may differ. 0 for none.
    """

    model_id: int
    model: Model
    pose: Pose
    first_link_row: int
    first_joint_row: int
    meshes: Dict[str, MeshData] = field(default_factory=dict)
    state: Optional[ModelState] = None
    inherit: int = 0
    articulated: bool = False


@dataclass(frozen=True)
class ConnectModels(Command):
    """Connect links of two models, or a link and the world, until either model is removed.

    Attributes:
        joint: its type and axis direction are used; limits, damping and so on have no effect.
        parent_row, child_row: link rows; -1 for the world.
        parent_from_joint, child_from_joint: the joint frame in the frame of each link (world pose
            for the world); at position 0 they are the same frame.
    """

    joint: Joint
    parent_row: int
    parent_from_joint: Pose
    child_row: int
    child_from_joint: Pose


@dataclass(frozen=True)
class DisconnectModels(Command):
    """Take away the joints of these names that `ConnectModels` made; others are ignored."""

    names: Tuple[str, ...]


@dataclass(frozen=True)
class RemoveModel(Command):
    """Remove a model; bodies that rested on it wake up."""

    model_id: int


GONE = "is not there any more"
"""Ends the refusal of a command about what was removed in the meantime."""


@dataclass(frozen=True)
class SetModelState(Command):
    """Move all links of a model rigidly so that its frame has `pose`; joints keep their positions.

    A joint to the world takes the position that belongs to the pose, if there is one; else its
    anchor is moved. The canonical link gets the velocity `twist`, every other one the rigid
    body's, v + w x r. With `frame`, pose and twist are given in it (the frame's own velocity is
    not added). `twist` None keeps the velocities, rotated. `of`: ids of further models that must
    be there, as the one whose link the frame is: rows of a model that has gone may be another's.
    """

    model_id: int
    pose: Pose
    twist: Optional[Twist] = None
    frame: Optional[Frame] = None
    of: Tuple[int, ...] = ()


@dataclass(frozen=True)
class SetLinkState(Command):
    """Move one link and set its velocity.

    A link of an articulated body moves the whole body with its joint positions, because reduced
    coordinates have no poses of single links. A body with a joint to the world cannot be moved.
    `of`: ids of the models whose rows are named, as in SetModelState.
    """

    row: int
    pose: Pose
    twist: Optional[Twist] = None
    frame: Optional[Frame] = None
    of: Tuple[int, ...] = ()


@dataclass(frozen=True)
class SetJoints(Command):
    """Set positions (and rates) of joint axes by row; the links below move with them.

    `of`: ids of the models whose rows are named, as in SetModelState.
    """

    joints: Tuple[Tuple[int, float, float], ...]
    of: Tuple[int, ...] = ()


@dataclass(frozen=True)
class SetAxes(Command):
    """Replace the axes of a model's joints: limits, friction, damping, spring, motor.

    `joints` are the model's joints, in order, of unchanged names, types, ends, poses and axis
    directions.
    """

    model_id: int
    joints: Tuple[Joint, ...]


@dataclass(frozen=True)
class JointMotor:
    """A motor that drives a joint axis to a rate with a limited effort (ODE's `vel` and `fmax`).

    Attributes:
        row: joint row.
        rate: rad/s or m/s.
        effort: maximum effort, N m or N; 0 turns the motor off and restores the joint friction.
    """

    row: int
    rate: float
    effort: float


@dataclass(frozen=True)
class SetMotors(Command):
    """Set motors of some joint axes; others are unchanged. A motor replaces joint friction."""

    motors: Tuple[JointMotor, ...]


@dataclass(frozen=True)
class PidGains:
    """Gains of a loop, and the limits of its integral term; control_toolbox's parameters.

    Attributes:
        p, i, d: output by error, by its integral over time, and by its rate.
        i_min, i_max: limits of the integral term.
        antiwindup: the integral itself stays within the limits.
    """

    p: float
    i: float = 0.0
    d: float = 0.0
    i_min: float = 0.0
    i_max: float = 0.0
    antiwindup: bool = False


@dataclass(frozen=True)
class JointServo:
    """A controller of a joint axis, which the engine evaluates in every step.

    A target, or a loop about it (`gains`), commands a drive: an effort, the rate of a motor, or
    the position that a motor follows; or, with `drive_gains`, the target of a loop that gives an
    effort. Sources: ros_control's controllers, gazebo_ros_control. Units: rad or m, s, N m or N.

    Attributes:
        row: joint row.
        drive: "effort", "velocity" or "position"; "" ends the servo.
        target: a position, with `of_rate` or as the command of a velocity drive a rate, as the
            command of an effort drive an effort.
        target_rate: the rate at the target.
        spline: the target as a function of time, instead of `target`.
        gains: of the loop about the target; None passes it on.
        of_rate: that loop is about the rate, else about the position.
        by_rates: its d is about the difference of the rates, else that of errors in time.
        feedforward: what is commanded a target rate.
        drive_gains: of the loop of the drive.
        wraps: position errors are angles in -pi to pi.
        lower, upper, most_rate, most_effort: limits of commands.
        soft: soft limits.
    """

    row: int
    drive: str
    target: float = 0.0
    target_rate: float = 0.0
    spline: Optional[Spline] = None
    gains: Optional[PidGains] = None
    of_rate: bool = False
    by_rates: bool = False
    feedforward: float = 0.0
    drive_gains: Optional[PidGains] = None
    wraps: bool = False
    lower: float = -math.inf
    upper: float = math.inf
    most_rate: float = math.inf
    most_effort: float = math.inf
    soft: Optional[SoftLimits] = None

    def same_loops(self, other: "JointServo") -> bool:
        """Whether it differs in its target alone."""
        return self == replace(other, target=self.target, target_rate=self.target_rate,
                               spline=self.spline)


@dataclass(frozen=True)
class SetServos(Command):
    """Set the servos of some joint axes; those of others stay, and so do integrals of loops."""

    servos: Tuple[JointServo, ...]


@dataclass(frozen=True)
class ReadEfforts(Command):
    """Reply value: what servos and motors spent in the last step, N m or N, by joint row."""

    rows: Tuple[int, ...]


@dataclass(frozen=True)
class WheelSlip:
    """A wheel that slips in proportion to its speed (Gazebo's WheelSlipPlugin).

    Its slips (see `Surface.slip1`) are `radius` times the rate of its joint, by the normal force,
    times a compliance: worked out anew in every step.

    Attributes:
        row: link row of the wheel.
        joint_row: row of the joint axis that it turns about.
        radius: m.
        normal_force: N, about what the wheel carries.
        lateral, longitudinal: compliances along the first direction of friction (the axle, by the
            plugin's convention) and across it, no unit.
    """

    row: int
    joint_row: int
    radius: float
    normal_force: float
    lateral: float = 0.0
    longitudinal: float = 0.0


@dataclass(frozen=True)
class SetWheelSlips(Command):
    """Let wheels slip from now on, until their models are removed; those of others stay."""

    wheels: Tuple[WheelSlip, ...]


@dataclass(frozen=True)
class PlanarVelocity:
    """A velocity that is set before every step, in the heading of the model frame.

    Attributes:
        model_id: the model.
        x, y: m/s, along the model frame's x and y axis, level; the vertical velocity is 0.
        yaw_rate: rad/s, about the vertical.
    """

    model_id: int
    x: float
    y: float
    yaw_rate: float


@dataclass(frozen=True)
class SetPlanarVelocities(Command):
    """Set the planar velocities of models, regardless of forces; replaces all earlier ones."""

    velocities: Tuple[PlanarVelocity, ...]


@dataclass(frozen=True)
class PinModels(Command):
    """Pin models: they stay at rest regardless of forces; `SetModelState` moves them.

    Replaces all earlier ones; released models wake up.
    """

    model_ids: Tuple[int, ...]


@dataclass(frozen=True)
class ReadContacts(Command):
    """The contacts of the last step. Reply value: a tuple of at most `limit` `Contact`s."""

    limit: int = 2000


@dataclass(frozen=True)
class Contact:
    """One point of contact of the links at two rows.

    Attributes:
        row_a, row_b: link rows.
        position: m, world axes, on b.
        normal: unit vector from b to a, world axes.
        depth: m, how far they overlap; negative where they press each other
            across a gap.
        force: N, along the normal, on a.
        friction: N, across the normal, on a, world axes.
    """

    row_a: int
    row_b: int
    position: Vec3
    normal: Vec3
    depth: float
    force: float
    friction: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class ReadJointWrenches(Command):
    """What joints transmitted in the last step.

    A joint is measured from the step after its first reading on, until nobody has read it for
    `joint_wrenches.FORGOTTEN` steps: whoever wants every value asks once in advance.

    Reply value: a tuple with a `JointWrench` for each joint; None for one that was not measured in
    the last step (read for the first time, or since then everything began anew) or is not there.

    Attributes:
        joints: numbers of models and names of joints, fixed ones too.
    """

    joints: Tuple[Tuple[int, str], ...]


@dataclass(frozen=True)
class JointWrench:
    """What the parent link exerted on the child link through a joint, the mean over one step.

    It holds all that passes through the joint: what keeps the links together, and the efforts of
    motors, springs, dampers, friction and stops.

    Attributes:
        force: N, in the axes of the child link.
        torque: N m, about the joint's origin, in the axes of the child link.
        parent_from_child: how the child link is turned in the parent's axes; none for a joint to
            the world.
    """

    force: Vec3 = ZERO3
    torque: Vec3 = ZERO3
    parent_from_child: Quat = IDENTITY_QUAT


@dataclass(frozen=True)
class Clear(Command):
    """Remove all models, timed forces and contacts. Settings and clock are kept.

    Models loaded afterwards behave bit for bit as in a new engine.
    """


@dataclass(frozen=True)
class Restart(Command):
    """`Clear`, then add these models again in their initial state, in this order.

    Faster than loading each model: nothing is read or computed again, and an engine that has cached
    the initial state may reply before the world is built.

    Attributes:
        models: ids and world poses of the model frames. Other models are not added.
    """

    models: Tuple[Tuple[int, Pose], ...]


@dataclass(frozen=True)
class Batch(Command):
    """Commands applied in the same gap between steps, in order.

    The first rejected command ends the batch: earlier ones stay applied, and the reply has its
    error. Reply value: the list of their values.
    """

    commands: Tuple[Command, ...]


@dataclass(frozen=True)
class SetPhysics(Command):
    """Replace the settings; a change of gravity wakes all bodies."""

    settings: PhysicsSettings


@dataclass(frozen=True)
class SetClock(Command):
    """Set the step count and the sim time (ns)."""

    step: int
    sim_ns: int


@dataclass(frozen=True)
class Pause(Command):
    """Stop after the running step. Reply value: the step count."""


@dataclass(frozen=True)
class Run(Command):
    """Step until the horizon (a step count; FOREVER for no end). Reply value: the step count."""

    horizon: int = FOREVER


@dataclass(frozen=True)
class Advance(Command):
    """Execute `steps` steps as fast as possible, also while paused, then reply."""

    steps: int


@dataclass(frozen=True)
class EndAdvance(Command):
    """End an `Advance` that is under way after its running step; it is answered as if done."""


@dataclass(frozen=True)
class AddTimedForces(Command):
    """Add timed wrenches and efforts; those on one link or axis add up.

    With `whole`, an entry whose start has passed begins with the next step and keeps its duration.
    """

    forces: Tuple[TimedForce, ...]
    whole: bool = False


@dataclass(frozen=True)
class ClearTimedForces(Command):
    """Clear timed wrenches and efforts by id; ids that have expired are ignored."""

    force_ids: Tuple[int, ...]


@dataclass(frozen=True)
class Nudge(Command):
    """Check the credits again; has no reply."""


@dataclass(frozen=True)
class Ping(Command):
    """Does nothing; its reply shows that all earlier commands are done."""
