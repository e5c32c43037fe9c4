"""The other side of ArduPilot's interface, played by a test."""
from __future__ import annotations

import socket
import struct

import pytest


class Autopilot:
    """Sends packets to a plugin, and reads its states.

    Attributes:
        vehicle: address at which the plugin listens.
    """

    def __init__(self):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(30.0)
        free = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        free.bind(("127.0.0.1", 0))
        self.vehicle = free.getsockname()
        free.close()

    @property
    def ports(self):
        return (f"<fdm_port_in>{self.vehicle[1]}</fdm_port_in>"
                f"<fdm_port_out>{self._socket.getsockname()[1]}</fdm_port_out>")

    def send(self, *floats):
        self._socket.sendto(struct.pack(f"<{len(floats)}f", *floats), self.vehicle)

    def state(self):
        return struct.unpack("<17d", self._socket.recv(4096))

    def close(self):
        self._socket.close()


@pytest.fixture
def autopilot():
    made = Autopilot()
    yield made
    made.close()
