"""Describe PyBullet bodies, and set their dynamics, poses and velocities.

PyBullet uses frames at centres of mass, along the principal axes; the description uses link frames.
`Part.link_from_com` converts between them.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Set, Tuple, Union

import pybullet

from ...description.model import JointAxis, Link, Model
from ...geometry import (
    IDENTITY,
    ZERO3,
    Pose,
    Quat,
    Twist,
    Vec3,
    compose,
    rotate,
    twist_at,
)
from ..body_plan import BASE
from . import surface_coefficients
from .collision_shapes import Recipe

SLEEP_THRESHOLD = 0.01
"""Bodies slower than about 0.1 m/s (measured) for 2 s of sim time may sleep, as Gazebo's."""

_CCD_HALF_EXTENT = 0.025  # m: thicker bodies do not pass a wall of 1 cm in 1 ms, even at 40 m/s
_CCD_RADIUS = 0.25   # of the half extent: balls of 5 mm bounce wrong with 0.8 (measured)

FASTEST_RATE = 1e6
"""Largest joint rate, rad/s or m/s; PyBullet clamps faster ones, by default at 100."""


@dataclass
class Part:
    """One link of a body, or a piece of it with a surface of its own.

    Attributes:
        row: in the link table of the ring.
        index: PyBullet's link index.
        link_from_com: the centre of mass and the principal axes in the link frame.
        mass: kg.
        moments: of inertia about the principal axes, kg m^2.
        mu: the friction coefficient of the file.
        friction: the coefficient to store in PyBullet (`surface_coefficients`).
        link: its description, with the collisions that it carries (see `surface_pieces`).
    """

    row: int
    index: int
    link_from_com: Pose
    mass: float
    moments: Vec3
    mu: float
    friction: float
    link: Link = field(default_factory=lambda: Link(""))

    def com_pose(self, link_pose: Pose) -> Pose:
        """Return the world pose of the centre of mass for that of the link frame."""
        return compose(link_pose, self.link_from_com)


@dataclass
class Axis:
    """One joint axis of a body.

    Attributes:
        row: in the joint table of the ring.
        index: PyBullet's joint index.
        name: of its joint in the model.
        number: which of its joint's axes it is.
        mobility: at joint positions 0, other joints free, 1/kg or 1/(kg m^2).
        lower, upper: its limits, rad or m.
        follower: for a screw, PyBullet's index of its other axis, and the motion of that per
            motion of this one.
    """

    row: int
    index: int
    name: str
    number: int = 0
    mobility: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf
    follower: Optional[Tuple[int, float]] = None


@dataclass
class BallJoint:
    """One ball joint: PyBullet's index and the links it connects (`parent` None: a fixed base).

    Bullet's joint quaternion is zero * a: `a` turns the child's principal axes into the parent's
    (the base's own for a fixed one), `zero` undoes it in the configuration of the file.
    """

    index: int
    child: Part
    parent: Optional[Part]
    zero: Quat


@dataclass
class Body:
    """One PyBullet body, or several static ones that represent one link.

    Attributes:
        uid: PyBullet's number; `more` those of further static pieces.
        carriers: for a body of static pieces, the part of each with its collisions.
        ball_joints: they have no rows.
        parts: its links; `base` is the part whose index is BASE, None for a fixed base.
        moves: False for static and kinematic ones.
        rigid: whether it has no joints and uses Bullet's solver for rigid bodies.
        may_sleep: whether the description allows it to sleep.
        is_sphere: its only collision is a sphere.
        uses_ccd: so thin that Bullet detects its collisions continuously, along its path (CCD).
        lead_row: of its first part.
        radius: of a sphere about the centre of mass that contains a rigid body, m.
        still_readouts: consecutive read-outs, with steps before them, that found it at rest.
        last_position: of its centre of mass at the last read-out, m; split impulses move a body
            without velocity.
        ties: how many joints connect it with other models.
        force_count: how many timed forces and planar velocities act on it now.
        angular_velocity_kept: share that Bullet's damping leaves of it in a step.
        shapes: its collision shapes, by PyBullet's numbers.
        pieces: of its links, with rows, centres of mass and axes of those (`surface_pieces`).
    """

    uid: int
    model_id: int
    parts: List[Part]
    axes: List[Axis] = field(default_factory=list)
    more: Tuple[int, ...] = ()
    carriers: Tuple[Part, ...] = ()
    ball_joints: Tuple[BallJoint, ...] = ()
    moves: bool = True
    rigid: bool = True
    is_sphere: bool = False
    uses_ccd: bool = False
    may_sleep: bool = True
    radius: float = 0.0
    still_readouts: int = 0
    last_position: Optional[Vec3] = None
    ties: int = 0
    force_count: int = 0
    angular_velocity_kept: float = 1.0
    shapes: Tuple[Tuple[Recipe, int], ...] = ()
    pieces: Tuple[Part, ...] = ()
    lead_row: int = field(init=False)

    def __post_init__(self) -> None:
        self.lead_row = self.parts[0].row

    @property
    def uids(self) -> Tuple[int, ...]:
        """PyBullet's numbers of all its bodies."""
        return (self.uid,) + self.more

    def with_role(self, role: str) -> Set[int]:
        """Return PyBullet's numbers of those whose shapes have a role (`Recipe.role`)."""
        return {uid for uid, (recipe, _) in zip(self.uids, self.shapes) if recipe.role == role}

    @property
    def colliders(self) -> Tuple[Part, ...]:
        """Its links and their pieces: all that can touch something."""
        return (*self.parts, *self.pieces)

    @property
    def surfaces(self) -> Tuple[Tuple[int, Part], ...]:
        """All that can touch something, each with PyBullet's number of its body."""
        if self.carriers:
            return tuple(zip(self.uids, self.carriers))
        return tuple((self.uid, part) for part in self.colliders)

    @property
    def keys(self) -> Tuple[Union[int, Tuple[int, int]], ...]:
        """PyBullet's numbers of its bodies, and of its bodies with their links and pieces."""
        return (*self.uids, *((uid, part.index) for uid, part in self.surfaces))

    @property
    def owners(self) -> Dict[int, int]:
        """Of each piece, by PyBullet's index, the index of the link it belongs to."""
        indices = {part.row: part.index for part in self.parts}
        return {piece.index: indices[piece.row] for piece in self.pieces}

    @property
    def sleeps(self) -> bool:
        """Whether Bullet may let it sleep now: no joint ties it, no timed force acts on it."""
        return (self.rigid and self.moves and self.may_sleep
                and not self.ties and not self.force_count)

    @property
    def base(self) -> Optional[Part]:
        """The link that is PyBullet's base; None for a fixed base."""
        return self.parts[0] if self.parts[0].index == BASE else None


def set_dynamics(uid: int, part: Part, may_sleep: bool) -> None:
    """Set inertia, friction and restitution of a link as described, without Bullet's damping."""
    # One call each: some settings make PyBullet apply all of a call to the base (measured, 3.2.7:
    # with maxJointVelocity, the mass of a link became that of the base and freed a fixed one).
    def change(**settings: object) -> None:
        pybullet.changeDynamics(uid, part.index, **settings)

    if part.mass > 0.0:
        change(mass=part.mass, localInertiaDiagonal=part.moments)
    change(
        lateralFriction=part.friction,
        spinningFriction=0.0,
        rollingFriction=0.0,
        restitution=surface_coefficients.restitution(surface_coefficients.of_link(part.link)),
    )
    change(contactProcessingThreshold=0.0)
    change(linearDamping=0.0, angularDamping=0.0)
    if part.index != BASE:
        change(maxJointVelocity=FASTEST_RATE)
    if part.mass > 0.0 and may_sleep:
        change(activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
               sleepThreshold=SLEEP_THRESHOLD)
    elif part.mass > 0.0:
        change(activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)


def set_sleep(body: Body) -> None:
    """Allow or forbid a rigid body to sleep, after a change of its ties or loads.

    Bullet ignores forces on a sleeping body (measured), and slowly accelerated bodies can sleep.
    """
    if body.rigid and body.moves and body.may_sleep:
        pybullet.changeDynamics(
            body.uid, BASE, sleepThreshold=SLEEP_THRESHOLD,
            activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING if body.sleeps
            else pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)


def mark_asleep(uid: int) -> None:
    """Mark a rigid static body as asleep, as Bullet does; PyBullet's settings have woken it.

    Otherwise each step processes its pairs with sleeping bodies: a world of 100 sleeping boxes
    then takes 87 us per step instead of 13.
    """
    pybullet.changeDynamics(uid, BASE, activationState=pybullet.ACTIVATION_STATE_SLEEP)


def set_pose(body: Body, link_pose: Pose) -> None:
    """Set the pose of a body: its first part's link frame gets the world pose `link_pose`."""
    at = body.parts[0].com_pose(link_pose)
    pybullet.resetBasePositionAndOrientation(body.uid, at.position, at.orientation)
    for uid, (recipe, _) in zip(body.more, body.shapes[1:]):
        stand = piece_pose(at, recipe)
        pybullet.resetBasePositionAndOrientation(uid, stand.position, stand.orientation)


def specs_of(body: Body, model: Model) -> List[Tuple[Axis, JointAxis]]:
    """Return the axes of a body of `model`, each with its description."""
    specs = {joint.name: (joint.axis, joint.axis2) for joint in model.joints}
    return [(axis, specs[axis.name][axis.number] or JointAxis()) for axis in body.axes]


def axis_states(body: Body) -> Sequence[Sequence[Any]]:
    """Return the states of the joint axes of a body as PyBullet returns them."""
    indices = [axis.index for axis in body.axes]
    return pybullet.getJointStates(body.uid, indices) if indices else ()


def set_axis_state(body: Body, axis: Axis, position: float, rate: float = 0.0) -> None:
    """Set the position and rate of a joint axis, of both halves of a screw."""
    pybullet.resetJointState(body.uid, axis.index, position, rate)
    if axis.follower is not None:
        index, ratio = axis.follower
        pybullet.resetJointState(body.uid, index, ratio * position, ratio * rate)


def stop_ball_joints(body: Body) -> None:
    """Set the rates of the ball joints of a body to 0; they keep their orientations."""
    for ball in body.ball_joints:
        turn = pybullet.getJointStateMultiDof(body.uid, ball.index)[0]
        pybullet.resetJointStateMultiDof(body.uid, ball.index, turn, ZERO3)


def piece_pose(at: Pose, recipe: Recipe) -> Pose:
    """Return the pose of the body of a static piece for the pose `at` of the link's body."""
    return at if recipe.frame is IDENTITY else compose(at, recipe.frame)


def set_base_twist(body: Body, link_pose: Pose, twist: Twist) -> None:
    """Set the velocity of the base; `twist` is that of its link origin, in world axes."""
    com = twist_at(twist, rotate(link_pose.orientation, body.parts[0].link_from_com.position))
    pybullet.resetBaseVelocity(body.uid, com.linear, com.angular)


def enable_ccd(uid: int) -> bool:
    """Enable Bullet's continuous collision detection (CCD) if a rigid body is thin.

    Without CCD, a thin and fast body passes through a wall in one step. Bullet sweeps a sphere
    along the path of the centre if that is longer than 0.5 mm in a step. The sphere must be well
    inside the body, or bounces are wrong. Returns whether CCD is enabled.
    """
    low, high = pybullet.getAABB(uid, BASE)
    half = min(b - a for a, b in zip(low, high)) / 2
    if not 0.0 < half < _CCD_HALF_EXTENT:
        return False
    pybullet.changeDynamics(uid, BASE, ccdSweptSphereRadius=_CCD_RADIUS * half)
    return True


def radius_of(uid: int) -> float:
    """Return the radius of a sphere about the centre of mass that contains a body, m.

    0 for an infinite body, as a plane.
    """
    low, high = pybullet.getAABB(uid, BASE)
    if not -1e9 < low[0] <= high[0] < 1e9:
        return 0.0
    centre = pybullet.getBasePositionAndOrientation(uid)[0]
    corner = [max(abs(low[i] - centre[i]), abs(high[i] - centre[i])) for i in range(3)]
    return (corner[0] ** 2 + corner[1] ** 2 + corner[2] ** 2) ** 0.5
