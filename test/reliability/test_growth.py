"""Models that come and go, and cameras that are watched now and then: nothing stays behind."""
from __future__ import annotations

import os
import tempfile
from typing import Dict, List

from ledger import descriptors, floating, memory, threads
from proofs import scaled

import my_simulations
from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder, Sphere
from my_simulations.geometry import Pose
from my_simulations.python_api.open_world import OpenWorld
from my_simulations.simulator.simulator import Simulator

SPAWNS = scaled(400, 10_000)
SUBSCRIPTIONS = scaled(60, 1000)
SETTLED = 0.25
"""Share of the cycles after which nothing may grow."""

SHAPES = 20

KEPT_KB = 2.0 + 0.6 * SHAPES
"""PyBullet keeps 1.4 kB of each removed body until the world is reset, and 0.4 kB of each shape of
its link (measured): it creates a compound for each body, and frees none.
"""

SLACK_MB = 4.0
"""A heap may still find its size."""

CAMERA = """<sdf version="1.7"><model name="watcher"><static>1</static><link name="link">
<sensor name="eye" type="camera"><update_rate>20</update_rate><camera>
<image><width>64</width><height>48</height></image></camera>
<plugin name="eye" filename="libgazebo_ros_camera.so"><cameraName>eye</cameraName></plugin>
</sensor></link></model></sdf>"""


def of_many_shapes() -> Model:
    """A moving link."""
    shapes = (Box((0.1, 0.1, 0.1)), Sphere(0.1), Cylinder(0.1, 0.1))
    return Model("model", Pose((0.0, 0.0, 5.0)), links=[Link(
        "link", inertial=Inertial(1.0),
        collisions=[Collision(f"c{number}", shapes[number % 3], Pose((0.3 * number, 0.0, 0.0)))
                    for number in range(SHAPES)])])


def files_of(pid: int) -> int:
    """Files in the temporary folder that a process has open or that its scratch folders hold."""
    below = [name for name in os.listdir(tempfile.gettempdir())
             if name.startswith("my_simulations_scratch_")]
    return descriptors(pid) + sum(
        len(files) for name in below
        for _, _, files in os.walk(os.path.join(tempfile.gettempdir(), name)))


def held(pids: List[int]) -> Dict[str, List[float]]:
    """Memory in MB, descriptors with files, and threads of each process."""
    return {"memory": [memory(pid) for pid in pids], "files": [files_of(pid) for pid in pids],
            "threads": [threads(pid) for pid in pids]}


def check_nothing_grew(before: Dict[str, List[float]], after: Dict[str, List[float]],
                       kept_mb: float = 0.0) -> None:
    """Compare what processes hold; `kept_mb`: memory that PyBullet never gives back."""
    for old, new in zip(before["memory"], after["memory"]):
        assert new < old + kept_mb + SLACK_MB, (before, after)
    for old, new in zip(before["files"], after["files"]):
        assert new <= old + 1, (before, after)  # one for a file that is just read
    for old, new in zip(before["threads"], after["threads"]):
        assert new <= old + 1, (before, after)


def test_models_of_many_shapes_come_and_go(record, monkeypatch, tmp_path):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    simulator = floating()
    try:
        simulator.clock.unpause()
        pids = [os.getpid(), simulator.engine_pid]
        spawn_and_delete(simulator, round(SETTLED * SPAWNS))
        before = held(pids)
        rest = SPAWNS - round(SETTLED * SPAWNS)
        spawn_and_delete(simulator, rest)
        after = held(pids)
        assert simulator.engine_pid == pids[1]
    finally:
        simulator.close()
    check_nothing_grew(before, after, KEPT_KB * rest / 1024)
    growth = [round(new - old, 1) for old, new in zip(before["memory"], after["memory"])]
    record("models come and go", cycles=SPAWNS, shapes=SHAPES, node_growth_mb=growth[0],
           engine_growth_mb=growth[1], files=after["files"][1] - before["files"][1])


def spawn_and_delete(simulator: Simulator, rounds: int) -> None:
    """Let a model come and go so many times."""
    for _ in range(rounds):
        simulator.models.spawn(of_many_shapes())
        simulator.models.delete("model")


def test_cameras_are_watched_now_and_then(record):
    with my_simulations.open_world() as world:
        world.spawn(CAMERA)
        (name,) = [topic for topic in world.topics if topic.endswith("image_raw")]
        watch(world, name, round(SETTLED * SUBSCRIPTIONS))
        pids = [os.getpid(), *children(os.getpid())]
        before = held(pids)
        watch(world, name, SUBSCRIPTIONS - round(SETTLED * SUBSCRIPTIONS))
        after = held(pids)
        assert pids == [os.getpid(), *children(os.getpid())]
    check_nothing_grew(before, after)
    growth = [round(new - old, 1) for old, new in zip(before["memory"], after["memory"])]
    record("a camera is watched now and then", cycles=SUBSCRIPTIONS, processes=len(pids),
           most_growth_mb=max(growth), most_files=max(
               new - old for old, new in zip(before["files"], after["files"])))


def watch(world: OpenWorld, name: str, cycles: int) -> None:
    """Begin to listen, wait for a picture, and stop, so many times."""
    for _ in range(cycles):
        topic = world.topics[name]
        assert topic.wait(5.0).height == 48
        topic.close()


def children(pid: int) -> List[int]:
    """Processes that this one has started and that live."""
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as stream:
        found = set(map(int, stream.read().split()))
    for task in os.listdir(f"/proc/{pid}/task"):
        with open(f"/proc/{pid}/task/{task}/children", encoding="ascii") as stream:
            found |= set(map(int, stream.read().split()))
    return sorted(found)
