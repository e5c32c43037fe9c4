"""Collect the contact and constraint forces on the links of a body in the last step."""
from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping, Sequence, Tuple

import numpy as np
import pybullet

from ...geometry import ZERO3, Pose, Vec3, add, multiply, rotate, scale, transform
from ..body_plan import BASE
from .bodies import Body
from .contact_points import FRICTION, FRICTION_2, friction_force
from .link_states import Motion

Acting = Dict[int, List[Tuple[Vec3, Vec3, Vec3]]]
"""Force, point of action and torque by PyBullet's link index; N, m, N m, world axes."""


def note(found: Acting, index: int, force: Vec3, at: Vec3, torque: Vec3 = ZERO3) -> None:
    """Add a force and a torque on a link, unless both are zero."""
    if any(force) or any(torque):
        found.setdefault(index, []).append((force, at, torque))


def note_contacts(found: Acting, body: Body) -> None:
    """Add the contact forces of Bullet on the links of a body."""
    mine = pybullet.getContactPoints(bodyA=body.uid)
    if not mine:
        return
    # In queries for one body, PyBullet swaps points and normals of some contacts, but not the
    # directions of friction (measured, 3.2.7).
    owners = body.owners
    for contact in pybullet.getContactPoints() if any(
            contact[FRICTION] or contact[FRICTION_2] for contact in mine) else mine:
        _, one, other, link, other_link, point, other_point, normal, distance, load = contact[:10]
        # Separated surfaces have the force of an older step.
        if distance > 0.0 or body.uid not in (one, other):
            continue
        force = add(scale(normal, load), friction_force(contact))
        if one == body.uid:
            note(found, owners.get(link, link), force, point)
        if other == body.uid:
            note(found, owners.get(other_link, other_link), scale(force, -1.0), other_point)


def note_constraints(found: Acting, body: Body, links: Mapping[int, Motion]) -> None:
    """Add the forces of constraints on the links of a body, except those of gears."""
    for n in range(pybullet.getNumConstraints()):
        number = pybullet.getConstraintUniqueId(n)
        info = pybullet.getConstraintInfo(number)
        for uid, index in (info[0:2], info[2:4]) if info[4] != pybullet.JOINT_GEAR else ():
            if uid == body.uid and index in links:
                note(found, index, *constraint_forces(number, body, index, links[index]))


def constraint_forces(number: int, body: Body, index: int, link: Motion
                      ) -> Tuple[Vec3, Vec3, Vec3]:
    """Return force, point of action and torque of a constraint on one of its links; world axes."""
    info = pybullet.getConstraintInfo(number)
    force, torque = _on_the_second(info, pybullet.getConstraintState(number))
    sign, pivot = (1.0, info[7]) if (info[2], info[3]) == (body.uid, index) else (-1.0, info[6])
    return (scale(force, sign), transform(Pose(link.position, link.orientation), pivot),
            scale(torque, sign))


def _on_the_second(info: Sequence[Any], state: Sequence[float]) -> Tuple[Vec3, Vec3]:
    """Return force and torque of a constraint on its second body, N and N m, world axes.

    Source: the rows of Bullet's btMultiBodyPoint2Point, FixedConstraint and SliderConstraint.
    """
    if info[4] == pybullet.JOINT_POINT2POINT:
        return _vector(state[:3]), ZERO3
    turn = (pybullet.getBasePositionAndOrientation(info[0]) if info[1] == BASE
            else pybullet.getLinkState(info[0], info[1], computeForwardKinematics=1))[1]
    frame = np.array(pybullet.getMatrixFromQuaternion(multiply(turn, info[8]))).reshape(3, 3).T
    if info[4] == pybullet.JOINT_FIXED:
        return _vector(-np.array(state[:3])), _vector(-(np.array(state[3:6]) @ frame))
    along = np.array(rotate(turn, info[5]))
    across = next(c for c in np.cross(frame, along) if np.linalg.norm(c) > 1e-6)
    across = across / np.linalg.norm(across)
    return (_vector(-state[0] * across - state[1] * np.cross(along, across)),
            _vector(-(np.array([state[3], state[4], state[2]]) @ frame)))


def _vector(values: Iterable[float]) -> Vec3:
    x, y, z = values
    return (float(x), float(y), float(z))
