"""Commands of the engine: every change of the world is one of them.

Commands are applied between steps, also while paused. The simulator identifies a model by its id, a
link by its row in the ring's link table, a joint axis by its row in the joint table. Those that
drive joints are in `drive_commands`, those of forces with a duration in `timed_forces`.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Optional, Tuple

from ..description.model import Joint, Model
from ..description.shapes import MeshData
from ..geometry import IDENTITY_QUAT, STILL, ZERO3, Pose, Quat, Twist, Vec3

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
class PrepareModel(Command):
    """Begin to make the shapes of a static model that will be loaded; the world does not change.

    Reply value: whether there is more to do, with `ContinuePreparation`. Each of both takes a
    fraction of a second, and steps are made between them.

    Attributes:
        number: new id, for `ContinuePreparation`.
        model: as in `LoadModel`.
        meshes: as in `LoadModel`.
    """

    number: int
    model: Model
    meshes: Dict[str, MeshData]


@dataclass(frozen=True)
class ContinuePreparation(Command):
    """Make further shapes. Reply value: whether there is more to do; False if `number` is unknown.

    The number is unknown to an engine that was started after `PrepareModel`.
    """

    number: int


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

    def plain(self) -> Tuple[object, ...]:
        """The attributes as tuples of numbers, which are pickled in a tenth of the time."""
        return (self.model_id, tuple(self.pose), self.twist and tuple(self.twist),
                self.frame and (self.frame.row, tuple(self.frame.offset)), self.of)

    @classmethod
    def of_plain(cls, values: Tuple[Any, ...]) -> SetModelState:
        """The command whose attributes `plain` returned."""
        model_id, pose, twist, frame, of = values
        return cls(model_id, Pose(*pose), twist and Twist(*twist),
                   frame and Frame(frame[0], Pose(*frame[1])), of)


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
class PinModels(Command):
    """Pin models: they stay at rest regardless of forces; `SetModelState` moves them.

    Replaces all earlier ones; released models wake up.
    """

    model_ids: Tuple[int, ...]


@dataclass(frozen=True)
class ReadContacts(Command):
    """The contacts of the last step. Reply value: a tuple of at most 2000 `Contact`s."""


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

    A joint is measured from the step after its first reading on, until it was not read for
    `joint_wrenches.MEASURED_STEPS` steps. To get every value, read it once in advance.

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
        states: for each of these models the state in which it begins; empty for the initial ones.
    """

    models: Tuple[Tuple[int, Pose], ...]
    states: Tuple[ModelState, ...] = ()


@dataclass(frozen=True)
class Batch(Command):
    """Commands applied in the same gap between steps, in order: all of them or none.

    The first rejected command ends the batch, and the reply has its error. If earlier ones were
    applied, the engine is replaced by one with the world before the batch (`Reply.is_partial`).
    Reply value: the list of their values.
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
class Synchronize(Command):
    """Wait for a new step budget before the next step, because the world was put elsewhere."""


@dataclass(frozen=True)
class SetStepBudget(Command):
    """Replace the step budget of the ring by `word`; see `ring.budget_word`. It has no reply."""

    word: int


@dataclass(frozen=True)
class Post(Command):
    """Apply a command without a reply; a rejection is reported by the event `refused`."""

    command: Command


@dataclass(frozen=True)
class Ping(Command):
    """Does nothing; its reply shows that all earlier commands are done."""
