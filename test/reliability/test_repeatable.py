"""The same world gives the same bits: in another process, after a reset, after a crash."""
from __future__ import annotations

import hashlib
import os
import signal
import struct
from typing import List

from editor_case import arm, box
from proofs import scaled
from waiting import until

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import Collision, Cylinder, Plane, Sphere
from my_simulations.description.world import World
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.geometry import Pose
from my_simulations.simulator.simulator import Simulator

STEPS = scaled(2000, 60000)
STRIDE = 100


def busy_world() -> World:
    """A heap that falls down, and arms that swing."""
    ground = Model("ground", static=True,
                   links=[Link("link", collisions=[Collision("c", Plane())])])
    shapes = [Sphere(0.3), Cylinder(0.3, 0.6)]
    models = [ground]
    for n in range(24):
        pose = Pose((0.4 * (n % 3), 0.37 * (n % 2), 0.6 + 0.7 * n),
                    (0.0, 0.3826834, 0.0, 0.9238795))
        inertial = Inertial(1.0, ixx=0.1, iyy=0.1, izz=0.1)
        if n % 3:
            links = [Link("link", inertial=inertial, collisions=[Collision("c", shapes[n % 2])])]
            models.append(Model(f"m{n}", pose, links=links))
        else:
            made = box(f"m{n}")
            models.append(Model(made.name, pose, links=made.links))
    for n in range(3):
        made = arm(f"arm{n}")
        models.append(Model(made.name, Pose((5.0 + 2 * n, 0.0, 2.0)), links=made.links,
                            joints=made.joints))
    return World(models=models)


def started() -> Simulator:
    simulator = Simulator(busy_world(), engine_factory=ProcessEngine, paused=True,
                          log=lambda issue: None)
    simulator.start()
    return simulator


def hashes(simulator: Simulator) -> List[str]:
    """Of the state after every STRIDE steps."""
    found = []
    for _ in range(STEPS // STRIDE):
        simulator.clock.advance(STRIDE)
        _, snapshot = simulator.states.fresh()
        data = struct.pack(f"{len(snapshot.links)}d", *snapshot.links) + struct.pack(
            f"{len(snapshot.joints)}d", *snapshot.joints)
        found.append(hashlib.sha256(data).hexdigest())
    return found


def test_runs_processes_resets_and_restarts_give_the_same_hashes(record):
    first = started()
    try:
        expected = hashes(first)
        assert len(set(expected)) > len(expected) // 2  # something moved
        first.resets.reset_simulation()
        assert hashes(first) == expected
        pid = first.engine_pid
        os.kill(pid, signal.SIGKILL)
        until(lambda: first.engine_pid not in (0, pid), "a new engine")
        first.resets.reset_simulation()
        assert hashes(first) == expected
    finally:
        first.close()
    second = started()
    try:
        assert hashes(second) == expected
    finally:
        second.close()
    record("reproducible", sim_seconds=STEPS / 1000, hashes=len(expected), runs=4,
           first=expected[0][:12], last=expected[-1][:12])
