"""How many clients may wait until the node accepts their connection."""
from __future__ import annotations

import select
import socket
import time

from rospy.impl import tcpros_base

from my_simulations.ros.lifecycle.tcpros_handshake import parallelise_handshakes

CLIENTS, WAIT = 100, 20.0


class Server:
    """What rospy has: a socket that listens. Connections are never accepted."""

    def __init__(self):
        self.server_sock = socket.socket()
        self.server_sock.bind(("127.0.0.1", 0))
        self.server_sock.listen(5)
        self.inbound_handler = None


class Tcpros:
    def __init__(self):
        self.tcp_ros_server = Server()


def test_a_hundred_clients_connect_before_the_first_is_accepted(monkeypatch):
    tcpros = Tcpros()
    monkeypatch.setattr(tcpros_base, "_tcpros_server", tcpros)
    parallelise_handshakes()
    server = tcpros.tcp_ros_server.server_sock
    waiting = [socket.socket() for _ in range(CLIENTS)]
    try:
        for client in waiting:
            client.setblocking(False)
            client.connect_ex(server.getsockname())
        # The kernel drops what does not fit into the backlog: such clients wait for ever here.
        connected, deadline = set(), time.monotonic() + WAIT
        while len(connected) < CLIENTS:
            assert time.monotonic() < deadline, f"{len(connected)} of {CLIENTS} connected"
            connected.update(select.select([], waiting, [], 0.1)[1])
            connected = {client for client in connected if _is_connected(client)}
    finally:
        for one in (*waiting, server):
            one.close()


def _is_connected(client):
    try:
        client.getpeername()
    except OSError:
        return False
    return True
