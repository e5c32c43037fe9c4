#!/usr/bin/env python3
"""Prints processor time beside accuracy of scenes that stand or fall: ours against bare PyBullet.

usage: accuracy.py [PAIRS [SCENE …]]     PAIRS: 5 by default; SCENE: words in its name

Each scene runs in a separate process, alternately ours and bare, with steps of 1 ms. Bare is
PyBullet with its default settings. Without joints both use rigid bodies (maximal coordinates). In
both the ground has mu 1, so that a pair has the mu of the piece. Times are medians of the pairs,
with their spread. Runs repeat bit for bit, so the accuracy is that of every run: how far standing
pieces moved, how deep fallen pieces penetrate others, how much energy freely swinging arms lost or
gained.
"""
from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import Callable, List

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "engine")]
import bare_world
import numpy as np
import pairs
import pybullet
import structures

DT, G = 0.001, bare_world.GRAVITY
STANDING = ("a stack of 10", "200 boxes in stacks", "a wall of 200 bricks", "20 cards of 2 g",
            "an arch of 11")
ARMS = "ten arms of 6"
STEPS = {"a stack of 10": 4000, "20 cards of 2 g": 4000, "an arch of 11": 4000, ARMS: 2000}
LINKS, LENGTH = 6, 0.3


def _arm_ours() -> object:
    from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
    from my_simulations.geometry import Pose
    moment = LENGTH ** 2 / 12
    links = [Link(f"l{n}", Pose((n * LENGTH, 0, 0)), Inertial(
        1.0, Pose((LENGTH / 2, 0, 0)), moment / 10, 0, 0, moment, 0, moment))
        for n in range(LINKS)]
    joints = [Joint(f"j{n}", "revolute", f"l{n - 1}" if n else "world", f"l{n}",
                    axis=JointAxis((0.0, 1.0, 0.0))) for n in range(LINKS)]
    return Model("arm", links=links, joints=joints)


def _arm_bare(y: float) -> None:
    moment = LENGTH ** 2 / 12
    arm = pybullet.createMultiBody(
        0.0, -1, -1, (0, y, 3), linkMasses=[1.0] * LINKS,
        linkCollisionShapeIndices=[-1] * LINKS, linkVisualShapeIndices=[-1] * LINKS,
        linkPositions=[(LENGTH * (n > 0), 0, 0) for n in range(LINKS)],
        linkOrientations=[(0, 0, 0, 1)] * LINKS,
        linkInertialFramePositions=[(LENGTH / 2, 0, 0)] * LINKS,
        linkInertialFrameOrientations=[(0, 0, 0, 1)] * LINKS,
        linkParentIndices=list(range(LINKS)), linkJointTypes=[pybullet.JOINT_REVOLUTE] * LINKS,
        linkJointAxis=[(0, 1, 0)] * LINKS)
    for n in range(LINKS):
        pybullet.changeDynamics(arm, n, localInertiaDiagonal=(moment / 10, moment, moment))
        pybullet.setJointMotorControl2(arm, n, pybullet.VELOCITY_CONTROL, force=0.0)


def _ours(scene: str) -> Callable[[int], None]:
    from conftest import Lab, ground
    lab = Lab()
    lab.load(ground(1.0))
    if scene == ARMS:
        for n in range(10):
            lab.load(_arm_ours(), (0, n, 3))
    else:
        structures.load(lab, structures.SCENES[scene]())

    def steps(count: int) -> None:
        lab.backend.step(lab.step, count)
        lab.step += count
    return steps


def _bare(scene: str) -> Callable[[int], None]:
    bare_world.begin(DT)
    if scene == ARMS:
        for n in range(10):
            _arm_bare(float(n))
    else:
        for piece in structures.SCENES[scene]():
            shape = (pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=piece.corners)
                     if piece.corners else pybullet.createCollisionShape(
                         pybullet.GEOM_BOX, halfExtents=[side / 2 for side in piece.size]))
            body = pybullet.createMultiBody(piece.mass, shape, -1, piece.position,
                                            useMaximalCoordinates=1)
            pybullet.changeDynamics(body, -1, lateralFriction=piece.mu)
    return bare_world.steps


def _moving() -> List[int]:
    return [uid for uid in map(pybullet.getBodyUniqueId, range(pybullet.getNumBodies()))
            if pybullet.getDynamicsInfo(uid, -1)[0] > 0.0]


def _places() -> np.ndarray:
    return np.array([pybullet.getBasePositionAndOrientation(uid)[0] for uid in _moving()])


def _energy() -> float:
    """Of all arms, J; links are thin rods."""
    total = 0.0
    for uid in map(pybullet.getBodyUniqueId, range(pybullet.getNumBodies())):
        for n in range(pybullet.getNumJoints(uid)):
            if pybullet.getDynamicsInfo(uid, n)[0] > 0.0:
                state = pybullet.getLinkState(uid, n, computeLinkVelocity=1)
                total += sum(v * v for v in state[6]) / 2 + G * state[0][2]
                total += LENGTH ** 2 / 12 * state[7][1] ** 2 / 2
    return total


def child(kind: str, scene: str) -> None:
    """Run a scene once; prints the processor time of a step, us, and the accuracy."""
    steps = (_ours if kind == "ours" else _bare)(scene)
    count = STEPS.get(scene, 1000)
    before = _places() if scene != ARMS else np.zeros((0, 3))
    energy = _energy() if scene == ARMS else 0.0
    began = time.process_time()
    for _ in range(count // 100):
        steps(100)
    took = (time.process_time() - began) / count * 1e6
    if scene == ARMS:
        swing = 10 * LINKS * G * LENGTH * LINKS / 2
        print(took, f"energy off by {100 * abs(_energy() - energy) / swing:.2f} %")
    elif scene in STANDING:
        moved = max(math.dist(a, b) for a, b in zip(before, _places()))
        print(took, f"moved {1000 * moved:.2f} mm")
    else:
        deep = max((-contact[8] for contact in pybullet.getContactPoints()), default=0.0)
        print(took, f"{1000 * deep:.2f} mm deep")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        child(sys.argv[2], sys.argv[3])
    else:
        sys.exit(pairs.rows(__file__, [*structures.SCENES, ARMS], sys.argv[1:], "accuracy"))
