"""A world of bare PyBullet with its default settings, to measure this engine against."""
from __future__ import annotations

import pybullet

GRAVITY = 9.8


def begin(step_size: float) -> None:
    """Connect; a ground of mu 1 as a rigid body (maximal coordinates). `step_size` in s."""
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -GRAVITY)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=step_size)
    plane = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE),
                                     useMaximalCoordinates=1)
    pybullet.changeDynamics(plane, -1, lateralFriction=1.0)


def steps(count: int) -> None:
    for _ in range(count):
        pybullet.stepSimulation()
