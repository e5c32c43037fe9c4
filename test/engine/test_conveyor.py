"""A belt on a prismatic joint carries bodies, against Coulomb's law."""
from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import box
from plugin_case import PluginCase, kept
from wheeled_robots import plugin

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
