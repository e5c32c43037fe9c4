"""TCP ports for servers that tests start, and for servers that must not be there."""
from __future__ import annotations

import contextlib
import random
import socket
from typing import List

CANDIDATES = range(15000, 30000)
"""Below the ports that the system gives to connections and to servers that ask for any port: one of
those may be taken before the test uses it."""

_held: List[contextlib.ExitStack] = []


def free_port() -> int:
    """Return a free port of 127.0.0.1 that no other test gets while this one runs."""
    return free_ports(1)


def free_ports(count: int) -> int:
    """Return the first of some free ports in a row, as `free_port` does."""
    while True:
        first = random.choice(CANDIDATES)
        with contextlib.ExitStack() as claims:
            try:
                for port in range(first, first + count):
                    claim = claims.enter_context(socket.socket(socket.AF_UNIX))
                    # An abstract name (unix(7)) leaves with the process, however it ends.
                    claim.bind(f"\0my_simulations_test_port_{port}")
                    with socket.socket() as probe:
                        probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            _held.append(claims.pop_all())
        return first


def silent_uri() -> str:
    """The URI of a ROS master that is not there."""
    return f"http://127.0.0.1:{free_port()}"
