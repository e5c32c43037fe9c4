"""TCP ports for servers that tests start, and for servers that must not be there."""
from __future__ import annotations

import random
import socket
from typing import List

CANDIDATES = range(15000, 30000)
"""Below the ports that the system gives to connections and to servers that ask for any port: one of
those may be taken before the test uses it."""

_held: List[socket.socket] = []


def free_port() -> int:
    """Return a free port of 127.0.0.1 that no other test gets while this one runs."""
    while True:
        port = random.choice(CANDIDATES)
        claim = socket.socket(socket.AF_UNIX)
        try:
            # An abstract name (unix(7)) leaves with the process, however it ends.
            claim.bind(f"\0my_simulations_test_port_{port}")
            with socket.socket() as probe:
                probe.bind(("127.0.0.1", port))
        except OSError:
            claim.close()
            continue
        _held.append(claim)
        return port


def silent_uri() -> str:
    """The URI of a ROS master that is not there."""
    return f"http://127.0.0.1:{free_port()}"
