"""Plugins follow changes of gravity and wind in the next step, without stopping the engine.
"""
from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conftest import box
from plugin_case import PluginCase, kept
from waiting import until
from wheeled_robots import plugin

from my_simulations.description.surroundings import Wind
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import ZERO3, norm, subtract
from my_simulations.plugins.testing import Message


@pytest.fixture
def case():
    def make(*models, gravity=ZERO3, parameters=None):
        return PluginCase(World(models=list(models), gravity=gravity), BulletBackend,
                          parameters=parameters)

    yield from kept(make)


def speed(one, name):
    return one.sim.states.model_state(name)[1].linear[2]


def test_a_hull_follows_another_gravity_in_the_next_step(case):
    hull = box("hull", 0.5, 0.5 ** 3 * 800.0)
    hull.plugins = [plugin("libBuoyancyPlugin.so", "<fluid_density>800</fluid_density>")]
    one = case(hull, gravity=(0.0, 0.0, -9.8))
    one.sim.clock.advance(7)
    physics = one.sim.physics
    physics.set(physics.settings, (0.0, 0.0, -1.6))
    one.sim.clock.advance(7)
    assert abs(speed(one, "hull")) < 1e-9
    until(lambda: one.host._schedule.next_step is None)


def test_drag_follows_another_wind_in_the_next_step(case):
    """C v |v| with C = 0.5 N s^2/m^2, 2 kg and a wind of 3 m/s."""
    drone = box("drone", 0.2, 2.0)
    drone.plugins = [plugin("libhector_gazebo_quadrotor_aerodynamics.so",
                            "<robotNamespace>/</robotNamespace>")]
    names = {"C_wxy": 0.5, "C_wz": 0.5, "C_mxy": 0.0, "C_mz": 0.0}
    one = case(drone, parameters={"quadrotor_aerodynamics": names})
    one.sim.clock.advance(7)
    one.sim.scene.set_field("wind", Wind((0.0, 0.0, 3.0)))
    one.sim.clock.advance(1)
    assert speed(one, "drone") == pytest.approx(0.001 * 0.5 * 9.0 / 2.0, rel=1e-6)


def test_a_hand_pulls_a_link_to_its_frame(case):
    """A critically damped spring: x = X (1 - (1 + w t) exp(-w t)), w = sqrt(k / m)."""
    held = box("held", 0.2, 2.0)
    held.plugins = [plugin("libgazebo_ros_hand_of_god.so",
                           "<linkName>link</linkName><kl>50</kl>")]
    one = case(held, gravity=(0.0, 0.0, -9.8))
    one.sim.clock.advance(500)
    assert norm(one.sim.states.model_state("held")[0].position) < 1e-9
    still = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    one.deliver("/tf", transforms=[Message(
        header={"frame_id": "world"}, child_frame_id="hog_desired",
        transform={"translation": {"x": 1.0, "y": 0.0, "z": 0.0}, "rotation": still})])
    one.sim.clock.advance(400)
    at = one.sim.states.model_state("held")[0].position
    turn = 5.0 * 0.4
    assert norm(subtract(at, (1.0 - (1.0 + turn) * math.exp(-turn), 0.0, 0.0))) < 2e-3
    physics = one.sim.physics
    physics.set(replace(physics.settings, max_step_size=0.002), (0.0, 0.0, -1.6))
    one.sim.clock.advance(2000)
    at = one.sim.states.model_state("held")[0].position
    assert norm(subtract(at, (1.0, 0.0, 0.0))) < 1e-4
    until(lambda: one.host._schedule.next_step is None)
