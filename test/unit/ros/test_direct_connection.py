"""Publishers that write at once: whole messages in order, slow subscribers, ends; packed tf."""
from __future__ import annotations

import io
import socket
import struct
import threading
import time
from types import SimpleNamespace

import pytest
from genpy import Time
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Clock
from rospy.exceptions import TransportTerminated
from rospy.impl.tcpros_base import TCPROSTransport, TCPROSTransportProtocol
from rospy.topics import _PublisherImpl
from tf2_msgs.msg import TFMessage

from my_simulations.geometry import Pose
from my_simulations.ros.direct_connection import DirectConnection, direct_publish
from my_simulations.ros.plugins.ros_graph import PackedTransforms

MESSAGE = 100_000


class Transport:
    """What rospy hands over: a connected socket, and what it counts."""

    def __init__(self, sock):
        self.socket, self.done = sock, False
        self.stat_bytes = self.stat_num_msg = 0

    def fileno(self):
        return self.socket.fileno()

    def close(self):
        self.done = True
        self.socket.close()


@pytest.fixture
def pair():
    ours, theirs = socket.socketpair()
    theirs.settimeout(10.0)
    yield Transport(ours), theirs
    for one in (ours, theirs):
        one.close()


def message(number):
    return struct.pack("<I", number) * (MESSAGE // 4)


def read(sock, count):
    found = b""
    while len(found) < count * MESSAGE:
        found += sock.recv(1 << 20)
    return [struct.unpack_from("<I", found, n * MESSAGE)[0] for n in range(count)], found


def test_a_message_is_there_when_the_call_returns(pair):
    transport, theirs = pair
    DirectConnection(transport, 1).write_data(b"hello")
    assert theirs.recv(10) == b"hello"
    assert (transport.stat_bytes, transport.stat_num_msg) == (5, 1)


def test_a_slow_subscriber_gets_all_in_order_where_the_queue_has_no_end(pair):
    transport, theirs = pair
    connection = DirectConnection(transport, 0)
    for number in range(40):
        connection.write_data(message(number))
    numbers, found = read(theirs, 40)
    assert numbers == list(range(40))
    assert found == b"".join(message(number) for number in range(40))


def test_a_slow_subscriber_loses_the_oldest_and_never_a_part(pair):
    transport, theirs = pair
    connection = DirectConnection(transport, 2)
    for number in range(40):
        connection.write_data(message(number))
    sent = transport.stat_num_msg
    assert sent < 37
    numbers, found = read(theirs, sent + 3)
    # What was at hand when the socket was full leaves whole; then the newest two.
    assert numbers == [*range(sent + 1), 38, 39]
    assert found == b"".join(message(number) for number in numbers)
    connection.write_data(b"again")
    deadline = time.monotonic() + 60.0
    rest = b""
    while rest != b"again":
        assert time.monotonic() < deadline
        rest += theirs.recv(10)


def test_the_end_of_the_other_side_is_told(pair):
    transport, theirs = pair
    connection = DirectConnection(transport, 1)
    theirs.close()
    with pytest.raises(TransportTerminated):
        connection.write_data(b"one")
    transport.close()
    with pytest.raises(TransportTerminated):
        connection.write_data(b"two")


def test_a_slow_subscriber_that_ends_is_closed(pair):
    transport, theirs = pair
    connection = DirectConnection(transport, 0)
    while transport.stat_num_msg == 0 or not connection._waiting:
        connection.write_data(message(1))
    theirs.close()
    deadline = time.monotonic() + 60.0
    while not transport.done:
        assert time.monotonic() < deadline, "nobody closed the connection"
        time.sleep(0.002)


def test_a_subscriber_that_was_there_first_has_no_thread_either(pair):
    transport, theirs = pair
    publisher = SimpleNamespace(impl=_PublisherImpl("/clock", Clock))
    publisher.impl.set_queue_size(10)
    connected = TCPROSTransport(TCPROSTransportProtocol("/clock", Clock), "/clock")
    connected.set_socket(transport.socket, "subscriber")
    threads = set(threading.enumerate())
    publisher.impl.add_connection(connected)
    queues = set(threading.enumerate()) - threads
    assert len(queues) == 1  # rospy's

    publish = direct_publish(publisher)
    publish(Clock(Time(3, 4)))
    assert theirs.recv(100) == struct.pack("<III", 8, 3, 4)
    queue, = queues
    queue.join(60.0)
    assert not queue.is_alive()


def test_packed_transforms_are_what_a_message_is():
    poses = [Pose((1.0, 2.0, 3.0), (0.0, 0.6, 0.0, 0.8)), Pose((-1.0, 0.0, 0.5))]
    plain = TFMessage()
    for name, pose in zip(("base", "räder"), poses):
        one = TransformStamped()
        one.header.stamp, one.header.frame_id, one.child_frame_id = Time(12, 345), "odom", name
        at, turn = one.transform.translation, one.transform.rotation
        at.x, at.y, at.z = pose.position
        turn.x, turn.y, turn.z, turn.w = pose.orientation
        plain.transforms.append(one)
    expected, packed = io.BytesIO(), io.BytesIO()
    plain.serialize(expected)
    PackedTransforms([("odom", "base", poses[0]), ("odom", "räder", poses[1])],
                     12_000_000_345).serialize(packed)
    assert packed.getvalue() == expected.getvalue()
