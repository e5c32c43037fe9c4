"""Messages between our own processes arrive whole, or the stream ends."""
from __future__ import annotations

import os
import pickle
import resource
import socket
import struct
import subprocess
import sys
import threading

import pytest

from my_simulations.child_process import await_end
from my_simulations.engine.commands import Ping
from my_simulations.engine.message_pipe import Wire
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.engine.wake_pipe import WakePipe

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


def test_kept_messages_arrive_with_the_next_one(two_ends):
    ours, child = (Wire(end) for end in two_ends)
    child.hold(1)
    child.hold(2)
    assert ours.receive(0.0) == []
    child.send(3)
    child.send(4)
    assert ours.receive(30.0) == [1, 2, 3, 4]
    child.send_held()
    assert ours.receive(0.0) == []
    child.hold(5)
    child.send_held()
    assert ours.receive(30.0) == [5]


def test_a_stream_that_holds_no_message_ends(two_ends):
    ours, child = two_ends
    child.sendall(struct.pack("=Q", 4) + b"\xff\xff\xff\xff")
    with pytest.raises(EOFError, match="damaged message"):
        Wire(ours).receive(30.0)


def test_a_message_of_absurd_length_ends_the_stream_at_once(two_ends):
    ours, child = two_ends
    child.sendall(b"\xff" * 100)
    with pytest.raises(EOFError, match="damaged message: its length"):
        Wire(ours).receive(30.0)
    child.sendall(struct.pack("=Q", 1001))
    with pytest.raises(EOFError, match="would be 1001 bytes"):
        Wire(ours, longest=1000).receive(30.0)


def test_a_part_of_a_message_is_kept_until_the_rest_arrives(two_ends):
    ours, child = two_ends
    wire, body = Wire(ours), pickle.dumps("whole")
    data = struct.pack("=Q", len(body)) + body
    for byte in data[:-1]:
        child.sendall(bytes([byte]))
        assert wire.receive(30.0, rest=0.0) == []
    child.sendall(data[-1:])
    assert wire.receive(30.0, rest=0.0) == ["whole"]


@pytest.fixture
def many_descriptors():
    """A process with so many open files that the next ones have numbers above those of select."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard < 1200:
        pytest.skip(f"this user may open {hard} files only")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 1200), hard))
    held = [os.open(os.devnull, os.O_RDONLY)]
    while held[-1] < 1024:
        held.append(os.dup(held[0]))
    yield
    for one in held:
        os.close(one)
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_a_message_arrives_where_many_files_are_open(many_descriptors):
    ours, theirs = socket.socketpair()
    with ours, theirs:
        assert ours.fileno() >= 1024
        wire = Wire(ours)
        assert wire.receive(0.001) == []
        Wire(theirs).send("hello")
        assert wire.receive(30.0) == ["hello"]


def test_a_thread_is_woken_where_many_files_are_open(many_descriptors):
    pipe = WakePipe()
    assert pipe.output >= 1024 and not pipe.wait(0.001)
    pipe.wake()
    assert pipe.wait(30.0)
    pipe.close()


def test_an_engine_starts_where_many_files_are_open(many_descriptors):
    engine = ProcessEngine()
    try:
        assert engine.submit(Ping()).result(60.0).error == ""
    finally:
        engine.close()


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
