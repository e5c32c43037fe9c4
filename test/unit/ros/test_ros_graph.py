"""Services of plugins: what a caller and the log are told of a refusal."""
from __future__ import annotations

import struct
from io import BytesIO

import pytest
from rospy.impl.tcpros_service import ServiceImpl
from std_srvs.srv import Empty, EmptyRequest

from my_simulations.plugins.context import PluginError
from my_simulations.plugins.graph import MissingTypeError, ServiceTakenError
from my_simulations.ros.plugins import ros_graph
from my_simulations.ros.plugins.ros_graph import RosGraph


class Transport:
    """What an answer is written to."""

    def __init__(self):
        self.write_buff, self.sent = BytesIO(), b""

    def write_data(self, data):
        self.sent += data

    def send_message(self, message, seq):
        self.sent += b"\1"


class Service(ServiceImpl):
    """rospy's own way from a request to an answer, without a socket and a master."""

    def __init__(self, name, service_class, handler):
        self.handler, self.response_class = handler, service_class._response_class
        self.seq, self.faults = 0, []
        self.error_handler = lambda fault, *_: self.faults.append(fault)  # it would log a traceback


@pytest.fixture
def served(monkeypatch):
    made = []

    class Kept(Service):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            made.append(self)

        def shutdown(self):
            made.remove(self)

    monkeypatch.setattr(ros_graph.rospy, "Service", Kept)

    def ask(call):
        RosGraph().serve("it", "std_srvs/Empty", call)
        transport = Transport()
        made[-1]._handle_request(transport, EmptyRequest())
        return made[-1], transport.sent
    return ask


def test_a_plugin_that_has_ended_answers_with_its_reason_and_logs_nothing(served):
    def ended(request, response):
        raise PluginError("the plugin has ended")

    service, sent = served(ended)
    assert service.faults == []
    ok, length = struct.unpack_from("<BI", sent)
    assert ok == 0 and sent[5:5 + length].decode().endswith("the plugin has ended")


def test_a_fault_that_nobody_expects_is_logged(served):
    service, _ = served(lambda request, response: 1 / 0)
    assert [type(fault) for fault in service.faults] == [ZeroDivisionError]


def test_an_answer_of_a_plugin_leaves(served):
    seen = []
    service, sent = served(lambda request, response: seen.append(type(response)))
    assert seen == [Empty._response_class] and service.faults == [] and sent == b"\1"


def test_a_service_that_the_node_offers_already_is_told_by_its_name(monkeypatch):
    def taken(*_):
        raise ros_graph.rospy.ServiceException("service [/it] already registered")

    monkeypatch.setattr(ros_graph.rospy, "Service", taken)
    with pytest.raises(ServiceTakenError, match="/it is offered already"):
        RosGraph().serve("it", "std_srvs/Empty", lambda request, response: None)


@pytest.mark.parametrize("files, said", [
    ((), "lost_msgs/Thing is not installed; install the package ros-lost_msgs"),
    (("msg/Thing.msg",), "lost_msgs/Thing has not been built; build the package lost_msgs in")])
def test_a_type_that_is_only_defined_is_to_be_built(tmp_path, monkeypatch, files, said):
    package = tmp_path / "lost_msgs"
    for file in ("package.xml", *files):
        (package / file).parent.mkdir(parents=True, exist_ok=True)
        (package / file).write_text(
            "<package><name>lost_msgs</name><version>1.0.0</version><description>d</description>"
            "<maintainer email='a@b.invalid'>a</maintainer><license>none</license></package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    with pytest.raises(MissingTypeError, match=said):
        RosGraph().message("lost_msgs/Thing")
