"""The walks of the architecture page are what the simulator does, from its first stop on."""
from __future__ import annotations

import pathlib
import sys
import threading
from contextlib import contextmanager

from architecture_walks import walks
from inline_engine import InlineEngine
from running_simulator import started

import my_simulations
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.formats.mesh.loading import collision_meshes
from my_simulations.formats.reading import parse_document
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.spawn_advice import placement_warnings
from my_simulations.simulator.world_loading import start_world

SOURCE = str(pathlib.Path(my_simulations.__file__).parent) + "/"
SHIPPED = pathlib.Path(__file__).resolve().parents[2] / "models"

ELSEWHERE = ("ros/", "engine/process_engine")
"""Stops that need ROS, or the engine in its own process."""

INERTIAL = ('<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
            "</inertial>")
ROBOT = f"""<robot name="robot">
<link name="base">{INERTIAL}<collision><geometry><box size="1 1 1"/></geometry></collision></link>
<link name="arm">{INERTIAL}</link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="9" velocity="9"/></joint></robot>"""


@contextmanager
def recorded():
    """(module, function) of every call inside, in the threads that it starts as well."""
    calls = set()

    def profile(frame, event, _argument):
        file = frame.f_code.co_filename
        if event == "call" and file.startswith(SOURCE):
            calls.add((file[len(SOURCE):-len(".py")], frame.f_code.co_name))

    threading.setprofile(profile)
    sys.setprofile(profile)
    try:
        yield calls
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]


def left_out(title, calls):
    """The stops of a walk that were not called."""
    (rows,) = (walk.rows for walk in walks() if walk.title == title)
    stops = {(module, name) for module, names in rows for name in names
             if not module.startswith(ELSEWHERE)}
    assert len(stops) > 5
    return sorted(stops - calls)


def engine():
    return InlineEngine(BulletBackend)


def test_a_spawn_passes_the_stops_of_its_walk():
    with recorded() as calls:
        simulator = started(World("w"), engine=engine, log=print)
        model, issues = parse_document(ROBOT, Resolver([]), "robot").read_entity()
        assert issues == []
        meshes, _ = collision_meshes(model)
        simulator.models.spawn(model, meshes=meshes)
        placement_warnings(simulator, "robot", meshes)
        simulator.close()
    assert left_out("A spawn, from ROS to PyBullet and back", calls) == []


def test_a_world_with_an_include_passes_the_stops_of_its_walk(tmp_path):
    world = tmp_path / "a.world"
    world.write_text('<sdf version="1.6"><world name="w"><include><uri>model://table</uri>'
                     "</include></world></sdf>")
    with recorded() as calls:
        start_world(str(world), Resolver([str(SHIPPED)]), engine, print).close()
    assert left_out("A world with an include", calls) == []


def test_a_timed_joint_effort_passes_the_stops_of_its_walk():
    with recorded() as calls:
        simulator = started(World("w"), engine=engine, log=print)
        model, _ = parse_document(ROBOT, Resolver([]), "robot").read_entity()
        simulator.models.spawn(model)
        calls.clear()
        simulator.wrenches.apply_effort("hinge", 1.0, start_ns=0, duration_ns=10 ** 7)
        before = simulator.clock.step
        simulator.feed.request("test", states_hz=1000.0, poses_hz=0.0, notify=True)
        simulator.clock.unpause()
        while simulator.clock.step < before + 20:
            assert simulator.clock.wait_step(simulator.clock.step, 20.0)
        simulator.close()
    assert left_out("A timed joint effort", calls) == []
