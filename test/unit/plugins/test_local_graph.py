"""Topics, services and parameters of plugins without ROS."""
from __future__ import annotations

import pytest

from my_simulations.errors import CommandError
from my_simulations.geometry import IDENTITY
from my_simulations.messages import MessageFieldError
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.graph import MissingTypeError, ServiceTakenError
from my_simulations.plugins.local_graph import LocalGraph, resolve_name
from my_simulations.plugins.local_parameters import LocalParameters


@pytest.fixture
def graph():
    return LocalGraph(LocalParameters({"robot/arm": {"type": "a"}, "gain": 2}))


def nothing():
    """Nothing depends on who listens."""


def test_names():
    assert [resolve_name(name) for name in ("a", "/a//b/", "~c")] == ["/a", "/a/b", "/gazebo/c"]
    assert resolve_name("a", "/ns") == "/ns/a"


def test_messages_are_copied_to_each_listener(graph):
    heard, plugin = [], []
    changes = []
    topic = graph.publish("scan", "sensor_msgs/LaserScan", 1, False, lambda: changes.append(1))
    assert not topic.wanted
    end = graph.listen("/scan", heard.append)
    closing = graph.subscribe("scan", "sensor_msgs/LaserScan", plugin.append, 1)
    assert topic.wanted and len(changes) == 2
    message = graph.message("sensor_msgs/LaserScan")
    message.ranges = [1.0, 2.0]
    topic.send(message)
    message.ranges.append(3.0)
    assert heard[0].ranges.tolist() == plugin[0].ranges == [1.0, 2.0]
    assert heard[0].header.seq == 1
    end()
    closing.close()
    assert not topic.wanted and len(changes) == 4
    topic.close()
    assert graph.topics() == {}


def test_a_plugin_publishes_no_dictionary(graph):
    topic = graph.publish("speed", "std_msgs/Float64", 1, False, nothing)
    with pytest.raises(MessageFieldError, match="make a std_msgs/Float64 with context.message"):
        topic.send({"data": 1.0})


def test_a_latched_message_reaches_those_who_listen_later(graph):
    topic = graph.publish("map", "std_msgs/String", 1, True, nothing)
    message = graph.message("std_msgs/String")
    message.data = "first"
    topic.send(message)
    heard = []
    graph.listen("map", heard.append)
    assert [one.data for one in heard] == ["first"]


def test_suspended_listeners_are_not_there_and_come_back(graph):
    heard = []
    graph.listen("map", heard.append)
    with graph.suspended():
        latched = graph.publish("map", "std_msgs/String", 1, True, nothing)
        assert not latched.wanted
        latched.send(graph.message("std_msgs/String"))
        assert heard == []
    assert latched.wanted and len(heard) == 1


def test_a_message_is_published_once_to_plugins(graph):
    with pytest.raises(CommandError, match="no plugin subscribes to /cmd_vel"):
        graph.publish_once("cmd_vel", {})
    heard = []
    graph.subscribe("cmd_vel", "geometry_msgs/Twist", heard.append, 1)
    graph.publish_once("cmd_vel", {"linear": {"x": 1}})
    assert heard[0].linear.x == 1.0
    with pytest.raises(CommandError, match="no field"):
        graph.publish_once("cmd_vel", {"speed": 1})


def test_services(graph):
    def answer(request, response):
        if request.data:
            raise PluginError("it is on already")
        response.success, response.message = True, "done"

    service = graph.serve("switch", "std_srvs/SetBool", answer)
    with pytest.raises(ServiceTakenError):
        graph.serve("/switch", "std_srvs/SetBool", answer)
    assert graph.services() == {"/switch": "std_srvs/SetBool"}
    response = graph.call("switch", {"data": False})
    assert (response.success, response.message) == (True, "done")
    with pytest.raises(CommandError, match="/switch: it is on already"):
        graph.call("switch", {"data": True})
    service.close()
    with pytest.raises(CommandError, match="no plugin offers the service /switch"):
        graph.call("switch", {})


def test_missing_types(graph):
    for offer in (lambda: graph.message("lost_msgs/A"),
                  lambda: graph.publish("a", "lost_msgs/A", 1, False, nothing),
                  lambda: graph.subscribe("a", "lost_msgs/A", print, 1),
                  lambda: graph.serve("a", "lost_msgs/A", print)):
        with pytest.raises(MissingTypeError, match="lost_msgs"):
            offer()


def test_transforms_travel_in_one_message(graph):
    graph.offer_transforms(nothing)
    assert not graph.transforms_wanted
    heard = []
    graph.listen("/tf", heard.append)
    graph.send_transforms([("odom", "base", IDENTITY), ("base", "wheel", IDENTITY)], 10 ** 9)
    (message,) = heard
    assert [one.child_frame_id for one in message.transforms] == ["base", "wheel"]
    assert message.transforms[0].header.stamp.secs == 1
    assert message.transforms[0].transform.rotation.w == 1.0


def test_parameters(graph):
    assert graph.parameter("/robot", "arm/type", None) == "a"
    assert graph.parameter("robot", "/gain", None) == 2
    assert graph.parameter("", "robot", None) == {"arm": {"type": "a"}}
    assert graph.parameter("/robot", "leg", 3) == 3
    assert graph.search_parameter("/robot/arm", "gain", None) == 2
    assert graph.search_parameter("/robot/arm", "type", None) == "a"
    assert graph.search_parameter("", "lost", 5) == 5
    graph.parameters.set("/robot/arm", {"joints": ["x"]})
    assert graph.parameters.get("robot/arm") == {"joints": ["x"]}
    graph.parameters.update({"arm/type": "b"}, "/robot")
    assert graph.parameters.get("robot/arm") == {"joints": ["x"], "type": "b"}
    graph.parameters.get("robot/arm")["joints"].append("y")
    assert graph.parameters.get("robot/arm/joints") == ["x"]
