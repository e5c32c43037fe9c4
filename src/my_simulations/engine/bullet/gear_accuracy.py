"""Solve steps more exactly while gears (mimic joints, gearboxes, screws) do not keep their ratio.

Bullet begins a step without the impulses that gears had in the last one. The usual iterations do
not carry the load of a gripper through its linkage of light links and gears: at 4 N m, fingers of a
Robotiq 85 were 0.06 rad apart at steps of 1 ms, 0.16 rad at 5 ms, and a held cube slipped out.
"""
from __future__ import annotations

import pybullet

from ...geometry import Vec3
from .joint_constraints import Constraint, ConstraintBook
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import USUAL_ACCURACY, Accuracy, WorldParameters

_CHECK_STEPS = 10     # between two checks
_LARGEST_ERROR = 2e-4   # rad or m, at usual accuracy
_ACCURACY = Accuracy(iterations=10)


class GearAccuracy(StepHelper):
    """Checks all gears of a world.

    Args:
        book: has the gears.
        parameters: receives the requests.
    """

    def __init__(self, book: ConstraintBook, parameters: WorldParameters) -> None:
        self._book, self._parameters = book, parameters
        self._accuracy = USUAL_ACCURACY

    def due(self, step: int) -> int:
        """Every `_CHECK_STEPS`, while there are gears; once after the last one was removed."""
        if not self._book.gears and self._accuracy is USUAL_ACCURACY:
            return FAR
        return next_multiple(step, _CHECK_STEPS)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Request the accuracy of the next steps."""
        wanted = _ACCURACY if any(map(_has_error, self._book.gears)) else USUAL_ACCURACY
        if wanted is not self._accuracy:
            self._accuracy = wanted
            self._parameters.request_gear_accuracy(wanted)


def _has_error(gear: Constraint) -> bool:
    """Return whether follower + ratio leader differs from the target."""
    uid, follower, _, leader = gear.made_with[:4]
    (one,), (other,) = (pybullet.getJointState(uid, index)[:1] for index in (follower, leader))
    error = one + gear.changed_to["gearRatio"] * other - gear.changed_to["relativePositionTarget"]
    return bool(abs(error) > _LARGEST_ERROR)
