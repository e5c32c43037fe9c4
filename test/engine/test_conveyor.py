"""A belt on a prismatic joint carries bodies, against Coulomb's law."""
from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import box
from plugin_case import PluginCase, kept
from wheeled_robots import plugin

import my_simulations
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Surface
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import Pose

TOP, MU, G = 0.9, 0.4, 9.8


def belt(velocity, power):
    """A belt of 10 m along x that can move by 1 m, as that of the ARIAC competition."""
    link = Link("belt", inertial=Inertial(100.0, ixx=4.0, iyy=800.0, izz=800.0), collisions=[
        Collision("c", Box((10.0, 0.6, 0.006)), surface=Surface(mu=MU, mu2=MU))])
    joint = Joint("belt_joint", "prismatic", "world", "belt",
                  axis=JointAxis((1.0, 0.0, 0.0), lower=0.0, upper=1.0))
    return Model("conveyor", Pose((4.5, 0.0, TOP - 0.003)), links=[link], joints=[joint], plugins=[
        plugin("libROSConveyorBeltPlugin.so", f"<max_velocity>{velocity}</max_velocity>"
               f"<power>{power}</power><link>conveyor::belt</link>")])


@pytest.fixture
def case():
    def make(step_size, velocity, power=0.0):
        part = replace(box("part", size=0.1), pose=Pose((0.0, 0.0, TOP + 0.05)))
        one = PluginCase(World(models=[belt(velocity, power), part], gravity=(0.0, 0.0, -G)),
                         BulletBackend)
        physics = one.sim.physics
        physics.set(replace(physics.settings, max_step_size=step_size), physics.gravity)
        return one

    yield from kept(make)


@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005, 0.01])
def test_a_belt_carries_a_part_at_its_speed_also_where_it_jumps_back(case, step_size):
    one = case(step_size, 0.2, power=100.0)
    one.sim.clock.advance(round(1.0 / step_size))
    before = one.sim.states.model_state("part")[0].position
    one.sim.clock.advance(round(20.0 / step_size))   # four times the way of the joint
    pose, twist = one.sim.states.model_state("part")
    assert pose.position == pytest.approx((before[0] + 4.0, 0.0, TOP + 0.05), abs=0.004)
    assert twist.linear[0] == pytest.approx(0.2, rel=0.01)
    assert 0.0 <= one.sim.joints.states("conveyor::belt_joint")[0][0] <= 1.0


def test_a_part_on_a_fast_belt_is_accelerated_by_friction(case):
    one = case(0.001, 2.0)
    one.sim.clock.advance(500)
    assert one.ask("conveyor/control", power=100.0).success
    one.sim.clock.advance(300)
    speed = one.sim.states.model_state("part")[1].linear[0]
    assert speed == pytest.approx(MU * G * 0.3, rel=0.02)
    assert one.ask("conveyor/control", power=50.0).success
    assert not one.ask("conveyor/control", power=101.0).success
    one.sim.clock.advance(500)
    assert one.sim.states.model_state("part")[1].linear[0] == pytest.approx(1.0, rel=0.01)
    assert one.graph.on("conveyor/state")[-1].power == 50.0


BELT = """<sdf version="1.7"><world name="w">
<physics type="ode"><max_step_size>0.001</max_step_size></physics>
<model name="conveyor"><pose>0 0 0.9 0 0 0</pose><link name="belt"><inertial><mass>100</mass>
<inertia><ixx>4</ixx><iyy>800</iyy><izz>800</izz></inertia></inertial>
<collision name="c"><geometry><box><size>10 0.6 0.006</size></box></geometry></collision>
</link><joint name="belt_joint" type="prismatic"><parent>world</parent><child>belt</child>
<axis><xyz>1 0 0</xyz><limit><lower>0</lower><upper>1</upper></limit></axis></joint>
<plugin name="belt" filename="libbelt.so"/></model>
<model name="part"><pose>2 0 0.953 0 0 0</pose><link name="l"><inertial><mass>1</mass>
<inertia><ixx>0.0017</ixx><iyy>0.0017</iyy><izz>0.0017</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.1 0.1 0.1</size></box></geometry></collision></link>
</model></world></sdf>"""


def test_a_surface_of_a_plugin_carries_a_part_backwards(tmp_path, monkeypatch):
    (tmp_path / "backwards.py").write_text(
        "from my_simulations.plugins.base import Plugin\n"
        "from my_simulations.plugins.moving_surface import MovingSurface\n"
        "class Backwards(Plugin):\n"
        "    def load(self):\n"
        "        MovingSurface(self.context, 'belt_joint').set_velocity(-0.4)\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "belt.world").write_text(BELT)
    with my_simulations.open_world(tmp_path / "belt.world",
                                   plugins={"libbelt.so": "backwards:Backwards"}) as world:
        world.step(1000)
        before = world.states().pose["part"][0]
        world.step(5000)        # twice the way of the joint
        assert not world.issues
        assert world.states().pose["part"][0] == pytest.approx(before - 2.0, abs=0.01)
        assert world.states().twist["part"][0] == pytest.approx(-0.4, rel=0.02)
