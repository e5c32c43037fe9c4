"""Waits for file descriptors of any number: `select.select` handles those below 1024 only.

A node has one descriptor for each connection of its topics and services, so that those of a new
child process may be above.
"""
from __future__ import annotations

import fcntl
import os
import select

_MOST_OF_SELECT = 1024   # FD_SETSIZE


def wait_until_readable(descriptor: int, timeout: float) -> bool:
    """Wait for at most `timeout` s; returns whether a read would not block.

    `select` is used where possible: `poll` rounds up to milliseconds.
    """
    if descriptor < _MOST_OF_SELECT:
        return bool(select.select((descriptor,), (), (), timeout)[0])
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    return bool(poll.poll(1000.0 * timeout))


def lowest_descriptor(descriptor: int) -> int:
    """Move an open file to the lowest free descriptor above 2, and return that descriptor.

    The higher of both descriptors is closed; this can be the new one.
    """
    lowest = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)
    os.close(max(lowest, descriptor))
    return min(lowest, descriptor)
