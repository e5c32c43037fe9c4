"""Bare PyBullet with the boxes of the benchmark's worlds, to measure the simulator against.

usage: bare.py KIND COUNT SLEEP     KIND: boxes | stacks     SLEEP: 0 | 1

PyBullet has its default settings; its boxes are rigid bodies in maximal coordinates, the faster of
its two kinds, and sleep only when asked to. For each line on standard input, seconds of wall time,
it makes steps for so long and prints how many a second, and how many a second of processor time.
"""
from __future__ import annotations

import os
import sys
import time

import bare_world
import pybullet
from scenes import positions

DT = 0.001
SETTLED = {True: 4000, False: 1500}
"""Steps after which its boxes have their four contact points each: after 300 they had two."""


def main(kind: str, count: int, sleeping: bool) -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # PyBullet prints there, too
    bare_world.begin(DT)
    for at in positions(kind, count):
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.5] * 3)
        body = pybullet.createMultiBody(1.0, shape, -1, at, useMaximalCoordinates=1)
        pybullet.changeDynamics(body, -1, lateralFriction=1.0)
        if sleeping:
            pybullet.changeDynamics(
                body, -1, activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
                sleepThreshold=0.01)
    bare_world.steps(SETTLED[sleeping])
    for line in sys.stdin:
        steps, started, seconds = 0, time.perf_counter(), float(line)
        busy = time.process_time()
        while time.perf_counter() - started < seconds:
            bare_world.steps(20)
            steps += 20
        print(steps / (time.perf_counter() - started), steps / (time.process_time() - busy),
              file=answers, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3] == "1")
