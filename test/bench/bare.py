"""A bare PyBullet loop, to measure the simulator against: prints steps per second.

usage: bare.py KIND COUNT SLEEP SECONDS     KIND: boxes | stacks     SLEEP: 0 | 1
"""
from __future__ import annotations

import sys
import time

import pybullet

sys.path.insert(0, __file__.rsplit("/", 1)[0])
from scenes import positions


def main(kind: str, count: int, sleeping: bool, seconds: float) -> None:
    pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.8)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=0.001, numSolverIterations=50,
                                       numSubSteps=0, contactERP=0.01)
    plane = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE),
                                     useMaximalCoordinates=1)
    pybullet.changeDynamics(plane, -1, lateralFriction=1.0)
    for at in positions(kind, count):
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.5] * 3)
        body = pybullet.createMultiBody(1.0, shape, -1, at, useMaximalCoordinates=1)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0, lateralFriction=1.0)
        pybullet.changeDynamics(body, -1, contactProcessingThreshold=0.0)
        if sleeping:
            pybullet.changeDynamics(
                body, -1, activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
                sleepThreshold=0.01)
        else:
            pybullet.changeDynamics(
                body, -1, activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)
    step = pybullet.stepSimulation
    for _ in range(4000 if sleeping else 300):
        step()
    steps, started = 0, time.perf_counter()
    while time.perf_counter() - started < seconds:
        for _ in range(20):
            step()
        steps += 20
    print(steps / (time.perf_counter() - started))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3] == "1", float(sys.argv[4]))
