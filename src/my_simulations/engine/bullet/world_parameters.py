"""Sets the parameters that Bullet has once for a whole world; no other module sets them.

Helpers request values for their bodies. Where several requests meet, the rule of each parameter
decides, so that no request depends on the order of the helpers:

- Iterations and residual: the request that is solved most exactly. More iterations and a smaller
  residual harm no other body. A step that is longer than usual may take as many more iterations:
  it gives bodies as much more speed, all of which contacts have to take from them.
- Spacing of contact points (Bullet's contactBreakingThreshold, of a body's size): Bullet stores it
  in the contact points of a pair when the pair is new. So a request holds for one step, and counts
  for the pairs that are new in it. The widest one is set: it is for pairs that stay, and that are
  new in one step only. Narrow ones are for pairs that are new in each step: they miss one step;
  all others that are new are found before it (`find_pairs`).

`apply` sets what has changed, in one call before a step.
"""
from __future__ import annotations

from typing import Dict, NamedTuple

import pybullet

from ..commands import PhysicsSettings
from . import collision_groups

USUAL_STEP = 1e-3         # s
USUAL_SPACING = 0.02      # of a body's size
USUAL_RESIDUAL = 1e-7     # m^2/s^2
LEAST_BOUNCE = 0.2        # m/s: Bullet's own; slower bodies come to rest


class Accuracy(NamedTuple):
    """How exactly Bullet solves a step.

    Attributes:
        iterations: how many times those of the settings.
        residual: m^2/s^2, the square of the change of velocity at which the iterations end.
    """

    iterations: int = 1
    residual: float = USUAL_RESIDUAL


USUAL_ACCURACY = Accuracy()


class WorldParameters:
    """Combines what helpers request of the world-wide parameters, and sets what has changed."""

    def __init__(self) -> None:
        self._settings = PhysicsSettings()
        self._accuracy = USUAL_ACCURACY
        self._step_accuracy = self._gear_accuracy = USUAL_ACCURACY
        self._spacing = 0.0          # requested for the next step; 0 for none
        self._splits = False
        self._slowest_bounce = LEAST_BOUNCE
        self._set: Dict[str, float] = {}
        self._is_changed = False

    def configure(self, settings: PhysicsSettings) -> None:
        """Set gravity, step and all parameters, also after PyBullet's world was reset."""
        self._settings = settings
        pybullet.setGravity(*settings.gravity)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=settings.step_size, numSubSteps=0, deterministicOverlappingPairs=1,
            enableFileCaching=0, collisionFilterMode=collision_groups.BOTH,
            # Overlaps are pushed out at 5 / s whatever the step: Bullet's default throws a body
            # that starts 0.2 m deep to 3 m, and makes bounces erratic (measured).
            contactERP=min(0.2, 5.0 * settings.step_size),
            # Each step begins with what the contacts carried in the last one. PyBullet begins
            # with a tenth of it: a stack of ten then takes four times as long and leans ten times
            # as far; with all of it (1) a heavy body on light ones collapses (measured).
            warmStartingFactor=0.99,
            enableConeFriction=int(settings.cone),
            allowedCcdPenetration=0.0,   # what flies fast stops at a wall, not in it
            splitImpulsePenetrationThreshold=0.0,
        )
        self._set.clear()
        self._is_changed = True
        self.apply()

    def request_accuracy(self, accuracy: Accuracy) -> None:
        """Solve this exactly from the next step on, until the next request."""
        if accuracy != self._accuracy:
            self._accuracy, self._is_changed = accuracy, True

    def request_gear_accuracy(self, accuracy: Accuracy) -> None:
        """Solve at least this exactly from the next step on, until the next request for gears."""
        self._gear_accuracy, self._is_changed = accuracy, True

    def request_step_accuracy(self, accuracy: Accuracy) -> None:
        """Solve the next step at least this exactly."""
        self._step_accuracy, self._is_changed = accuracy, True

    def request_spacing(self, spacing: float) -> None:
        """Keep contact points apart by `spacing`, of a body's size, in pairs of the next step."""
        self._spacing, self._is_changed = max(self._spacing, spacing), True

    def restore_spacing(self) -> None:
        """Undo `request_spacing` of the last step, for pairs that are found before the next."""
        if self._set["contactBreakingThreshold"] != USUAL_SPACING:
            self._set["contactBreakingThreshold"] = USUAL_SPACING
            pybullet.setPhysicsEngineParameter(contactBreakingThreshold=USUAL_SPACING)

    def find_pairs(self) -> None:
        """Find the pairs of bodies that are new, so that they have the usual spacing."""
        self.restore_spacing()
        pybullet.performCollisionDetection()

    def split_impulses(self, wanted: bool) -> None:
        """Part overlaps without giving velocity from the next step on, or (False) with it."""
        self._splits, self._is_changed = wanted, True

    def set_slowest_bounce(self, speed: float) -> None:
        """Let nothing bounce below `speed`, m/s, from the next step on."""
        self._slowest_bounce, self._is_changed = max(LEAST_BOUNCE, speed), True

    def apply(self) -> None:
        """Set what has changed before the next step."""
        if not self._is_changed:
            return
        accuracies = (self._accuracy, self._step_accuracy, self._gear_accuracy)
        wanted = {
            "numSolverIterations": round(
                self._settings.iterations * max(1.0, self._settings.step_size / USUAL_STEP)
                * max(each.iterations for each in accuracies)),
            "solverResidualThreshold": min(each.residual for each in accuracies),
            "contactBreakingThreshold": self._spacing or USUAL_SPACING,
            "useSplitImpulse": int(self._splits),
            "restitutionVelocityThreshold": self._slowest_bounce}
        changed = {name: value for name, value in wanted.items() if self._set.get(name) != value}
        if changed:
            pybullet.setPhysicsEngineParameter(**changed)
            self._set = wanted
        # What was requested for one step only is taken back before the one after it.
        self._is_changed = self._spacing != 0.0 or self._step_accuracy != USUAL_ACCURACY
        self._spacing, self._step_accuracy = 0.0, USUAL_ACCURACY
