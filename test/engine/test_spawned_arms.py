"""Arms stay as they were spawned until their controllers start, in a world that runs."""
from __future__ import annotations

import pytest
from conftest import ground
from plugin_case import kept
from plugin_graph import Graph
from running_simulator import started
from waiting import until

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.transmission import Transmission, TransmissionJoint
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.ring import HEARTBEAT
from my_simulations.geometry import Pose
from my_simulations.plugins.base import Plugin
from my_simulations.plugins.control.gazebo_ros_control import PATIENCE_S, GazeboRosControl
from my_simulations.plugins.host import PluginHost
from my_simulations.plugins.registry import PluginRegistry
from my_simulations.plugins.testing import Message

CONTROL = "libgazebo_ros_control.so"
NAMES = [f"joint{n}" for n in range(6)]
INTERFACES = ["PositionJointInterface", "VelocityJointInterface", "EffortJointInterface"]
SEEN = []


class Watched(GazeboRosControl):
    """Notes the positions of all joints at its start and after each step."""

    def load(self):
        super().load()
        self.note()
        self.context.every(0.0, self.note)

    def note(self):
        SEEN.append([self.context.joint(name).position for name in NAMES])


class Slow(Watched):
    """Loads after the engine has looked for something to do a few times."""

    def load(self):
        words = self.context.simulator._session.ring.words
        before = words[HEARTBEAT]
        until(lambda: words[HEARTBEAT] >= before + 5)
        super().load()


def heavy_arm(interface, plugins=(CONTROL,)):
    """Six links of 12 to 2 kg in a row along x, 0.3 m each, that hinges about y carry."""
    links = [Link(name, pose=Pose((0.3 * n, 0.0, 2.0)), inertial=Inertial(
        12.0 - 2.0 * n, Pose((0.15, 0.0, 0.0)), 0.1, 0, 0, 0.1, 0, 0.1))
             for n, name in enumerate(NAMES)]
    joints = [Joint(name, "revolute", "world" if n == 0 else NAMES[n - 1], name,
                    axis=JointAxis((0.0, 1.0, 0.0), lower=-3.0, upper=3.0, effort=2000.0,
                                   velocity=3.0)) for n, name in enumerate(NAMES)]
    return Model("arm", links=links, joints=joints, transmissions=[
        Transmission(name, joints=[TransmissionJoint(name, [f"hardware_interface/{interface}"])])
        for name in NAMES], plugins=[PluginSpec("p", one, "<plugin/>", "arm.urdf", 3)
                                     for one in plugins])


class Spawning:
    """A world that runs as fast as it can; the host begins with the first model with plugins."""

    def __init__(self, classes=None, parameters=None):
        self.issues, self.graph, self.host = [], Graph(parameters), None
        self.classes = classes or {}
        SEEN.clear()
        self.sim = started(World(models=[ground()]), BulletBackend, log=self.issues.append,
                           paused=False)
        self.sim.sync_points.on_plugins(self._begin)
        until(lambda: self.sim.clock.step > 20)

    def _begin(self):
        if self.host is None:
            self.host = PluginHost(self.sim, self.graph, PluginRegistry(self.classes),
                                   self.issues.append)
            self.host.begin()

    def spawn(self, model):
        self.sim.models.spawn(model)
        if self.host is not None:
            self.host.wait_until_loaded()

    def positions(self):
        return [self.sim.joints.states(f"arm::{name}")[0][0] for name in NAMES]

    def run(self, steps):
        """Wait until the world has made that many steps."""
        end = self.sim.clock.step + steps
        until(lambda: self.sim.clock.step >= end)

    def ask(self, service, **fields):
        response = Message()
        self.graph.heard[f"arm/controller_manager/{service}"](Message(**fields), response)
        return response

    def close(self):
        if self.host is not None:
            self.host.stop()
        self.sim.close()


@pytest.fixture
def spawning():
    yield from kept(Spawning)


@pytest.mark.parametrize("interface", INTERFACES)
def test_an_arm_does_not_move_before_its_controllers_start(spawning, interface):
    one = spawning({CONTROL: f"{__name__}:Slow"})
    one.spawn(heavy_arm(interface))
    assert SEEN[0] == [0.0] * 6
    one.run(500)
    assert max(map(abs, one.positions())) < 1e-3


@pytest.mark.parametrize("interface", INTERFACES)
def test_how_long_plugins_take_to_load_changes_no_bit(spawning, interface):
    runs = []
    for kind in ("Watched", "Slow"):
        one = spawning({CONTROL: f"{__name__}:{kind}"})
        one.spawn(heavy_arm(interface))
        until(lambda: len(SEEN) > 200)
        one.close()
        runs.append(SEEN[:200])
    assert runs[0] == runs[1]


def test_the_second_robot_does_not_move_either(spawning):
    one = spawning({CONTROL: f"{__name__}:Slow"})
    one.spawn(heavy_arm("EffortJointInterface"))
    one.run(50)
    other = heavy_arm("EffortJointInterface")
    other.name = "other"
    SEEN.clear()
    one.spawn(other)
    assert [0.0] * 6 in SEEN   # beside those of the first one
    one.run(50)
    assert max(abs(one.sim.joints.states(f"other::{name}")[0][0]) for name in NAMES) < 1e-3


@pytest.mark.parametrize("interface", INTERFACES)
def test_joints_that_are_set_are_held_there(spawning, interface):
    """As spawn_model -J does after the spawn."""
    one = spawning()
    one.spawn(heavy_arm(interface))
    one.run(20)
    one.sim.joints.set_positions({f"arm::{name}": 0.2 for name in NAMES})
    one.run(300)
    assert one.positions() == pytest.approx([0.2] * 6, abs=1e-3)


def test_a_controller_takes_over_and_the_other_effort_joints_rest(spawning):
    names = NAMES[:3]
    one = spawning(parameters={"arm": {"first": {
        "type": "position_controllers/JointGroupPositionController", "joints": names}}})
    arm = heavy_arm("EffortJointInterface")
    for transmission in arm.transmissions[:3]:
        transmission.joints[0].interfaces[:] = ["hardware_interface/PositionJointInterface"]
    one.spawn(arm)
    one.run(300)
    assert max(map(abs, one.positions())) < 1e-3
    assert one.ask("load_controller", name="first").ok
    assert one.ask("switch_controller", start_controllers=["first"], stop_controllers=[],
                   strictness=2).ok
    one.run(500)
    assert max(map(abs, one.positions())) < 5e-3
    until(lambda: one.positions()[3] > 0.1)   # after a second
    assert max(map(abs, one.positions()[:3])) < 0.01


def test_effort_joints_without_controllers_fall_after_a_while_and_the_log_says_so(spawning):
    one = spawning()
    one.sim.clock.pause()
    one.spawn(heavy_arm("EffortJointInterface"))
    began = one.sim.clock.step
    one.sim.clock.advance(round(PATIENCE_S * 1000) - 10)
    assert max(map(abs, one.positions())) < 1e-3
    one.sim.clock.advance(300)
    assert one.sim.clock.step - began > PATIENCE_S * 1000
    assert one.positions()[0] > 0.1
    (told,) = [issue.message for issue in one.issues if "no controller" in issue.message]
    assert ", ".join(NAMES) in told


@pytest.mark.parametrize("plugins", [
    {"libgazebo_ros_control.so": "<plugin><robotSimType>franka_gazebo/FrankaHWSim</robotSimType>"
     "</plugin>"},
    {CONTROL: "<plugin/>", "libGravityCompensationPlugin.so": "<plugin/>"}])
def test_an_arm_with_compensated_gravity_stays_also_after_a_reset(spawning, plugins):
    one = spawning()
    one.sim.clock.pause()
    arm = heavy_arm("EffortJointInterface")
    arm.plugins[:] = [PluginSpec(f"p{n}", name, text, "arm.urdf", 3)
                      for n, (name, text) in enumerate(plugins.items())]
    one.spawn(arm)
    one.sim.clock.advance(round(PATIENCE_S * 1000) + 1500)
    assert max(map(abs, one.positions())) < 1e-3
    assert not [issue for issue in one.issues if "not simulated" in issue.message]
    one.sim.resets.reset_world()
    one.sim.clock.advance(round(PATIENCE_S * 1000) + 1500)
    assert max(map(abs, one.positions())) < 1e-3


def test_an_arm_without_a_joint_to_the_world_is_warned_of(spawning):
    one = spawning()
    arm = heavy_arm("EffortJointInterface")
    arm.joints[:1] = []
    arm.transmissions[:1] = []
    arm.plugins[:] = [PluginSpec("p", "libGravityCompensationPlugin.so", "<plugin/>", "a.urdf", 3)]
    one.spawn(arm)
    assert any("gravity is not compensated: no joint" in issue.message for issue in one.issues)


def test_joints_with_a_position_interface_are_held_for_ever(spawning):
    one = spawning()
    one.sim.clock.pause()
    one.spawn(heavy_arm("PositionJointInterface"))
    one.sim.clock.advance(round(PATIENCE_S * 1000) + 1000)
    assert max(map(abs, one.positions())) < 1e-3
    assert not [issue for issue in one.issues if "no controller" in issue.message]


def test_joints_are_held_where_they_began_after_a_reset(spawning):
    one = spawning()
    one.spawn(heavy_arm("EffortJointInterface"))
    one.run(100)
    one.sim.joints.set_positions({f"arm::{name}": 0.2 for name in NAMES})
    one.run(100)
    one.sim.resets.reset_simulation()
    one.run(300)
    assert max(map(abs, one.positions())) < 1e-3


class Driving(Plugin):
    def load(self):
        self.context.joint("joint5").drive(0.5, 1000.0)


@pytest.mark.parametrize("order", [(CONTROL, "libdriving.so"), ("libdriving.so", CONTROL)])
def test_the_motor_of_another_plugin_drives_a_joint_that_would_be_held(spawning, order):
    """Robots with diff_drive often have transmissions, too, and no controllers."""
    one = spawning({"libdriving.so": f"{__name__}:Driving"})
    one.spawn(heavy_arm("EffortJointInterface", order))
    until(lambda: one.positions()[5] > 0.1)
    assert max(map(abs, one.positions()[:5])) < 1e-3


@pytest.mark.parametrize("library", ["libof_nobody.so", CONTROL])
def test_a_robot_whose_plugin_cannot_hold_it_falls_and_the_world_goes_on(spawning, library):
    one = spawning({CONTROL: f"{__name__}:Failing"})
    one.spawn(heavy_arm("PositionJointInterface", [library]))
    until(lambda: one.positions()[0] > 0.1)
    assert [issue.code for issue in one.issues] in (["plugin-unknown"], ["plugin-failed"])


class Failing(GazeboRosControl):
    def load(self):
        raise ZeroDivisionError("nothing to divide")
