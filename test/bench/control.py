#!/usr/bin/env python3
"""Prints what servos and controllers cost. Run it in a shell that has sourced the workspace.

usage: control.py [ROW …]   rows: axis robots (default: all)

Nothing here fails on a slow machine.
"""
from __future__ import annotations

import os
import statistics
import sys
import time
from typing import Callable, Dict, List, Sequence, Tuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, __file__.rsplit("/", 2)[0] + "/unit/plugins")
sys.path.insert(0, __file__.rsplit("/", 2)[0] + "/unit/support")
import pybullet
from plugin_graph import Graph
from robot_control import transmission
from row_table import Row, Rows, shown
from server import processor

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.commands import LoadModel, PhysicsSettings
from my_simulations.engine.drive_commands import JointServo, PidGains, SetServos
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.engine.spline import Spline, segment_between
from my_simulations.geometry import Pose
from my_simulations.plugins.host import PluginHost
from my_simulations.plugins.registry import PluginRegistry
from my_simulations.plugins.testing import Message
from my_simulations.simulator.simulator import Simulator

AXES, STEPS, ROUNDS = 6, 1500, 5
ROBOTS, SECONDS = 10, 10.0
PLUGIN = PluginSpec("control", "libgazebo_ros_control.so", "<plugin/>")


def arm(name: str, axes: int) -> Model:
    """A chain of links on the world, with a transmission for each joint."""
    links = [Link(f"link_{n}", Pose((0.0, 0.0, 0.1 * n)),
                  Inertial(1.0, Pose((0.0, 0.0, 0.05)), 0.01, 0, 0, 0.01, 0, 0.01))
             for n in range(axes)]
    joints = [Joint(f"joint_{n}", "revolute", f"link_{n - 1}" if n else "world", f"link_{n}",
                    axis=JointAxis((0.0, float(n % 2), float(1 - n % 2)))) for n in range(axes)]
    return Model(name, links=links, joints=joints, plugins=[PLUGIN], transmissions=[
        transmission(joint.name, "hardware_interface/EffortJointInterface") for joint in joints])


def _steps(servos: Sequence[JointServo]) -> Callable[[], Tuple[float, float]]:
    """Microseconds of processor a step, in the one engine that a process may have.

    And those of PyBullet's step alone, with the motors as they are set then.
    """
    def measure() -> Tuple[float, float]:
        backend.apply(SetServos(tuple(JointServo(n, "") for n in range(AXES))))
        if servos:
            backend.apply(SetServos(tuple(servos)))
        backend.step(0, 200)
        begin = time.process_time()
        backend.step(200, STEPS)
        between = time.process_time()
        for _ in range(STEPS):
            pybullet.stepSimulation()
        return ((between - begin) / STEPS * 1e6,
                (time.process_time() - between) / STEPS * 1e6)
    return measure


backend = BulletBackend()


def axis() -> List[Row]:
    backend.configure(PhysicsSettings())
    backend.apply(LoadModel(1, arm("arm", AXES), Pose(), 0, 0))
    gains = PidGains(100.0, 10.0, 10.0, -10.0, 10.0)
    spline = Spline((segment_between(0.0, (0.0, 0.0, 0.0), 60.0, (1.0, 0.0, 0.0)),))
    kinds: Dict[str, Sequence[JointServo]] = {
        "a position that is held": [JointServo(n, "position", 0.1) for n in range(AXES)],
        "a PID loop": [JointServo(n, "effort", 0.1, gains=gains) for n in range(AXES)],
        "a position along a spline": [JointServo(n, "position", spline=spline)
                                      for n in range(AXES)],
        "a PID loop along a spline": [JointServo(n, "effort", spline=spline, gains=gains,
                                                 by_rates=True) for n in range(AXES)],
    }
    idle, found = _steps([]), []
    for what, servos in kinds.items():
        busy = _steps(servos)
        pairs = [(busy(), idle()) for _ in range(ROUNDS)]
        cost, bullet = (statistics.median(one[n] - other[n] for one, other in pairs) / AXES
                        for n in (0, 1))
        # A motor is a row of Bullet's solver in each of its iterations: no loop of ours.
        bar = "3 µs" if "PID" in what else "–"
        found.append((f"{what}, an axis of {AXES} a step",
                      f"{cost:.2f} µs, {max(0.0, bullet):.2f} in PyBullet", bar,
                      bar == "–" or cost <= 3.0))
    return found


class Parameters(Graph):
    """A graph on which controllers are described."""

    def parameter(self, namespace: str, name: str, default: object) -> object:
        names = [f"joint_{n}" for n in range(AXES)]
        return {
            "states/type": "joint_state_controller/JointStateController",
            "states": {"publish_rate": 50},
            "arm/type": "effort_controllers/JointTrajectoryController",
            "arm": {"joints": names, "action_monitor_rate": 100, "gains": {
                one: {"p": 100.0, "d": 10.0} for one in names}},
        }.get(name, default)


def robots() -> List[Row]:
    """Arms that follow goals: joint states at 50 Hz, tolerances and feedback at 100 Hz."""
    graph = Parameters()
    sim = Simulator(World(models=[arm(f"arm_{n}", AXES) for n in range(ROBOTS)]),
                    engine_factory=ProcessEngine, log=lambda issue: None)
    sim.start()
    host = PluginHost(sim, graph, PluginRegistry(), lambda issue: None)
    host.start()
    try:
        pids = [os.getpid(), sim.engine_pid]
        time.sleep(1.0)
        idle, _ = _shares(sim, pids)
        for n in range(ROBOTS):
            for name in ("states", "arm"):
                graph.heard[f"arm_{n}/controller_manager/load_controller"](
                    Message(name=name), Message())
            graph.heard[f"arm_{n}/controller_manager/switch_controller"](
                Message(start_controllers=["states", "arm"], stop_controllers=[], strictness=2),
                Message())
            graph.heard[f"arm_{n}/arm/follow_joint_trajectory/goal"](goal())
        busy, factor = _shares(sim, pids)
        goals = sum(topic.endswith("/feedback") for topic, _ in graph.sent)
    finally:
        host.stop()
        sim.close()
    node, engine = (100.0 * (b - i) for b, i in zip(busy, idle))
    return [(f"{ROBOTS} arms of {AXES} axes on trajectories, 100 Hz: real-time factor",
             f"{factor:.2f}", "1", factor > 0.98),
            (f"{ROBOTS} arms, of a core: controllers / loops of {ROBOTS * AXES} axes",
             f"{node:.0f} % / {engine:.0f} %", "–", goals > 0)]


class Span:
    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def to_sec(self) -> float:
        return self._seconds

    def to_nsec(self) -> int:
        return round(self._seconds * 1e9)


def goal() -> Message:
    point = Message(positions=[0.3] * AXES, velocities=[0.0] * AXES, accelerations=[],
                    time_from_start=Span(10.0 * SECONDS))
    return Message(goal_id=Message(id="goal", stamp=Span(0.0)), goal=Message(
        trajectory=Message(header={"stamp": Span(0.0)}, points=[point],
                           joint_names=[f"joint_{n}" for n in range(AXES)]),
        path_tolerance=[], goal_tolerance=[], goal_time_tolerance=Span(0.0)))


def _shares(sim: Simulator, pids: List[int]) -> Tuple[List[float], float]:
    """What each process uses of a core, and the real-time factor."""
    used, begin, sim_ns = [processor([pid]) for pid in pids], time.monotonic(), sim.clock.sim_ns
    time.sleep(SECONDS)
    span = time.monotonic() - begin
    return ([(processor([pid]) - before) / span for pid, before in zip(pids, used)],
            (sim.clock.sim_ns - sim_ns) * 1e-9 / span)


ROWS: Rows = {"axis": axis, "robots": robots}


if __name__ == "__main__":
    shown(ROWS)
