"""Plugins that only read change nothing; messages have the same bits with any subscribers."""
from __future__ import annotations

import contextlib
import pathlib
from dataclasses import replace

import pytest
from conftest import ground
from plugin_case import PluginCase
from waiting import until

from my_simulations.description.plugin import PluginSpec
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.formats.reading import read_file
from my_simulations.plugins.testing import Message
from my_simulations.resources.resolver import Resolver

ROBOT = pathlib.Path(__file__).resolve().parents[2] / "urdf" / "robo.urdf"
SENSORS = {
    "imu": """<plugin><bodyName>base_footprint</bodyName><topicName>felt</topicName>
        <gaussianNoise>0.01</gaussianNoise><updateRate>0</updateRate></plugin>""",
    "hector_gazebo_ros_imu": """<plugin><topicName>hector</topicName><updateRate>50</updateRate>
        <accelDrift>0.5 0.5 0.5</accelDrift><accelDriftFrequency>2</accelDriftFrequency>
        <rateGaussianNoise>0.1 0.1 0.1</rateGaussianNoise></plugin>""",
    "p3d": """<plugin><bodyName>base_footprint</bodyName><topicName>truth</topicName>
        <gaussianNoise>0.01</gaussianNoise><updateRate>30</updateRate></plugin>"""}
TOPICS = ("felt", "hector", "hector/bias", "truth", "/odom", "/joint_states")
SILENT = (*TOPICS, "/tf", "/imu", "/scan", "/camera/camera_info", "/camera/image_raw",
          "/camera/image_raw/compressed")


def library(name):
    return f"lib{name}.so" if name.startswith("hector") else f"libgazebo_ros_{name}.so"


class Case(PluginCase):
    """The lab robot with more sensors; the topics in `silent` have no subscribers."""

    def __init__(self, silent=SILENT):
        robot, _ = read_file(str(ROBOT), Resolver())
        robot = replace(robot, plugins=[*robot.plugins, *(
            PluginSpec(name, library(name), xml, "robot.urdf", 1)
            for name, xml in SENSORS.items())])
        super().__init__(World(models=[ground(mu=1.0), robot]), BulletBackend)
        for name in (*SILENT[len(TOPICS):], *silent):
            self.graph.listen(name, wanted=False)

    def drive(self, steps=600, at_once=600):
        """Drive a curve; returns the states of all links and joints at the end."""
        self.graph.heard["/cmd_vel"](Message(linear={"x": 0.3}, angular={"z": 0.5}))
        for _ in range(steps // at_once):
            self.sim.clock.advance(at_once)
        _, snapshot = self.sim.states.fresh()
        return bytes(snapshot.links), bytes(snapshot.joints)

    def told(self, topic, count):
        """The numbers of the first messages of a topic, by sim time."""
        until(lambda: len(self.graph.on(topic)) >= count, f"{topic} has "
              f"{len(self.graph.on(topic))} of {count} messages")
        return {message.header.stamp: numbers(message) for message in self.graph.on(topic)}


def numbers(message):
    found = []
    for value in vars(message).values():
        if isinstance(value, float):
            found.append(value)
        elif isinstance(value, list):
            found += [one for one in value if isinstance(one, float)]
        elif hasattr(value, "__dict__"):
            found += numbers(value)
    return found


COUNTS = {"felt": 600, "hector": 30, "hector/bias": 30, "truth": 18, "/odom": 30,
          "/joint_states": 30}


@contextlib.contextmanager
def running(silent):
    """A case; there can be one at a time in a process."""
    made = Case(silent)
    try:
        yield made
    finally:
        made.close()


def states(silent):
    """The states at the end of a drive."""
    with running(silent) as one:
        return one.drive()


def messages(at_once=600):
    """All messages of a drive with subscribers of all topics."""
    with running(()) as one:
        one.drive(at_once=at_once)
        return {topic: one.told(topic, count) for topic, count in COUNTS.items()}


@pytest.fixture(scope="module")
def always():
    """The messages that an early subscriber receives."""
    return messages()


def test_the_world_is_the_same_with_and_without_subscribers():
    assert states(()) == states(SILENT)


def test_without_subscribers_nothing_is_published_and_the_host_is_not_woken():
    with running(SILENT) as one:
        one.drive()
        assert not [topic for topic, message in one.graph.sent if message is not None
                    and not topic.startswith("/camera/parameter")]
        # The encoders of the drive count always.
        assert [rule.urgent for rule in one.host._observations._rules] == [False]


def test_messages_do_not_depend_on_how_many_steps_are_made_at_once(always):
    assert messages(at_once=5) == always


@pytest.mark.parametrize("topic", TOPICS)
def test_a_late_subscriber_receives_what_an_early_one_does(always, topic):
    with running(SILENT) as late:
        late.drive(steps=250, at_once=250)
        late.graph.listen(topic)
        late.sim.clock.advance(350)
        until(lambda: 600_000_000 in late.told(topic, 1))
        found = late.told(topic, 1)
    assert 250_000_000 < min(found) <= 300_000_000
    assert {ns: always[topic][ns] for ns in found} == found


def test_messages_after_a_reset_are_those_of_the_start(always):
    with running(()) as one:
        one.drive()
        one.told("felt", COUNTS["felt"])
        one.sim.resets.reset_simulation()
        one.sim.clock.advance(0)
        one.graph.sent.clear()
        one.drive()
        assert {topic: one.told(topic, count) for topic, count in COUNTS.items()} == always
