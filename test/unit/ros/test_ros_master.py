import socket
import threading
import time
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from free_ports import silent_uri

from my_simulations.ros.lifecycle import master_api


@pytest.fixture
def graph():
    """A master that knows one living and one dead node."""
    server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    uri = f"http://127.0.0.1:{server.server_address[1]}"
    nodes = {"/alive": uri, "/dead": silent_uri()}

    def look_up(_caller, name):
        return [1, "", nodes[name]] if name in nodes else [-1, "unknown node", ""]

    server.register_function(lambda caller: [1, "", 42], "getPid")
    server.register_function(look_up, "lookupNode")
    thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    yield uri
    server.shutdown()
    server.server_close()


def test_a_master_that_answers_ends_the_wait_without_a_word(graph):
    said = []
    assert master_api.wait_for_master(graph, "/me", threading.Event(), said.append)
    assert said == []


def test_without_a_master_it_says_so_until_it_is_stopped():
    said, stop = [], threading.Event()
    uri = silent_uri()

    def say(line):
        said.append(line)
        stop.set()

    assert not master_api.wait_for_master(uri, "/me", stop, say)
    assert uri in said[0] and "roscore" in said[0]


def test_the_wait_ends_at_its_deadline():
    assert not master_api.wait_for_master(silent_uri(), "/me", threading.Event(), lambda line: None,
                           time.monotonic())


def test_a_server_that_is_no_master_is_a_fault():
    with socket.socket() as mute:
        mute.bind(("127.0.0.1", 0))
        mute.listen(1)
        uri = f"http://127.0.0.1:{mute.getsockname()[1]}"
        with pytest.raises(OSError):
            master_api.call(uri, "getPid", "/me", seconds=0.1)


@pytest.mark.parametrize("uri", ["nonsense", "http://no port", "http://127.0.0.1:port"])
def test_a_uri_that_cannot_be_read_is_a_fault(uri):
    assert "ROS_MASTER_URI" in master_api.fault_of(uri, "/me")


def test_a_living_node_of_the_name_is_found(graph):
    assert master_api.running_node(graph, "/alive") == (graph, 42)


def test_a_dead_or_unknown_node_is_none(graph):
    assert master_api.running_node(graph, "/dead") is None
    assert master_api.running_node(graph, "/nobody") is None


@pytest.mark.parametrize("argv, environment, name", [
    ([], None, "/gazebo"),
    (["__name:=sim"], None, "/sim"),
    (["__ns:=/a/b"], None, "/a/b/gazebo"),
    ([], "robots", "/robots/gazebo"),
    (["__ns:=c", "__name:=sim"], "robots", "/c/sim"),
])
def test_the_node_name_follows_remappings_and_namespace(monkeypatch, argv, environment, name):
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)
    if environment:
        monkeypatch.setenv("ROS_NAMESPACE", environment)
    assert master_api.node_name(argv, "gazebo") == name


def test_subscribers_are_those_that_the_master_knows_but_the_caller():
    server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    uri = f"http://127.0.0.1:{server.server_address[1]}"
    state = [[["/rosout", ["/me"]]], [["/rosout", ["/rosout", "/me"]], ["/clock", ["/other"]]], []]
    server.register_function(lambda caller: [1, "", state], "getSystemState")
    thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    assert master_api.other_subscribers(uri, "/me", "/rosout") == {"/rosout"}
    server.shutdown()
    server.server_close()
    assert master_api.other_subscribers(silent_uri(), "/me", "/rosout") == set()
