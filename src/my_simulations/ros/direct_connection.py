"""Publishers that write to their subscribers at once, without a thread for each of them.

rospy's own publishers with a queue hand every message to a thread of each connection and yield the
processor after it: of what ten robots cost a node, that was two thirds (measured). Here a message
goes to the socket at once; only what a slow subscriber has no room for waits for a thread that all
share.
"""
from __future__ import annotations

import contextlib
import select
import socket
import struct
import threading
from collections import deque
from io import BytesIO
from typing import Any, Callable, Deque, Dict, List, Optional

import rospy
from rospy.exceptions import TransportTerminated
from rospy.impl.tcpros_pubsub import QueuedConnection
from rospy.impl.transport import Transport

_LOOK_S = 0.1   # between two looks for connections that were closed
_LENGTH = struct.Struct("<I")
_NO_LENGTH = _LENGTH.pack(0)


class DirectConnection:
    """Wraps a connection of a publisher as rospy's `QueuedConnection` does.

    Of more than `most` messages (0 for any number) that wait for a slow subscriber, the oldest are
    lost, never a part of one.
    """

    def __init__(self, transport: Transport, most: int) -> None:
        self._transport, self._most = transport, most
        self._lock = threading.Lock()
        self._waiting: Deque[bytes] = deque()
        self._rest: "Optional[memoryview]" = None   # of the message that is being written

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self._transport, name)

    def write_data(self, data: bytes) -> bool:
        """Send a message, or have it sent. Raises TransportTerminated, once the other side ends."""
        if self._transport.done:
            raise TransportTerminated("the connection is closed")
        with self._lock:
            if self._rest is None:
                self._rest = memoryview(data)
                if not self._send():
                    _WRITER.watch(self)
                return True
            if self._most and len(self._waiting) >= self._most:
                self._waiting.popleft()
            self._waiting.append(data)
        return True

    def send_pending(self) -> None:
        """Send pending messages, as far as there is room. Raises TransportTerminated."""
        with self._lock:
            while self._send():
                if not self._waiting:
                    _WRITER.unwatch(self.fileno())
                    return
                self._rest = memoryview(self._waiting.popleft())

    def _send(self) -> bool:
        """Write the message at hand; whether all of it has left."""
        transport, rest = self._transport, self._rest
        sock = transport.socket
        if sock is None:
            raise TransportTerminated("the connection is closed")
        while rest:
            try:
                sent = sock.send(rest, socket.MSG_DONTWAIT)
            except BlockingIOError:
                self._rest = rest
                return False
            except OSError as fault:
                raise TransportTerminated(str(fault)) from fault
            transport.stat_bytes += sent
            rest = rest[sent:]
        transport.stat_num_msg += 1
        self._rest = None
        return True


class _Writer:
    """The thread that goes on with what sockets had no room for; it lives while something waits."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._poll = select.epoll()
        self._connections: Dict[int, DirectConnection] = {}
        self._running = False

    def watch(self, connection: DirectConnection) -> None:
        """Go on with a connection whenever it has room, until `unwatch`."""
        number = connection.fileno()
        with self._lock:
            self._connections[number] = connection
            self._poll.register(number, select.EPOLLOUT)
            if not self._running:
                self._running = True
                threading.Thread(target=self._run, name="slow subscribers", daemon=True).start()

    def unwatch(self, number: int) -> None:
        """Nothing waits any more for the connection with this descriptor, or it was closed."""
        with self._lock:
            self._connections.pop(number, None)
            with contextlib.suppress(OSError):  # a closed socket is already unregistered
                self._poll.unregister(number)

    def _run(self) -> None:
        while True:
            with self._lock:
                watched = dict(self._connections)
                self._running = bool(watched)
            if not watched:
                return
            ready = dict(self._poll.poll(_LOOK_S))
            for number, connection in watched.items():
                if connection.done:
                    self.unwatch(number)
                elif number in ready:
                    try:
                        connection.send_pending()
                    except TransportTerminated:
                        self.unwatch(number)
                        connection.close()


_WRITER = _Writer()


class _Ended:
    """Stands for the transport of a `QueuedConnection` whose thread is to end."""

    done = True


def direct_publish(publisher: rospy.Publisher) -> Callable[[Any], None]:
    """Let a publisher write in the thread that publishes; call it before its first message.

    Returns:
        A function that publishes a message of its type; raises rospy.ROSException once the
        publisher is closed.
    """
    implementation = publisher.impl
    most = implementation.queue_size or 0
    implementation.set_queue_size(None)
    if "add_connection" not in vars(implementation):  # else another publisher of the topic has
        _connect_directly(implementation, most)

    buffer = BytesIO()

    def publish(message: Any) -> None:
        lock = implementation.publock
        if publisher.impl is None or lock is None:
            raise rospy.ROSException("the topic is closed")
        with lock:
            if implementation.is_latch:
                implementation.publish(message)
            elif implementation.connections:
                implementation.seq += 1
                data = _pack_message(buffer, message, implementation.seq)
                implementation.message_data_sent += len(data)
                _send(data, implementation.connections)
    return publish


def _connect_directly(implementation: Any, most: int) -> None:
    """Wrap the connections of a topic's publishers, those to come and those that are there.

    Subscribers that wait for a topic, as all nodes of a launch file for /clock, come as soon as its
    publisher is registered.
    """
    add = implementation.add_connection

    def add_connection(transport: Transport) -> bool:
        return bool(add(DirectConnection(transport, most)))

    implementation.add_connection = add_connection
    with implementation.c_lock:
        implementation.connections = [DirectConnection(_without_thread(one), most)
                                      for one in implementation.connections]


def _without_thread(connection: Any) -> Any:
    """The transport of a connection on which nothing was sent; the thread of its queue ends."""
    if not isinstance(connection, QueuedConnection):
        return connection
    transport = connection._connection
    with connection._lock:
        connection._connection = _Ended()
        connection._cond_data_available.notify()
    return transport


def _pack_message(buffer: BytesIO, message: Any, number: int) -> bytes:
    """A message as it goes over the wire: its length, and what it is; it is given its number."""
    if message._has_header:
        message.header.seq = number
    buffer.seek(0)
    buffer.truncate()
    buffer.write(_NO_LENGTH)
    message.serialize(buffer)
    _LENGTH.pack_into(buffer.getbuffer(), 0, buffer.tell() - _LENGTH.size)
    return buffer.getvalue()


def _send(data: bytes, connections: List[Any]) -> None:
    for connection in connections:
        try:
            connection.write_data(data)
        except (TransportTerminated, OSError):
            connection.close()  # which takes it out of the list: a new one, not the one at hand
