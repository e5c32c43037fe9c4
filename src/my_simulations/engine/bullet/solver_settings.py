"""How Bullet's solver is set."""
from __future__ import annotations

import pybullet

from ..commands import PhysicsSettings
from . import collision_groups


def configure_solver(settings: PhysicsSettings) -> None:
    """Set gravity, step and solver, for all bodies from the next step on."""
    pybullet.setGravity(*settings.gravity)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=settings.step_size, numSolverIterations=settings.iterations,
        numSubSteps=0, deterministicOverlappingPairs=1, enableFileCaching=0,
        collisionFilterMode=collision_groups.BOTH,
        # Overlaps are pushed out at 5 / s whatever the step: Bullet's default throws a body
        # that starts 0.2 m deep to 3 m, and makes bounces erratic (measured).
        contactERP=min(0.2, 5.0 * settings.step_size),
        # Each step begins with what the contacts carried in the last one. PyBullet begins with
        # a tenth of it: a stack of ten then takes four times as long and leans ten times as
        # far; with all of it (1) a heavy body on light ones collapses (measured).
        warmStartingFactor=0.99,
        enableConeFriction=int(settings.cone),
        allowedCcdPenetration=0.0,   # what flies fast stops at a wall, not in it
    )
