"""Build the bodies of a model in PyBullet; a reset builds them again."""
from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple

import numpy as np
import pybullet

from ...description.model import Link, Model
from ...description.self_collision import SelfCollision
from ...description.shapes import MeshTable, Sphere
from ...geometry import IDENTITY, Pose, Vec3, compose, conjugate, inverse, multiply
from ..body_plan import BASE, NO_LINK, BodyPlan, TreeLink, plan_bodies
from ..commands import LoadModel
from ..principal_inertia import principal
from ..ring_rows import AXES, axis_rows, row_name
from ..surface_pieces import by_friction, by_surface, carried_by, in_pieces
from . import collision_groups, surface_coefficients
from .bodies import (
    Axis,
    BallJoint,
    Body,
    Part,
    enable_ccd,
    mark_asleep,
    piece_pose,
    radius_of,
    set_dynamics,
)
from .collision_shapes import MAX_SHAPES, Recipe, ShapeFactory
from .extra_surfaces import is_soft
from .implicit_axes import mobility
from .mass_matrix import MassMatrix
from .rims import with_ends, with_rims

_LIGHT = 1e-6  # share of a link's mass for the piece between the two axes of its joint
_SIMILAR = 2.0  # factor: closer moments of inertia count as those of the shape
_JOINT_TYPES = {"revolute": pybullet.JOINT_REVOLUTE, "prismatic": pybullet.JOINT_PRISMATIC,
                "fixed": pybullet.JOINT_FIXED, "ball": pybullet.JOINT_SPHERICAL}

_Collider = Tuple[int, int, int]  # PyBullet's number of the body, and of its link; the link's row


@dataclass(frozen=True)
class _Masses:
    """Mass of a link, its principal axes in the link frame, and the moments about them."""

    mass: float
    com: Pose
    moments: Vec3


_FIXED = _Masses(0.0, IDENTITY, (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class _Rigid:
    """A joint-free link, ready to be built; `pieces`: its shapes, each with a link's surface."""

    number: int
    static: bool
    masses: _Masses
    model_from_com: Pose
    pieces: Tuple[Tuple[Recipe, Link], ...]


@dataclass(frozen=True)
class _Tree:
    """A tree of links, ready to be built; one of `shapes` a link, None for no shape."""

    plan: BodyPlan
    masses: Tuple[_Masses, ...]
    shapes: Tuple[Optional[Recipe], ...]
    model_from_base: Pose
    arguments: Dict[str, Any]


class Builder:
    """Builds the bodies of one model; stores all data of them that do not depend on the pose.

    Attributes:
        model_id: the model's number.
        plans: the links of each body.
        link_rows, joint_rows: the rows of the model in the link and the joint table.
        initial_rows: a pose, and the values of these rows after the model was built there.
    """

    def __init__(self, command: LoadModel, shapes: ShapeFactory) -> None:
        """Raises BodyPlanError, ShapeError."""
        self._model: Model = command.model
        self.model_id = command.model_id
        self._self_collision = SelfCollision(command.model)
        self._first_row = command.first_link_row
        self._articulated = command.articulated or not command.model.static and any(
            is_soft(link) or len(by_friction(link)) > 1
            for link in command.model.links)
        self._shapes = shapes
        self._axis_rows = {row.name: command.first_joint_row + n
                           for n, row in enumerate(axis_rows(command.model))}
        self.link_rows = slice(command.first_link_row,
                               command.first_link_row + len(command.model.links))
        self.joint_rows = slice(command.first_joint_row,
                                command.first_joint_row + len(self._axis_rows))
        self.initial_rows: Optional[Tuple[Pose, np.ndarray, np.ndarray]] = None
        self._mobilities: Dict[int, float] = {}
        self.plans = [plan if self._is_rigid(plan) else in_pieces(plan, command.model)
                      for plan in plan_bodies(command.model)]
        self._blueprints = [self._rigid(plan, command.meshes) if self._is_rigid(plan)
                        else self._tree(plan, command.meshes) for plan in self.plans]

    def build(self, pose: Pose) -> List[Body]:
        """Build all bodies with the model frame at `pose`, and with Gazebo's dynamics parameters.

        Raises ShapeError, after it has removed the bodies built so far.
        """
        built: List[Body] = []
        try:
            for each in self._blueprints:
                built.append(self._build_rigid(each, pose) if isinstance(each, _Rigid)
                             else self._build_tree(each, pose))
            self._ignore_each_other(built)
        except Exception:
            self.remove(built)
            raise
        return built

    # -- rigid bodies ----------------------------------------------------------------------------

    def _is_rigid(self, plan: BodyPlan) -> bool:
        if not plan.is_rigid:
            return False
        return (not self._articulated or self._model.static
                or self._model.links[plan.links[0].index].kinematic)

    def _rigid(self, plan: BodyPlan, meshes: MeshTable) -> _Rigid:
        number = plan.links[0].index
        link = self._model.links[number]
        static = self._model.static or link.kinematic
        masses = (_FIXED if static
                  else _Masses(link.inertial.mass, *principal(link.inertial)))
        found: List[Tuple[Recipe, Link]] = []
        for carrier in by_surface(link) if static else [link]:
            recipes = self._shapes.recipes(
                carrier.collisions if static else with_ends(link, MAX_SHAPES), meshes,
                inverse(masses.com), static)
            # All have the surface of the first collision: the pieces of a link may be thousands.
            alike = replace(carrier, collisions=carrier.collisions[:1]) if static else carrier
            found += [(recipe, alike) for recipe in recipes]
        found = found or [(self._shapes.empty(self._first_row + number), link)]
        return _Rigid(number, static, masses, compose(link.pose, masses.com), tuple(found))

    def _build_rigid(self, rigid: _Rigid, pose: Pose) -> Body:
        link, masses = self._model.links[rigid.number], rigid.masses
        at = compose(pose, rigid.model_from_com)
        taken = tuple((piece, self._shapes.take_shape(piece)) for piece, _ in rigid.pieces)
        uids = [self._create(masses, shape, piece_pose(at, piece)) for piece, shape in taken]
        for uid, (piece, carrier) in zip(uids, rigid.pieces):
            (collision_groups.static if rigid.static else collision_groups.moving)(
                carrier, piece.role).set(uid, BASE)
            _remove_margin(uid, BASE, piece)
        part = self._part(rigid.number, BASE, masses, link)
        carriers = tuple(self._part(rigid.number, BASE, masses, carrier)
                         for _, carrier in rigid.pieces) if rigid.static else ()
        body = Body(uids[0], self.model_id, [part], more=tuple(uids[1:]), carriers=carriers,
                    moves=not rigid.static, rigid=not self._articulated,
                    is_sphere=[type(c.geometry) for c in link.collisions] == [Sphere],
                    may_sleep=self._may_sleep(link), shapes=taken)
        for uid, own in body.surfaces:
            set_dynamics(uid, own, body.may_sleep and not rigid.static)
            if body.rigid and rigid.static:
                mark_asleep(uid)
        body.radius = radius_of(uids[0])
        if body.rigid and body.moves:
            body.uses_ccd = enable_ccd(uids[0])
        return body

    def _create(self, masses: _Masses, shape: int, at: Pose) -> int:
        """Create the body of a link in PyBullet; returns its number.

        In its first step a rigid body has the inertia of its shape at the mass with which it was
        created (measured); `changeDynamics` applies from the second step on. If the moments of the
        file differ from these, the body is created with a mass that gives their mean. The
        moments of a shape are cached, because PyBullet leaks memory for each created body.
        """
        def create(mass: float) -> int:
            uid: int = pybullet.createMultiBody(
                mass, shape, self._shapes.visual_shape, at.position, at.orientation,
                useMaximalCoordinates=int(not self._articulated))
            return uid

        if self._articulated or masses.mass <= 0.0:
            return create(masses.mass)
        known = self._shapes.moments
        uid: Optional[int] = None
        if (shape, masses.mass) not in known:
            uid = create(masses.mass)
            known[shape, masses.mass] = pybullet.getDynamicsInfo(uid, BASE)[2]
        of_shape = known[shape, masses.mass]
        if all(own <= _SIMILAR * found and found <= _SIMILAR * own
               for own, found in zip(masses.moments, of_shape)) or sum(of_shape) <= 0.0:
            return create(masses.mass) if uid is None else uid
        if uid is not None:
            pybullet.removeBody(uid)
        return create(masses.mass * sum(masses.moments) / sum(of_shape))

    def _part(self, number: int, index: int, masses: _Masses, link: Link) -> Part:
        surface = surface_coefficients.of_link(link)
        return Part(self._first_row + number, index, masses.com, masses.mass, masses.moments,
                    surface_coefficients.friction_coefficient(surface),
                    surface_coefficients.friction(surface, masses.mass == 0.0), link)

    def _may_sleep(self, link: Link) -> bool:
        return (self._model.allow_auto_disable and link.gravity
                and not any(joint.type in AXES for joint in self._model.joints))

    # -- trees -----------------------------------------------------------------------------------

    def _tree(self, plan: BodyPlan, meshes: MeshTable) -> _Tree:
        offset = 0 if plan.fixed_base else 1
        children = plan.links[offset:]
        masses = tuple(self._masses(plan, n) for n in range(len(plan.links)))
        coms = [compose(inverse(node.link_from_frame), each.com)
                for node, each in zip(children, masses[offset:])]
        base = _FIXED if plan.fixed_base else masses[0]
        at = IDENTITY if plan.fixed_base else self._model.links[plan.links[0].index].pose
        return _Tree(plan, masses, tuple(self._tree_shape(node, meshes) for node in plan.links),
                     at, {
            "baseMass": base.mass,
            "baseInertialFramePosition": base.com.position,
            "baseInertialFrameOrientation": base.com.orientation,
            "linkMasses": [each.mass for each in masses[offset:]],
            "linkPositions": [node.parent_from_frame.position for node in children],
            "linkOrientations": [node.parent_from_frame.orientation for node in children],
            "linkInertialFramePositions": [com.position for com in coms],
            "linkInertialFrameOrientations": [com.orientation for com in coms],
            "linkParentIndices": [node.parent + 1 - offset if node.parent >= 0 else 0
                                  for node in children],
            "linkJointTypes": [_JOINT_TYPES[node.kind] for node in children],
            "linkJointAxis": [node.axis or (0.0, 0.0, 1.0) for node in children],
            "flags": (pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT
                      | pybullet.URDF_USE_SELF_COLLISION) if self._collide(plan) else 0})

    def _collide(self, plan: BodyPlan) -> bool:
        """Whether any two links of a tree collide with each other."""
        numbers = [node.index for node in plan.links if node.index != NO_LINK]
        return any(self._self_collision.collides(one, other)
                   for one, other in itertools.combinations(numbers, 2))

    def _masses(self, plan: BodyPlan, n: int) -> _Masses:
        of = plan.links[n].of
        if carried_by(plan.links[n], self._model).kinematic:
            return _FIXED
        if of is not None:
            inertial = self._model.links[of].inertial
            com, (x, y, z) = principal(inertial)
            return _Masses(_LIGHT * inertial.mass, com, (_LIGHT * x, _LIGHT * y, _LIGHT * z))
        if plan.links[n].index == NO_LINK:
            beyond = next(link for link in plan.links[n:] if link.index != NO_LINK)
            mass = _LIGHT * self._model.links[beyond.index].inertial.mass
            return _Masses(mass, IDENTITY, (mass * 1e-3,) * 3)
        inertial = self._model.links[plan.links[n].index].inertial
        return _Masses(inertial.mass, *principal(inertial))

    def _tree_shape(self, node: TreeLink, meshes: MeshTable) -> Optional[Recipe]:
        link = carried_by(node, self._model)
        if link.kinematic:
            still = self._shapes.recipes(link.collisions, meshes, IDENTITY, True, whole=True)
            if len(still) <= 1:     # a link of a tree has one shape
                return still[0] if still else None
        found = self._shapes.recipes(with_rims(node, link.collisions, MAX_SHAPES), meshes,
                                     inverse(node.link_from_frame), False)
        return found[0] if found else None

    def _build_tree(self, tree: _Tree, pose: Pose) -> Body:
        fixed, visual = tree.plan.fixed_base, self._shapes.visual_shape
        shapes = [-1 if recipe is None else self._shapes.take_shape(recipe)
                  for recipe in tree.shapes]
        base_shape, children = (-1, shapes) if fixed else (shapes[0], shapes[1:])
        at = compose(pose, tree.model_from_base)
        uid = pybullet.createMultiBody(
            baseCollisionShapeIndex=base_shape, baseVisualShapeIndex=visual,
            basePosition=at.position, baseOrientation=at.orientation,
            linkCollisionShapeIndices=children, linkVisualShapeIndices=[visual] * len(children),
            **tree.arguments)
        body = self._finish_tree(uid, tree)
        body.shapes = tuple((recipe, shape) for recipe, shape in zip(tree.shapes, shapes)
                            if recipe is not None)
        return body

    def _finish_tree(self, uid: int, tree: _Tree) -> Body:
        parts: List[Part] = []
        pieces: List[Part] = []
        axes: List[Axis] = []
        ball_joints: List[BallJoint] = []
        for n, (node, masses) in enumerate(zip(tree.plan.links, tree.masses)):
            index = n if tree.plan.fixed_base else n - 1
            link = carried_by(node, self._model)
            part = self._part(node.index if node.of is None else node.of, index, masses, link)
            set_dynamics(uid, part, False)
            shape = tree.shapes[n]
            if shape is not None:
                (collision_groups.static(link) if link.kinematic
                 else collision_groups.moving(link)).set(uid, index)
                _remove_margin(uid, index, shape)
            if node.index != NO_LINK:
                parts.append(part)
            elif node.of is not None:
                pieces.append(part)
            if node.joint is not None and node.number is not None:
                row = self._axis_rows[row_name(node.joint.name, node.number)]
                axes.append(Axis(row, index, node.joint.name, node.number))
            elif node.kind == "ball":
                ball_joints.append(self._ball_joint(tree.plan, node, index, parts))
        if tree.plan.fixed_base:
            pybullet.changeDynamics(uid, BASE, linearDamping=0.0, angularDamping=0.0)
        self._store_mobility(uid, axes)
        return Body(uid, self.model_id, parts, axes, rigid=False, may_sleep=False,
                    ball_joints=tuple(ball_joints), pieces=tuple(pieces))

    def _store_mobility(self, uid: int, axes: Sequence[Axis]) -> None:
        """Store the mobility of each axis of a tree, 1/kg or 1/(kg m^2); computed once."""
        if axes and axes[0].row not in self._mobilities:
            found: Any = mobility(
                MassMatrix(uid), [axis.index for axis in axes]).diagonal().tolist()
            self._mobilities.update((axis.row, value) for axis, value in zip(axes, found))
        for axis in axes:
            axis.mobility = self._mobilities[axis.row]

    def _ball_joint(self, plan: BodyPlan, node: TreeLink, index: int,
                    parts: Sequence[Part]) -> BallJoint:
        child, parent, above = parts[-1], None, IDENTITY
        if node.parent >= 0:
            over = plan.links[node.parent].index
            row = self._first_row + over
            parent = next(part for part in parts if part.row == row)
            above = parent.com_pose(self._model.links[over].pose)
        mine = child.com_pose(self._model.links[node.index].pose)
        return BallJoint(index, child, parent, multiply(conjugate(mine.orientation),
                                                   above.orientation))

    def remove(self, built: Sequence[Body]) -> None:
        self._ignore_each_other(built, False)
        for body in built:
            for uid in body.uids:
                pybullet.removeBody(uid)
            self._shapes.store_shapes(body.shapes)

    def _ignore_each_other(self, built: Sequence[Body], ignored: bool = True) -> None:
        """Disable collisions of links of one model, except where `self_collide` enables them."""
        if self._model.static:
            return
        for plan, body in zip(self.plans, built):
            if self._collide(plan):
                self._ignore_pairs(itertools.combinations(_colliders(body), 2), ignored)
        colliders = [found for found in map(_colliders, built) if found]
        for one, other in itertools.combinations(colliders, 2):
            self._ignore_pairs(itertools.product(one, other), ignored)

    def _ignore_pairs(self, pairs: Iterable[Tuple[_Collider, _Collider]], ignored: bool) -> None:
        for (one, index, row), (other, other_index, other_row) in pairs:
            if not self._self_collision.collides(row - self._first_row,
                                                 other_row - self._first_row):
                collision_groups.ignore(one, other, index, other_index, ignored)


def _colliders(body: Body) -> List[_Collider]:
    return [(uid, part.index, part.row) for uid in body.uids for part in body.colliders
            if part.link.collisions]


def _remove_margin(uid: int, index: int, shape: Recipe) -> None:
    """Remove the margin of 1 mm that Bullet adds to a convex hull; hulls in compounds keep it."""
    if shape.is_hull:
        pybullet.changeDynamics(uid, index, collisionMargin=0.0)
