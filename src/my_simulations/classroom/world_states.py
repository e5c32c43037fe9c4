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
        """Socket that browsers connect to, if this process owns it."""

    @property
    def is_alive(self) -> bool:
        """Whether it runs."""

    def start(self) -> None:
        """Start it."""

    def look(self) -> None:
        """Notice its end, and measure it."""

    def stop(self, reason: str) -> None:
        """Stop it; waits for the end."""
