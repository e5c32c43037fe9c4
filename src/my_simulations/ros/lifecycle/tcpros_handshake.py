"""Accepts connections to the node in parallel, so that no client can block the others.

rospy reads the handshake of a new connection in the thread that accepts all connections: a client
that connects and sends nothing (a port scanner, a stopped process) blocks every service and topic
of the node for ever. Here each handshake has a thread and a timeout of its own.

rospy lets five connections wait to be accepted. The kernel drops the request of a sixth, and its
client tries again after a second. Here as many may wait as the kernel allows.
"""
from __future__ import annotations

import socket
import threading
from typing import Any

from rospy.impl import tcpros_base

HANDSHAKE_SECONDS = 10.0


def parallelise_handshakes() -> None:
    """Give every handshake its own thread, and let many connections wait for it.

    Call it once, after the first publisher or service.

    rospy has no interface for this, so its server object is patched (rospy 1.14 to 1.17, the
    versions of the last ROS 1 distributions, have it in the same place).
    """
    server = tcpros_base._tcpros_server.tcp_ros_server
    shake_hands = server.inbound_handler

    def take(connection: Any, address: Any) -> None:
        # rospy makes the socket blocking again once the handshake is read.
        connection.settimeout(HANDSHAKE_SECONDS)
        threading.Thread(target=shake_hands, args=(connection, address), daemon=True).start()

    server.inbound_handler = take
    server.server_sock.listen(socket.SOMAXCONN)
