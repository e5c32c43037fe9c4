"""A node whose master or roslaunch has gone ends after a while, and not before."""
from __future__ import annotations

import socketserver
import threading
import xmlrpc.server

import pytest

from my_simulations.ros.lifecycle.abandoned import Abandonment
from my_simulations.ros.lifecycle.launch_info import Launch

NOBODY = "http://127.0.0.1:1"


class Quiet(xmlrpc.server.SimpleXMLRPCRequestHandler):
    def log_message(self, *_):
        pass


class Master(socketserver.ThreadingMixIn, xmlrpc.server.SimpleXMLRPCServer):
    daemon_threads = True


@pytest.fixture
def master():
    server = Master(("127.0.0.1", 0), Quiet)
    server.register_function(lambda caller: (1, "", 1), "getPid")
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()
    server.server_close()


class Clock:
    now = 0.0

    def __call__(self):
        return self.now


class Started:
    """A launch that can be made to die."""

    pid, is_alive = 7, True


def watch(uri, limit, launch=None):
    clock = Clock()
    return Abandonment(uri, "/gazebo", launch or Launch(0, 0, "/"), limit, clock), clock


def reason_at(watched, clock, seconds):
    found = ""
    while clock.now < seconds and not found:
        clock.now += 1.0
        found = watched.reason()
    return found


def test_a_master_that_is_gone_for_the_limit_ends_the_node():
    watched, clock = watch(NOBODY, 60.0)
    assert reason_at(watched, clock, 59.0) == ""
    assert "has been gone for 60 s" in reason_at(watched, clock, 61.0)


def test_a_limit_of_0_means_never():
    watched, clock = watch(NOBODY, 0.0)
    assert reason_at(watched, clock, 1000.0) == ""


def test_a_master_that_answers_is_no_reason(master):
    watched, clock = watch(master, 10.0)
    assert reason_at(watched, clock, 100.0) == ""


def test_a_roslaunch_that_was_killed_is_a_reason_though_its_master_lives(master):
    launch = Started()
    watched, clock = watch(master, 10.0, launch)
    assert reason_at(watched, clock, 30.0) == ""
    launch.is_alive = False
    assert reason_at(watched, clock, 39.0) == ""
    assert "roslaunch that started this node (process 7)" in reason_at(watched, clock, 41.0)
