#!/usr/bin/env python3
"""Prints how many steps a second environments make, beside loops of bare PyBullet.

usage: environments.py [COUNT …]   COUNT: worlds side by side (default: 1 8 32)

Both simulate the lab robot and the box of PushBox-v0 with random actions, 100 steps of 1 ms a
step of the environment. Bare PyBullet loads the same URDF, keeps the rates of the wheels, and reads
two poses; its worlds are clients of one process, stepped one after another. Rates are per second of
wall time; a ratio of processor times counts all processes. Nothing here fails on a slow machine.
"""
from __future__ import annotations

import os
import pathlib
import sys
import time
from typing import Callable, TextIO, Tuple

import numpy as np
import pybullet
from server import children, processor

ROBOT = str(pathlib.Path(__file__).resolve().parents[2] / "urdf" / "robo.urdf")
INNER, SECONDS, PAIRS = 100, 2.0, 3
WHEELS = ("left_wheel_joint", "right_wheel_joint")


class Bare:
    """Clients of PyBullet with its default settings."""

    def __init__(self, count: int) -> None:
        self._worlds = [self._world() for _ in range(count)]

    @staticmethod
    def _world() -> Tuple[int, int, int, Tuple[int, ...]]:
        client = pybullet.connect(pybullet.DIRECT)
        at = {"physicsClientId": client}
        pybullet.setGravity(0, 0, -9.8, **at)
        pybullet.setPhysicsEngineParameter(fixedTimeStep=0.001, **at)
        pybullet.createMultiBody(
            0, pybullet.createCollisionShape(pybullet.GEOM_PLANE, **at), **at)
        robot = pybullet.loadURDF(ROBOT, **at)
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.1] * 3, **at)
        box = pybullet.createMultiBody(0.5, shape, -1, [0.7, 0.1, 0.1], **at)
        names = [pybullet.getJointInfo(robot, joint, **at)[1].decode()
                 for joint in range(pybullet.getNumJoints(robot, **at))]
        return client, robot, box, tuple(map(names.index, WHEELS))

    def step(self, actions: np.ndarray) -> None:
        """One step of the environment in every world."""
        for (client, robot, box, wheels), (forward, turn) in zip(self._worlds, actions):
            at = {"physicsClientId": client}
            rates = [(0.5 * forward - 0.24 * turn) / 0.05, (0.5 * forward + 0.24 * turn) / 0.05]
            pybullet.setJointMotorControlArray(robot, wheels, pybullet.VELOCITY_CONTROL,
                                               targetVelocities=rates, forces=[2.0, 2.0], **at)
            for _ in range(INNER):
                pybullet.stepSimulation(**at)
            pybullet.getBasePositionAndOrientation(robot, **at)
            pybullet.getBaseVelocity(robot, **at)
            pybullet.getBasePositionAndOrientation(box, **at)

    def close(self) -> None:
        """End the clients."""
        for client, *_ in self._worlds:
            pybullet.disconnect(client)


def processor_time() -> float:
    """Of this process and of its children that run, s."""
    return processor([os.getpid(), *children(os.getpid())])


def measured(step: Callable[[np.ndarray], object], count: int) -> Tuple[float, float]:
    """Steps of single worlds a second of wall time, and processor time of one, s."""
    random = np.random.default_rng(1)
    steps, busy, started = 0, processor_time(), time.perf_counter()
    while time.perf_counter() - started < SECONDS:
        step(random.uniform(-1.0, 1.0, (count, 2)).astype(np.float32))
        steps += count
    return (steps / (time.perf_counter() - started), (processor_time() - busy) / steps)


def compare(count: int, answers: TextIO) -> None:
    """Write one row."""
    from my_simulations.gym import WorldVectorEnv
    from my_simulations.gym.push_box import make

    envs, bare = WorldVectorEnv([make] * count), Bare(count)
    try:
        envs.reset(seed=1)
        pairs = [(measured(envs.step, count), measured(bare.step, count)) for _ in range(PAIRS)]
    finally:
        envs.close()
        bare.close()
    (rate, used), (bare_rate, bare_used) = (np.median([pair[k] for pair in pairs], axis=0)
                                            for k in (0, 1))
    print(f"{count:3d} worlds: {rate:7.0f} steps/s, bare {bare_rate:7.0f}: {rate / bare_rate:.2f}"
          f" of bare (bar 0.7); processor time {1000 * used:.2f} ms a step,"
          f" bare {1000 * bare_used:.2f} ms", file=answers, flush=True)


if __name__ == "__main__":
    rows = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # PyBullet prints there, too
    for words in sys.argv[1:] or ["1", "8", "32"]:
        compare(int(words), rows)
