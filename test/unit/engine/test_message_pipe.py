"""Messages between our own processes arrive whole, or the stream ends."""
from __future__ import annotations

import socket
import struct
import subprocess
import sys
import threading

import pytest

from my_simulations.child_process import await_end
from my_simulations.engine.message_pipe import Wire

LARGE = b"x" * 8_000_000   # more than a socket holds


@pytest.fixture
def two_ends():
    """Sockets as a process has them once rospy has subscribed to something."""
    socket.setdefaulttimeout(60.0)
    try:
        ours, theirs = socket.socketpair()
    finally:
        socket.setdefaulttimeout(None)
    # The child makes a socket object of its own from the descriptor.
    child = socket.socket(fileno=theirs.detach())
    yield ours, child
    ours.close()
    child.close()


def test_a_message_larger_than_the_socket_holds_arrives_whole(two_ends):
    ours, child = (Wire(end) for end in two_ends)
    faults = []

    def send():
        try:
            for number in range(3):
                child.send((number, LARGE))
        except OSError as fault:
            faults.append(fault)
    sender = threading.Thread(target=send)
    sender.start()
    found = []
    while len(found) < 3 and not faults:
        found += ours.receive(30.0)
    sender.join(30.0)
    assert not faults
    assert [(number, len(body)) for number, body in found] == [(n, len(LARGE)) for n in range(3)]


def test_a_stream_that_holds_no_message_ends(two_ends):
    ours, child = two_ends
    child.sendall(struct.pack("=Q", 4) + b"\xff\xff\xff\xff")
    with pytest.raises(EOFError, match="damaged message"):
        Wire(ours).receive(30.0)


def test_both_sides_see_the_end_of_a_stream_that_could_not_take_a_message(two_ends):
    ours, child = (Wire(end) for end in two_ends)
    child.sock.shutdown(socket.SHUT_WR)
    with pytest.raises(OSError):
        child.send("lost")
    with pytest.raises(EOFError):
        ours.receive(30.0)
    with pytest.raises(EOFError):
        child.receive(30.0)


def test_a_child_whose_stream_has_ended_and_that_lives_on_is_killed(two_ends, monkeypatch):
    monkeypatch.setattr("my_simulations.child_process._END_S", 0.1)
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    await_end(child, Wire(two_ends[0]))
    assert child.returncode == -9
