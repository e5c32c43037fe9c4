"""States of the world of a student, and the interface of such worlds."""
from __future__ import annotations

import socket
from typing import Optional, Protocol

from .class_plan import Student

STARTING, RUNNING, STOPPED, ENDED = "starting", "running", "stopped", "ended"


class World(Protocol):
    """The world of a student: processes of this machine, or a container (see `LocalWorld`)."""

    student: Student
    token: str
    state: str
    reason: str
    active: float
    monitor: int
    memory_mb: float
    processor_s: float

    @property
    def listening(self) -> Optional[socket.socket]:
        """The socket that browsers connect to; None if another process owns it."""

    @property
    def is_alive(self) -> bool:
        """Whether the world runs."""

    def start(self) -> None:
        """Start the world."""

    def poll(self) -> None:
        """Update state, memory and time of activity; call it about once a second."""

    def stop(self, reason: str) -> None:
        """Stop the world, and wait for its end."""
