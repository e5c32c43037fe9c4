"""A world that ran in the engine, saved and loaded, goes on where it was."""
from __future__ import annotations

from functools import partial

import pytest
import running_simulator
from plugin_case import kept

from my_simulations.description.compare import differences
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.formats.reading import parse_world, read_world
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator.saving import present_world, save_world

TENSOR = "<inertia><ixx>0.0167</ixx><iyy>0.0167</iyy><izz>0.0167</izz></inertia>"
INERTIAL = f"<inertial><mass>1</mass>{TENSOR}</inertial>"
MIDDLE = f"<inertial><pose>0.2 0 0 0 0 0</pose><mass>1</mass>{TENSOR}</inertial>"
SHAPE = '<collision name="c"><geometry><box><size>0.3 0.2 0.1</size></box></geometry></collision>'
WORLD = f"""<sdf version="1.7"><world name="lab">
  <model name="ground"><static>1</static><link name="l"><collision name="c"><geometry><plane/>
    </geometry></collision></link></model>
  <model name="tumbling"><pose>0 0 0.6 0.3 0.5 0.7</pose><link name="l">{INERTIAL}{SHAPE}</link>
  </model>
  <model name="pair"><pose>3 0 0.2 0 0 0.4</pose><link name="a">{INERTIAL}{SHAPE}</link>
    <link name="b"><pose>0 1 0.3 0 0 0</pose>{INERTIAL}{SHAPE}</link></model>
  <model name="pendulum"><pose>-3 0 2 0 0 0.2</pose>
    <link name="base"><inertial><mass>5</mass>{TENSOR}</inertial></link>
    <link name="arm">{MIDDLE}</link>
    <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
    <joint name="hinge" type="revolute"><parent>base</parent><child>arm</child>
      <axis><xyz>0 1 0</xyz><dynamics><damping>0.05</damping></dynamics></axis></joint></model>
  <model name="outer"><pose>6 0 0.3 0 0 0</pose><link name="l">{INERTIAL}{SHAPE}</link>
    <model name="inner"><pose>0 1 0.1 0 0 0.3</pose><link name="l">{INERTIAL}{SHAPE}</link></model>
  </model></world></sdf>"""


@pytest.fixture
def started():
    yield from kept(partial(running_simulator.started, backend=BulletBackend,
                            log=lambda issue: pytest.fail(str(issue))))


@pytest.mark.parametrize("steps", [0, 1, 217, 1500])
def test_load_run_save_load_gives_the_same_poses_and_description(steps, started, tmp_path):
    world, issues = parse_world(WORLD, Resolver())
    assert not issues
    first = started(world)
    if steps:
        first.clock.advance(steps)
    path = save_world(first, "s.world", roots=[str(tmp_path)], state=True)
    loaded = read_world(path, Resolver())
    read, issues = loaded.world, loaded.issues
    assert not issues
    second = started(read)
    before, after = first.feed.states()[0], second.feed.states()[0]
    assert before.link_names == after.link_names
    for name in before.model_names:
        assert differences(first.states.model_state(name)[0],
                           second.states.model_state(name)[0], 1e-6) == []
    for name in before.link_names:
        assert differences(first.states.link_state(name)[0],
                           second.states.link_state(name)[0], 1e-6) == []
    assert second.clock.sim_ns == first.clock.sim_ns
    for name in ("tumbling::l", "pair::b"):
        assert (differences(first.states.link_state(name)[1].linear,
                            second.states.link_state(name)[1].linear, 1e-6) == [])
    # The description is the one that was loaded, but for where things are.
    with open(path, "rb") as file:
        written, _ = parse_world(file.read(), Resolver(), path)
    assert differences(present_world(first).models, written.models, 1e-9) == []
    assert differences(first.joints.states("hinge")[0][0],
                       second.joints.states("hinge")[0][0], 1e-6) == []


def test_a_world_saved_without_its_state_has_the_same_configuration_at_time_0(started, tmp_path):
    first = started(parse_world(WORLD, Resolver())[0])
    first.clock.advance(1500)
    path = save_world(first, "s.world", roots=[str(tmp_path)])
    second = started(read_world(path, Resolver()).world)
    for name in first.feed.states()[0].link_names:
        assert differences(first.states.link_state(name)[0],
                           second.states.link_state(name)[0], 1e-6) == []
    assert second.clock.sim_ns == 0
    assert second.states.link_state("tumbling::l")[1].linear == (0.0, 0.0, 0.0)


def test_saving_twice_gives_the_same_bytes(started, tmp_path):
    sim = started(parse_world(WORLD, Resolver())[0])
    sim.clock.advance(321)
    one, two = (save_world(sim, name, roots=[str(tmp_path)]) for name in ("a.sdf", "b.sdf"))
    with open(one, "rb") as first, open(two, "rb") as second:
        assert first.read() == second.read()
