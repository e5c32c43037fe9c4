"""PyBullet bodies from planned ones, and what the engine must remember of each.

PyBullet speaks of centres of mass; the description speaks of link frames. The two meet here and
nowhere else: `link_from_com` of each part converts, both ways.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, List, Optional, Sequence, Tuple

import pybullet

from ...description.model import Link, Model
from ...description.shapes import MeshTable
from ...geometry import (
    IDENTITY,
    Pose,
    Quat,
    Twist,
    Vec3,
    compose,
    conjugate,
    inverse,
    multiply,
    rotate,
    twist_at,
)
from ..inertia import principal
from ..plan import BASE, NO_LINK, BodyPlan, TreeLink
from ..rows import AXES, row_name
from . import surfaces
from .shapes import ShapeFactory

SLEEP_THRESHOLD = 0.01
"""Bodies slower than about 0.1 m/s (measured) for 2 s of sim time may sleep, as Gazebo's."""

_FREE_JOINT_VELOCITY = 1e6  # PyBullet clamps joint rates to 100 by default
_LIGHT = 1e-6  # share of a link's mass for the piece between the two axes it hangs on
_JOINT_TYPES = {"revolute": pybullet.JOINT_REVOLUTE, "prismatic": pybullet.JOINT_PRISMATIC,
                "fixed": pybullet.JOINT_FIXED, "ball": pybullet.JOINT_SPHERICAL}


@dataclass
class Part:
    """One link of a body: its row in the ring, PyBullet's index, its mass and its surface.

    Attributes:
        link_from_com: the centre of mass and the principal axes.
        moments: about those axes, kg m^2.
        mu, friction: the coefficient of the file, and what PyBullet was given to store.
    """

    row: int
    index: int
    link_from_com: Pose
    mass: float
    moments: Vec3
    mu: float
    friction: float
    gravity: bool

    def com_pose(self, link_pose: Pose) -> Pose:
        """World pose of the centre of mass from that of the link frame."""
        return compose(link_pose, self.link_from_com)

    def com_twist(self, link_pose: Pose, twist: Twist) -> Twist:
        """Twist at the centre of mass from that at the link origin."""
        return twist_at(twist, rotate(link_pose.orientation, self.link_from_com.position))


@dataclass
class Axis:
    """One joint axis of a body: its row in the ring and PyBullet's joint index."""

    row: int
    index: int
    name: str
    number: int = 0


@dataclass
class Ball:
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
    """One PyBullet body, or several immovable ones that stand for one link.

    Attributes:
        uid: PyBullet's number; `more` those of further static pieces with the same frame.
        balls: its ball joints, which have no row.
        parts: its links; `base` is the part whose index is BASE, None for a fixed base.
        moves: False for static and kinematic ones.
        rigid: joint-free, so it may sleep when `may_sleep`.
        lead_row: of its first part.
        radius: of a sphere about the centre of mass that holds the body (rigid ones), m.
        ties: how many joints connect it with other models.
    """

    uid: int
    model_id: int
    parts: List[Part]
    axes: List[Axis] = field(default_factory=list)
    more: Tuple[int, ...] = ()
    balls: Tuple[Ball, ...] = ()
    moves: bool = True
    rigid: bool = True
    may_sleep: bool = True
    radius: float = 0.0
    still: int = 0
    ties: int = 0
    lead_row: int = field(init=False)

    def __post_init__(self) -> None:
        self.lead_row = self.parts[0].row

    @property
    def uids(self) -> Tuple[int, ...]:
        """All PyBullet numbers it holds."""
        return (self.uid,) + self.more

    @property
    def base(self) -> Optional[Part]:
        """The part that PyBullet's base is."""
        return self.parts[0] if self.parts[0].index == BASE else None


class Builder:
    """Builds the bodies of one model; on a fault it removes what it had built."""

    def __init__(self, model_id: int, model: Model, pose: Pose, meshes: MeshTable,
                 shapes: ShapeFactory, link_rows: int, joint_rows: Dict[str, int],
                 dt: float, articulated: bool = False) -> None:
        self.dt = dt
        self.articulated = articulated
        self.model_id = model_id
        self.model = model
        self.pose = pose
        self.meshes = meshes
        self.shapes = shapes
        self.first_row = link_rows
        self.joint_rows = joint_rows
        self.built: List[Body] = []

    def build(self, plans: Sequence[BodyPlan]) -> List[Body]:
        """All bodies, at their initial poses, with Gazebo's dynamics instead of PyBullet's."""
        try:
            for plan in plans:
                self.built.append(self._rigid(plan) if self._is_rigid(plan)
                                  else self._tree(plan))
            self._ignore_each_other()
        except Exception:
            for body in self.built:
                remove(body)
            raise
        return self.built

    def _is_rigid(self, plan: BodyPlan) -> bool:
        if not plan.is_rigid:
            return False
        return (not self.articulated or self.model.static
                or self.model.links[plan.links[0].index].kinematic)

    def _rigid(self, plan: BodyPlan) -> Body:
        link = self.model.links[plan.links[0].index]
        static = self.model.static or link.kinematic
        com, moments = (IDENTITY, (0.0, 0.0, 0.0)) if static else principal(link.inertial)
        mass = 0.0 if static else link.inertial.mass
        pieces = self.shapes.compounds(link.collisions, self.meshes, inverse(com), static)
        at = compose(compose(self.pose, link.pose), com)
        uids = [
            pybullet.createMultiBody(mass, piece, -1, at.position, at.orientation,
                                     useMaximalCoordinates=int(not self.articulated))
            for piece in (pieces or [-1])
        ]
        part = self._part(plan.links[0].index, BASE, com, mass, moments)
        body = Body(uids[0], self.model_id, [part], more=tuple(uids[1:]), moves=not static,
                    rigid=not self.articulated, may_sleep=self._may_sleep(link))
        for uid in uids:
            set_dynamics(uid, BASE, link, mass, moments, body.may_sleep and not static)
            if body.rigid:
                set_decay(uid, link, self.dt)
        body.radius = _radius(uids[0])
        return body

    def _part(self, number: int, index: int, com: Pose, mass: float, moments: Vec3) -> Part:
        link = self.model.links[number]
        surface = surfaces.of_link(link)
        return Part(self.first_row + number, index, com, mass, moments, surface.mu,
                    surfaces.friction(surface, mass == 0.0), link.gravity)

    def _may_sleep(self, link: Link) -> bool:
        return (self.model.allow_auto_disable and link.gravity
                and not any(joint.type in AXES for joint in self.model.joints))

    def _tree(self, plan: BodyPlan) -> Body:
        offset = 0 if plan.fixed_base else 1
        hung = plan.links[offset:]
        masses = self._masses(plan)
        shape = [self._tree_shape(node) for node in plan.links]
        base_mass, base_shape, base_at, base_com = 0.0, -1, self.pose, IDENTITY
        if not plan.fixed_base:
            root = self.model.links[plan.links[0].index]
            base_mass, base_com, _ = masses[0]
            base_shape, base_at = shape[0], compose(self.pose, root.pose)
        coms = [compose(inverse(node.link_from_frame), com)
                for node, (_, com, _) in zip(hung, masses[offset:])]
        uid = pybullet.createMultiBody(
            baseMass=base_mass, baseCollisionShapeIndex=base_shape,
            basePosition=base_at.position, baseOrientation=base_at.orientation,
            baseInertialFramePosition=base_com.position,
            baseInertialFrameOrientation=base_com.orientation,
            linkMasses=[mass for mass, _, _ in masses[offset:]],
            linkCollisionShapeIndices=shape[offset:],
            linkVisualShapeIndices=[-1] * len(hung),
            linkPositions=[node.parent_from_frame.position for node in hung],
            linkOrientations=[node.parent_from_frame.orientation for node in hung],
            linkInertialFramePositions=[com.position for com in coms],
            linkInertialFrameOrientations=[com.orientation for com in coms],
            linkParentIndices=[node.parent + 1 - offset if node.parent >= 0 else 0
                               for node in hung],
            linkJointTypes=[_JOINT_TYPES[node.kind] for node in hung],
            linkJointAxis=[node.axis or (0.0, 0.0, 1.0) for node in hung],
            flags=(pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT
                   | pybullet.URDF_USE_SELF_COLLISION) if self.model.self_collide else 0,
        )
        return self._finish_tree(uid, plan, masses, offset)

    def _masses(self, plan: BodyPlan) -> List[Tuple[float, Pose, Vec3]]:
        """Mass, pose of the principal axes in the link frame, and moments of every tree link."""
        found: List[Tuple[float, Pose, Vec3]] = []
        for n, node in enumerate(plan.links):
            if node.index == NO_LINK:
                beyond = next(link for link in plan.links[n:] if link.index != NO_LINK)
                mass = _LIGHT * self.model.links[beyond.index].inertial.mass
                found.append((mass, IDENTITY, (mass * 1e-3,) * 3))
            else:
                inertial = self.model.links[node.index].inertial
                found.append((inertial.mass, *principal(inertial)))
        return found

    def _finish_tree(self, uid: int, plan: BodyPlan, masses: List[Tuple[float, Pose, Vec3]],
                     offset: int) -> Body:
        parts: List[Part] = []
        axes: List[Axis] = []
        balls: List[Ball] = []
        for n, node in enumerate(plan.links):
            index, (mass, com, moments) = n - offset, masses[n]
            link = Link("") if node.index == NO_LINK else self.model.links[node.index]
            set_dynamics(uid, index, link, mass, moments, False)
            if node.index != NO_LINK:
                parts.append(self._part(node.index, index, com, mass, moments))
            if node.joint is not None and node.number is not None:
                row = self.joint_rows[row_name(node.joint.name, node.number)]
                axes.append(Axis(row, index, node.joint.name, node.number))
            elif node.kind == "ball":
                balls.append(self._ball(plan, node, index, parts))
        if plan.fixed_base:
            pybullet.changeDynamics(uid, BASE, linearDamping=0.0, angularDamping=0.0)
        return Body(uid, self.model_id, parts, axes, rigid=False, may_sleep=False,
                    balls=tuple(balls))

    def _ball(self, plan: BodyPlan, node: TreeLink, index: int, parts: List[Part]) -> Ball:
        child, parent, above = parts[-1], None, IDENTITY
        if node.parent >= 0:
            over = plan.links[node.parent].index
            parent = next(part for part in parts if part.row == self.first_row + over)
            above = parent.com_pose(self.model.links[over].pose)
        mine = child.com_pose(self.model.links[node.index].pose)
        return Ball(index, child, parent, multiply(conjugate(mine.orientation),
                                                   above.orientation))

    def _tree_shape(self, node: TreeLink) -> int:
        if node.index == NO_LINK:
            return -1
        link = self.model.links[node.index]
        found = self.shapes.compounds(link.collisions, self.meshes,
                                      inverse(node.link_from_frame), False)
        return found[0] if found else -1

    def _ignore_each_other(self) -> None:
        """Links of one model collide only when self_collide asks (SDF 1.7, model/self_collide)."""
        if self.model.self_collide or self.model.static:
            return
        for n, one in enumerate(self.built):
            for other in self.built[n + 1:]:
                for a in [BASE] + [part.index for part in one.parts if part.index != BASE]:
                    for b in [BASE] + [part.index for part in other.parts if part.index != BASE]:
                        pybullet.setCollisionFilterPair(one.uid, other.uid, a, b, 0)


def set_dynamics(uid: int, index: int, link: Link, mass: float, moments: Vec3,
                 may_sleep: bool) -> None:
    """Gazebo's dynamics for one link: the file's inertia, no hidden damping, its surface."""
    surface = surfaces.of_link(link)

    # One call each: some settings make PyBullet apply all of a call to the base (measured, 3.2.7:
    # with maxJointVelocity, the mass of a link became that of the base and freed a fixed one).
    def change(**settings: object) -> None:
        pybullet.changeDynamics(uid, index, **settings)

    if mass > 0.0:
        change(mass=mass, localInertiaDiagonal=moments)
    change(lateralFriction=surfaces.friction(surface, mass == 0.0), spinningFriction=0.0,
           rollingFriction=0.0, restitution=surfaces.restitution(surface))
    change(contactProcessingThreshold=0.0)
    change(linearDamping=0.0, angularDamping=0.0)
    if index != BASE:
        change(maxJointVelocity=_FREE_JOINT_VELOCITY)
    if mass > 0.0 and may_sleep:
        change(activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
               sleepThreshold=SLEEP_THRESHOLD)
    elif mass > 0.0:
        change(activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)


def set_decay(uid: int, link: Link, dt: float) -> None:
    """SDF's velocity_decay of a rigid body.

    Gazebo's ODE takes the share off in every step; Bullet's damping d leaves (1 - d) ** dt of it.
    """
    if link.linear_decay or link.angular_decay:
        damping = [1.0 - (1.0 - min(1.0, decay)) ** (1.0 / dt)
                   for decay in (link.linear_decay, link.angular_decay)]
        pybullet.changeDynamics(uid, BASE, linearDamping=damping[0], angularDamping=damping[1])


def remove(body: Body) -> None:
    """Take the body out of PyBullet."""
    for uid in body.uids:
        pybullet.removeBody(uid)


def place(body: Body, link_pose: Pose) -> None:
    """Put a body so that its first part's link frame has the world pose `link_pose`."""
    at = body.parts[0].com_pose(link_pose)
    for uid in body.uids:
        pybullet.resetBasePositionAndOrientation(uid, at.position, at.orientation)


def launch(body: Body, link_pose: Pose, twist: Twist) -> None:
    """Give the base the velocity `twist` (at its link origin, world axes)."""
    com = body.parts[0].com_twist(link_pose, twist)
    pybullet.resetBaseVelocity(body.uid, com.linear, com.angular)


def _radius(uid: int) -> float:
    low, high = pybullet.getAABB(uid, BASE)
    if not -1e9 < low[0] <= high[0] < 1e9:
        return 0.0
    centre = pybullet.getBasePositionAndOrientation(uid)[0]
    corner = [max(abs(low[i] - centre[i]), abs(high[i] - centre[i])) for i in range(3)]
    return (corner[0] ** 2 + corner[1] ** 2 + corner[2] ** 2) ** 0.5
