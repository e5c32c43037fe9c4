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
    with pytest.raises(MessageFieldError, match="data cannot be 'fast'"):
        context.deliver("speed", data="fast")


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
