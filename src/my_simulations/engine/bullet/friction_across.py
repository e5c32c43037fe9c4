"""Compensate friction across the slip of rigid bodies that robots push.

Bullet solves the friction of a rigid body in two directions, along the slip and across it, each up
to mu N. Across it, Coulomb's friction of a body that slides is zero, but Bullet's resists each
change of the direction. So it bears the moment of a push beside the centre, and which of the edges
of a flat front push is left to chance (figures: doc/dev/contacts.md, "Friction"). A force on the
body that follows this friction cancels it: the push moves to where Coulomb's law balances it. The
force must follow slowly, as contacts with the robot resist the change, too.
"""
from __future__ import annotations

from typing import AbstractSet, Dict, Sequence, Tuple

import pybullet

from ...geometry import ZERO3, Vec3, add, cross, dot, scale, subtract
from ..body_plan import BASE
from .contact_points import (
    DIRECTION,
    DIRECTION_2,
    FRICTION,
    FRICTION_2,
    LOAD,
    OTHER_BODY,
    POINT,
    ContactPoint,
)
from .link_states import motion

_SLIDES = 2e-3       # m/s: a slower slip has no direction
_FOLLOWS = 0.05      # s, the time constant; with 0.01 s the force and the friction alternate


class FrictionAcross:
    """Applies forces to rigid bodies that robots push over static bodies.

    Attributes:
        forces: by body: the force, N, the torque, N m, and the point at which they act in the next
            step, m.
        last: the same in the last step.
    """

    def __init__(self) -> None:
        self.forces: Dict[int, Tuple[Vec3, Vec3, Vec3]] = {}
        self.last: Dict[int, Tuple[Vec3, Vec3, Vec3]] = {}

    def update(self, uid: int, contacts: Sequence[ContactPoint], moving: AbstractSet[int],
               dt: float) -> bool:
        """Compute the force on a body for the next step. Returns whether the body slides.

        `moving`: the other bodies that move.
        """
        ours = motion(uid, BASE)
        force, torque, slides = ZERO3, ZERO3, False
        for contact in contacts:
            along = dot(ours.velocity_at(contact[POINT]), contact[DIRECTION])
            if contact[LOAD] > 0.0 and contact[OTHER_BODY] not in moving and abs(along) > _SLIDES:
                # The signs of both directions are not known, but friction opposes the slip.
                sign = 1.0 if (along > 0.0) == (contact[FRICTION] > 0.0) else -1.0
                undone = scale(contact[DIRECTION_2], sign * contact[FRICTION_2])
                force = add(force, undone)
                torque = add(torque, cross(subtract(contact[POINT], ours.position), undone))
                slides = True
        if slides:
            share = min(1.0, dt / _FOLLOWS)
            last = self.last.get(uid, (ZERO3, ZERO3))
            self.forces[uid] = (add(scale(last[0], 1.0 - share), scale(force, share)),
                                add(scale(last[1], 1.0 - share), scale(torque, share)),
                                ours.position)
        return slides

    def apply(self) -> None:
        """Apply the forces in the next step; bodies that are not updated after it lose theirs."""
        for uid, (force, torque, at) in self.forces.items():
            pybullet.applyExternalForce(uid, BASE, force, at, pybullet.WORLD_FRAME)
            pybullet.applyExternalTorque(uid, BASE, torque, pybullet.WORLD_FRAME)
        self.last.clear()
        self.last.update(self.forces)
        self.forces.clear()
