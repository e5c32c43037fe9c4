"""The context of tests refuses messages that ROS would refuse."""
from __future__ import annotations

import pytest

from my_simulations.messages import MessageFieldError, Time
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.testing import FakeContext


@pytest.mark.parametrize("use", [
    lambda context: context.message("std_msgs/Flaot64"),
    lambda context: context.publish("speed", "std_msg/Float64"),
    lambda context: context.subscribe("speed", "Float64", print),
    lambda context: context.serve("speed", "std_srvs/Triger", print)])
def test_unknown_types_are_refused(use):
    with pytest.raises(PluginError, match="not"):
        use(FakeContext())


def test_unknown_fields_and_wrong_values_are_refused():
    context = FakeContext()
    topic = context.publish("odom", "nav_msgs/Odometry")
    message = context.message("nav_msgs/Odometry")
    message.header.stamp = context.stamp()
    topic.publish(message)
    assert context.published["odom"] == [message] and message.header.stamp == Time()
    message.pose.pose.position.w = 1.0
    with pytest.raises(MessageFieldError, match="geometry_msgs/Point has no field 'w'"):
        topic.publish(message)
    with pytest.raises(MessageFieldError, match="must be a nav_msgs/Odometry"):
        topic.publish(context.message("std_msgs/Empty"))
    context.subscribe("speed", "std_msgs/Float64", lambda heard: None)
    with pytest.raises(MessageFieldError, match="no field 'value'"):
        context.deliver("speed", value=1.0)
    for wrong in ("fast", "3"):
        with pytest.raises(MessageFieldError, match=f"data cannot be '{wrong}': it must be a nu"):
            context.deliver("speed", data=wrong)
    with pytest.raises(MessageFieldError, match="None is not a nav_msgs/Odometry"):
        topic.publish(None)


def test_what_the_plugin_does_not_offer_is_named():
    context = FakeContext()
    with pytest.raises(PluginError, match="not subscribe to 'sped'; it subscribes to nothing"):
        context.deliver("sped", data=1.0)
    context.subscribe("speed", "std_msgs/Float64", lambda heard: None)
    with pytest.raises(PluginError, match="not subscribe to 'sped'; it subscribes to speed"):
        context.deliver("sped", data=1.0)
    with pytest.raises(PluginError, match="does not offer 'on'; it offers no service"):
        context.call("on", data=True)


def test_a_service_is_called_with_its_types():
    context = FakeContext()

    def answer(request, response):
        response.success = request.data
        response.message = "on"

    context.serve("on", "std_srvs/SetBool", answer)
    response = context.call("on", data=True)
    assert (response.success, response.message) == (True, "on")
    with pytest.raises(MessageFieldError, match="no field 'on'"):
        context.call("on", on=True)


def test_a_dictionary_is_not_published():
    topic = FakeContext().publish("speed", "std_msgs/Float64")
    with pytest.raises(MessageFieldError, match="make a std_msgs/Float64 with context.message"):
        topic.publish({"data": 1.0})
