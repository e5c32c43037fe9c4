"""A vehicle on a mast that rotors with lifting blades carry, flown over UDP as ArduPilot does."""
from __future__ import annotations

import math

import pytest
from autopilot import autopilot  # noqa: F401
from plugin_case import PluginCase, kept
from wheeled_robots import plugin

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.sensor import Sensor
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import Pose, quat_from_rpy

G, BODY, ROTOR, MOST_RATE = 9.8, 1.4, 0.05, 838.0
TOTAL = BODY + 2 * ROTOR
RADIUS, AREA, LIFT_SLOPE, ANGLE, DENSITY = 0.084, 0.002, 4.25, 0.3, 1.2041
# Lift of four blades, each 1/2 rho (omega r)^2 A c, divided by the square of the rate.
LIFT = 4 * 0.5 * DENSITY * RADIUS ** 2 * AREA * LIFT_SLOPE * ANGLE
DOWN = quat_from_rpy(math.pi, 0.0, 0.0)


@pytest.fixture
def case():
    yield from kept(lambda *models: PluginCase(
        World(models=list(models), gravity=(0.0, 0.0, -G)), BulletBackend))


def blade(link, side, way):
    return plugin("libLiftDragPlugin.so", (
        f"<link_name>{link}</link_name><air_density>{DENSITY}</air_density><area>{AREA}</area>"
        f"<cla>{LIFT_SLOPE}</cla><cda>0</cda><cma>0</cma><a0>{ANGLE}</a0><alpha_stall>1.4"
        f"</alpha_stall><cp>{side * RADIUS} 0 0</cp><forward>0 {side * way} 0</forward>"
        "<upward>0 0 1</upward>"))


def vehicle(ports):
    body = Link("base_link", inertial=Inertial(BODY, ixx=0.03, iyy=0.03, izz=0.06),
                sensors=[Sensor("imu_sensor", "imu", Pose(orientation=DOWN))])
    links, plugins, controls = [body], [], ""
    joints = [Joint("mast", "prismatic", "world", "base_link", axis=JointAxis((0.0, 0.0, 1.0)))]
    for number, way in enumerate((1.0, -1.0)):
        name = f"rotor_{number}"
        links.append(Link(name, Pose((0.0, 0.0, 0.1 * way)),
                          Inertial(ROTOR, ixx=1e-4, iyy=1e-4, izz=2e-4)))
        joints.append(Joint(f"{name}_joint", "continuous", "base_link", name,
                            axis=JointAxis((0.0, 0.0, 1.0))))
        plugins += [blade(name, side, way) for side in (1.0, -1.0)]
        controls += (f'<control channel="{number}"><jointName>{name}_joint</jointName>'
                     f"<multiplier>{way * MOST_RATE}</multiplier><p_gain>0.02</p_gain>"
                     "<cmd_max>2.5</cmd_max><cmd_min>-2.5</cmd_min></control>")
    plugins.append(plugin("libArduPilotPlugin.so", ports + controls + (
        "<modelXYZToAirplaneXForwardZDown>0 0 0 3.141592653589793 0 0"
        "</modelXYZToAirplaneXForwardZDown>")))
    return Model("copter", Pose((0.0, 0.0, 1.0)), links=links, joints=joints, plugins=plugins)


def test_an_autopilot_holds_a_height_by_the_states_it_receives(case, autopilot):
    one = case(vehicle(autopilot.ports))
    channel = math.sqrt(TOTAL * G / LIFT) / MOST_RATE
    autopilot.send(channel, channel)
    one.sim.clock.advance(20)   # the plugin finds the first packet
    state = autopilot.state()
    for _ in range(6000):
        height, rise = -state[16], -state[13]
        thrust = TOTAL * (G + 4.0 * (2.0 - height) - 3.0 * rise)
        channel = math.sqrt(max(0.0, thrust) / LIFT) / MOST_RATE
        autopilot.send(channel, channel)
        one.sim.clock.advance(1)
        state = autopilot.state()
    assert state[0] == pytest.approx(6.02, abs=1e-6)   # one packet for each step
    pose, _ = one.sim.states.model_state("copter")
    assert pose.position[2] == pytest.approx(2.0, abs=0.01)
    assert state[14:17] == pytest.approx((0.0, 0.0, -2.0), abs=0.01)
    assert state[4:7] == pytest.approx((0.0, 0.0, -G), abs=0.05)
    assert state[7:11] == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-3)
