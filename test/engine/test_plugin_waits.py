"""Drives stop the engine only while something changes, and move with the same bits in any run."""
from __future__ import annotations

import contextlib
from dataclasses import replace

import pytest
from conftest import ground
from plugin_case import PluginCase
from waiting import until
from wheeled_robots import axle, base, plugin, tricycle, wheel

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.sensor import ContactSensor, Imu, Ray, ScanAngles, Sensor
from my_simulations.description.shapes import Box, Collision, Sphere, Surface
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import Pose, Twist, quat_from_rpy


def kobuki():
    """Two driven wheels and two casters, with the sensors of a TurtleBot 2."""
    body = base(mass=3.0, z=0.05)
    body.collisions = [Collision(f"caster{n}", Sphere(0.02), Pose((x, 0.0, -0.029)),
                                 surface=Surface(mu=0.0, mu2=0.0))
                       for n, x in enumerate((0.12, -0.12))]
    down = Pose((0.1, 0.0, 0.0), quat_from_rpy(0.0, 1.5708, 0.0))
    body.sensors = [
        Sensor("imu", "imu", imu=Imu()), Sensor("bumpers", "contact", contact=ContactSensor()),
        *(Sensor(f"cliff_{side}", "ray", down, ray=Ray(
            ScanAngles(1), min_range=0.01, max_range=0.15)) for side in "lcr")]
    wheels = [wheel(f"wheel_{side}", 0.0, y, radius=0.035, mass=0.1)
              for side, y in (("left", 0.115), ("right", -0.115))]
    for one in wheels:
        one.sensors = [Sensor(f"drop_{one.name[6:]}", "contact", contact=ContactSensor())]
    names = {"robotNamespace": "/", "left_wheel_joint_name": "left_joint",
             "right_wheel_joint_name": "right_joint", "wheel_separation": "0.23",
             "wheel_diameter": "0.07", "torque": "18", "velocity_command_timeout": "0.3",
             "imu_name": "imu", "bumper_name": "bumpers", "publish_tf": "1",
             "cliff_sensor_left_name": "cliff_l", "cliff_sensor_center_name": "cliff_c",
             "cliff_sensor_right_name": "cliff_r", "cliff_detection_threshold": "0.04",
             "wheel_drop_left_sensor_name": "drop_left",
             "wheel_drop_right_sensor_name": "drop_right"}
    return Model("kobuki", links=[body, *wheels],
                 joints=[axle("left_joint", "wheel_left"), axle("right_joint", "wheel_right")],
                 plugins=[plugin("libgazebo_ros_kobuki.so", "".join(
                     f"<{name}>{value}</{name}>" for name, value in names.items()))])


def diff_drive(inside):
    """Two driven wheels and a caster."""
    body = base(mass=3.0, z=0.1)
    body.collisions = [Collision("caster", Sphere(0.05), Pose((-0.15, 0.0, -0.05)),
                                 surface=Surface(mu=0.0, mu2=0.0))]
    return Model("robot", links=[body, wheel("l", 0.0, 0.17), wheel("r", 0.0, -0.17)],
                 joints=[axle("left_joint", "l"), axle("right_joint", "r")],
                 plugins=[plugin("libgazebo_ros_diff_drive.so", "<commandTopic>cmd_vel"
                                 "</commandTopic><wheelSeparation>0.34</wheelSeparation>"
                                 f"<wheelDiameter>0.2</wheelDiameter>{inside}")])


def moved(library, inside, z=0.1):
    """A box of 0.2 m at a height of its centre, with a plugin."""
    return Model("box", links=[Link("link", Pose((0.0, 0.0, z)), Inertial(
        2.0, Pose((0.01, 0.0, 0.0)), ixx=0.01, iyy=0.01, izz=0.01), [
            Collision("c", Box((0.2, 0.2, 0.2)))])], plugins=[plugin(library, inside)])


def thrown(library, inside):
    """A box in the air that no command reaches."""
    return moved(library, f"{inside}<bodyName>link</bodyName><link_name>link</link_name>", 20.0)


def with_flap():
    """A thrown box with a wing, whose flap swings on a spring."""
    model = thrown("libLiftDragPlugin.so", "<area>0.1</area><cp>-0.05 0 0</cp>"
                   "<control_joint_name>flap_joint</control_joint_name>")
    model.links.append(Link("flap", Pose((-0.2, 0.0, 20.0)), Inertial(
        0.05, Pose((-0.05, 0.0, 0.0)), ixx=1e-4, iyy=1e-4, izz=1e-4)))
    model.joints.append(Joint("flap_joint", "revolute", "link", "flap", axis=JointAxis(
        (0.0, 1.0, 0.0), spring_stiffness=0.05, spring_reference=0.3, damping=0.005)))
    return model


ROBOTS = {"diff drive": (diff_drive("<wheelAcceleration>0.5</wheelAcceleration>"),
                         "robot/cmd_vel"),
          "kobuki": (kobuki(), "mobile_base/commands/velocity"),
          "tricycle": (tricycle("<steeringSpeed>1</steeringSpeed>"), "tricycle/cmd_vel"),
          "tricycle at once": (tricycle("<wheelAcceleration>2</wheelAcceleration>"),
                               "tricycle/cmd_vel"),
          "planar": (moved("libgazebo_ros_planar_move.so", "<cmdTimeout>0.3</cmdTimeout>"),
                     "cmd_vel"),
          "forces": (moved("libridgeback_ros_force_based_move.so", "<cmdVelTimeOut>0.3"
                           "</cmdVelTimeOut><x_velocity_p_gain>500</x_velocity_p_gain>"
                           "<y_velocity_p_gain>500</y_velocity_p_gain>"
                           "<yaw_velocity_p_gain>1</yaw_velocity_p_gain>"), "cmd_vel"),
          "wing": (thrown("libLiftDragPlugin.so", "<area>0.1</area><cla>4</cla>"
                          "<a0>0.1</a0><cp>-0.05 0 0</cp>"), ""),
          "rudder": (with_flap(), ""),
          "hull": (thrown("libBuoyancyPlugin.so", "<fluid_density>200</fluid_density>"), "")}
EXPIRES = ("kobuki", "planar", "forces")
POLLS = ("hull",)   # looks for another gravity 10 times a second


class Case(PluginCase):
    """A robot on the ground; without subscribers unless `heard`."""

    def __init__(self, name, heard=True):
        model, self.topic = ROBOTS[name]
        self.model = model.name
        super().__init__(World(models=[ground(mu=1.0), model]), BulletBackend)
        if not heard:
            for topic in {topic for topic, _ in self.graph.sent} | set(self.offered()):
                self.graph.listen(topic, wanted=False)

    def offered(self):
        """All topics of the plugins."""
        return [use.name for use in self.host.topic_uses()] + ["/tf"]

    def command(self, x, turn):
        """Send a command, if the robot takes any; returns when the plugin has received it."""
        if not self.topic:
            return
        topic = next(one for one in self.graph.heard if one.strip("/") == self.topic)
        self.deliver(topic, linear={"x": x, "y": 0.0}, angular={"z": turn})

    def drive(self, at_once):
        """Drive a curve, then another one; the states of all links and joints at the end."""
        for x, turn in ((0.3, 0.4), (0.1, -0.2)):
            self.command(x, turn)
            for _ in range(600 // at_once):
                self.sim.clock.advance(at_once)
        return self.states()

    @property
    def speed(self):
        """Of the robot, m/s."""
        return self.sim.states.model_state(self.model)[1].linear[0]

    def states(self):
        """The bits of all links and joints."""
        _, snapshot = self.sim.states.fresh()
        return bytes(snapshot.links), bytes(snapshot.joints)


@contextlib.contextmanager
def running(name, heard=True):
    """A case; there can be one at a time in a process."""
    made = Case(name, heard)
    try:
        yield made
    finally:
        made.close()


@pytest.fixture(scope="module", params=ROBOTS)
def driven(request):
    """The name of a robot, and its states after a drive in the smallest portions."""
    with running(request.param) as one:
        return request.param, one.drive(5)


def test_a_drive_moves_with_the_same_bits_in_any_portions_and_without_subscribers(driven):
    name, states = driven
    with running(name, heard=False) as one:
        assert one.drive(600) == states


def test_a_drive_after_a_reset_moves_as_at_the_start(driven):
    name, states = driven
    with running(name) as one:
        one.drive(300)
        one.sim.resets.reset_simulation()
        one.sim.clock.advance(0)
        assert one.drive(300) == states


def test_the_engine_does_not_wait_for_a_drive_that_has_reached_its_command(driven):
    with running(driven[0]) as one:
        one.drive(600)
        until(lambda: one.host._schedule.next_step is None or driven[0] in POLLS
              and one.host._schedule.next_step >= one.sim.clock.step + 100)


def test_the_engine_does_not_wait_for_a_drive_that_accelerates():
    with running("diff drive", heard=False) as one:
        one.command(0.4, 0.0)
        one.sim.clock.advance(400)
        assert 0.15 < one.speed < 0.25
        assert one.host._schedule.next_step is None


@pytest.mark.parametrize("name", EXPIRES)
def test_a_command_expires_also_if_the_step_size_has_changed(name):
    with running(name) as one:
        one.command(0.3, 0.0)
        one.sim.clock.advance(100)
        assert one.speed > 0.2
        physics = one.sim.physics
        physics.set(replace(physics.settings, max_step_size=0.002), physics.gravity)
        one.sim.clock.advance(300)
        assert one.speed < 0.05


def test_a_wing_follows_its_rudder_also_after_an_edit():
    """Lift of 4 / rad, 1.2041 kg/m^3, 0.1 m^2 and 10 m/s; the box turns, too, about its mass."""
    with running("rudder") as one:
        for happens in (lambda: None, lambda: one.sim.models.set_link_inertial(
                "box::link", Inertial(2.0, ixx=0.01, iyy=0.01, izz=0.01))):
            happens()
            climbs = []
            for angle in (0.0, 0.2):
                one.sim.joints.set_positions({"box::flap_joint": angle})
                one.sim.states.set_model_state(one.model, Pose((0.0, 0.0, 20.0)), Twist(
                    (10.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
                one.sim.clock.advance(1)
                climbs.append(sum(mass * one.sim.states.link_state(f"box::{link}")[1].linear[2]
                                  for link, mass in (("link", 2.0), ("flap", 0.05))))
            lift = (climbs[1] - climbs[0]) / 0.001
            assert lift == pytest.approx(0.2 * 4.0 * 0.5 * 1.2041 * 10.0 ** 2 * 0.1, rel=0.25)
