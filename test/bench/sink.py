"""Receives topics and does nothing with them: `sink.py TOPIC …`; prints a line once all have come.

Each connection is a socket that is read into one buffer: a subscriber costs next to nothing.
"""
from __future__ import annotations

import os
import select
import socket
import struct
import sys
import time
from typing import Dict, List, Tuple
from xmlrpc.client import ServerProxy

_WAIT_S = 60.0
_LENGTH = struct.Struct("<I")
_PIECES = 2   # received when a message has come: the header of the connection, and the message


def _header(fields: Dict[str, str]) -> bytes:
    lines = [f"{name}={value}".encode() for name, value in fields.items()]
    body = b"".join(_LENGTH.pack(len(line)) + line for line in lines)
    return _LENGTH.pack(len(body)) + body


def connect(topic: str) -> socket.socket:
    """Connect to the first publisher of a topic, once there is one."""
    master = ServerProxy(os.environ["ROS_MASTER_URI"])
    me = f"/sink_{os.getpid()}"
    deadline = time.monotonic() + _WAIT_S
    while True:
        publishers = dict(master.getSystemState(me)[2][0]).get(topic, [])
        if publishers:
            break
        if time.monotonic() > deadline:
            raise SystemExit(f"nothing publishes {topic}")
        time.sleep(0.05)
    node = master.lookupNode(me, publishers[0])[2]
    protocol = ServerProxy(node).requestTopic(me, topic, [["TCPROS"]])[2]
    made = socket.create_connection((protocol[1], protocol[2]))
    made.sendall(_header({"message_definition": "", "callerid": me, "tcp_nodelay": "1",
                          "md5sum": "*", "topic": topic, "type": "*"}))
    return made


def main(topics: List[str]) -> None:
    """Receive for ever."""
    poll = select.epoll()
    found: Dict[int, Tuple[str, socket.socket]] = {}
    for topic in topics:
        made = connect(topic)
        found[made.fileno()] = (topic, made)
        poll.register(made.fileno(), select.EPOLLIN)
    buffer = bytearray(1 << 20)
    silent = dict.fromkeys(found, _PIECES)
    while True:
        for number, _ in poll.poll():
            if not found[number][1].recv_into(buffer):
                poll.unregister(number)
            elif number in silent:
                silent[number] -= 1
                if not silent[number]:
                    del silent[number]
                    if not silent:
                        print("ready", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
