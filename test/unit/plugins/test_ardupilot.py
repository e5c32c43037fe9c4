"""ArduPilot's interface, with an autopilot that a test plays over UDP."""
from __future__ import annotations

import math

import pytest
from autopilot import autopilot  # noqa: F401

from my_simulations.description.sensor import Sensor
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.flight.ardupilot import ArduPilot
from my_simulations.plugins.testing import FakeContext

CONTROL = ('<control channel="{}"><jointName>{}</jointName><type>{}</type><multiplier>{}'
           "</multiplier><offset>{}</offset>{}</control>")
DOWN = quat_from_rpy(math.pi, 0.0, 0.0)


@pytest.fixture
def vehicle(autopilot):
    made = []

    def one(controls, inside="", joints=("rotor", "flap"), imu="imu_sensor"):
        context = FakeContext(f"<plugin>{autopilot.ports}{controls}{inside}</plugin>",
                              joints=joints)
        context.model_sensors = [("imu_link", Sensor(imu, "imu", Pose(orientation=DOWN)))]
        made.append(ArduPilot(context))
        made[-1].load()
        return context

    yield one
    for plugin in made:
        plugin.close()


ROTOR = CONTROL.format(0, "rotor", "VELOCITY", 838, 0, "<rotorVelocitySlowdownSim>2"
                       "</rotorVelocitySlowdownSim><vel_p_gain>0.2</vel_p_gain><vel_cmd_max>2.5"
                       "</vel_cmd_max><vel_cmd_min>-2.5</vel_cmd_min>")


def test_a_packet_moves_joints_and_is_answered(vehicle, autopilot):
    context = vehicle(ROTOR + CONTROL.format(2, "flap", "POSITION", 0.5, -0.2, ""))
    context.advance(0.1)   # before any packet
    assert context.joints["rotor"].servo is None
    autopilot.send(0.5, 0.0, 0.8)
    context.advance(0.02)
    servo = context.joints["rotor"].servo
    assert (servo.target, servo.of_rate, servo.gains.p, servo.most_effort) == (
        pytest.approx(209.5), True, 0.2, 2.5)
    assert context.joints["flap"].servo.target == pytest.approx(0.3)
    time, *rest = autopilot.state()
    assert time == pytest.approx(0.12)
    gyro, acceleration, attitude = rest[:3], rest[3:6], rest[6:10]
    assert gyro == pytest.approx([0.0] * 3) and acceleration == pytest.approx([0.0, 0.0, -9.8])
    assert [abs(part) for part in attitude] == pytest.approx([0.0, 1.0, 0.0, 0.0], abs=1e-12)


def test_the_imu_of_a_nested_model_is_named_below_the_model_of_the_plugin(autopilot):
    context = FakeContext(f"<plugin>{autopilot.ports}<imuName>iris::imu_link::imu_sensor</imuName>"
                          "</plugin>")
    context.model_sensors = [(f"{scope}iris::imu_link", Sensor("imu_sensor", "imu",
                                                                Pose((place, 0.0, 0.0))))
                             for scope, place in (("other::", 1.0), ("drone::", 2.0))]
    context.scoped = lambda link: f"robot::drone::{link}"
    plugin = context.load(ArduPilot)
    assert plugin._imu._mount.position == (2.0, 0.0, 0.0)
    plugin.close()


def test_a_state_is_in_the_axes_north_east_down(vehicle, autopilot):
    context = vehicle(ROTOR, "<modelXYZToAirplaneXForwardZDown>0 0 0 3.141592653589793 0 0"
                             "</modelXYZToAirplaneXForwardZDown>")
    context.pose = Pose((1.0, 2.0, 3.0), quat_from_rpy(0.0, 0.0, 0.3))
    context.twist = Twist((0.1, 0.2, 0.3))
    context.link("imu_link").twist = Twist((0.0, 0.0, 0.0), (0.0, 0.0, 0.4))
    autopilot.send(0.0)
    context.advance(0.02)
    state = autopilot.state()
    assert state[1:4] == pytest.approx((0.0, 0.0, -0.4))          # about down
    w, x, y, z = state[7:11]
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert 2.0 * math.atan2(z, w) == pytest.approx(-0.3)          # clockwise from above
    assert state[11:14] == pytest.approx((0.1, -0.2, -0.3))
    assert state[14:17] == pytest.approx((1.0, -2.0, -3.0))


def test_the_world_waits_for_the_packet_of_each_step(vehicle, autopilot):
    context = vehicle(ROTOR)
    autopilot.send(0.1)
    context.advance(0.02)
    autopilot.state()
    for number in range(1, 4):
        autopilot.send(0.1 * number)
        context.advance(0.001)
        assert autopilot.state()[0] == pytest.approx(0.02 + 0.001 * number)
        assert context.joints["rotor"].servo.target == pytest.approx(41.9 * number, rel=1e-6)


def test_a_vehicle_whose_autopilot_is_gone_stops(vehicle, autopilot):
    context = vehicle(ROTOR, "<connectionTimeoutMaxCount>0</connectionTimeoutMaxCount>")
    autopilot.send(1.0)
    context.advance(0.02)
    context.advance(0.001)   # no packet comes
    assert context.joints["rotor"].servo.target == 0.0
    assert any("stopped sending packets" in text for text in context.log_messages)
    autopilot.send(0.5)      # a new one flies it again
    for _ in range(21):
        if context.joints["rotor"].servo.target == 0.0:
            context.advance(0.001)
    assert context.joints["rotor"].servo.target == pytest.approx(209.5)


def test_joints_without_a_loop_are_set(vehicle, autopilot):
    context = vehicle(CONTROL.format(0, "rotor", "VELOCITY", 10, 0, "<useForce>0</useForce>")
                      + CONTROL.format(1, "flap", "POSITION", 2, 0, "<useForce>0</useForce>"))
    autopilot.send(0.5, 0.25)
    context.advance(0.02)
    assert context.joints["rotor"].motor[0] == pytest.approx(5.0)
    assert context.joints["flap"].position == pytest.approx(0.5)


def test_faults_of_a_file_are_named(vehicle, autopilot):
    with pytest.raises(PluginError, match="imu named 'imu_sensor'"):
        vehicle(ROTOR, imu="other")
    context = vehicle(ROTOR)
    autopilot.send()
    context.advance(0.02)
    assert any("none for channel 0" in text for text in context.log_messages)
    with pytest.raises(PluginError, match="cannot listen"):
        vehicle(ROTOR)
