"""Refuses requests to /gazebo that the owner of a world does not permit."""
from __future__ import annotations

import threading
from typing import Any, Callable, Optional, Set, Tuple

from ..errors import CommandError
from .interface import SUBSCRIBES, Row

STEPPING = "step_world"
"""The service that makes steps."""


class RefusedRequests:
    """Decides which services and topics of the node work, and stores which others were used.

    Only the owner of the world makes steps, so `step_world` is always refused.

    Args:
        may_change_world: whether requests can change the world at all.
    """

    def __init__(self, may_change_world: bool) -> None:
        self._may_change_world = may_change_world
        self._lock = threading.Lock()
        self._used: Set[str] = set()

    @property
    def used(self) -> Tuple[str, ...]:
        """Names of the refused services and topics that were used, sorted."""
        with self._lock:
            return tuple(sorted(self._used))

    def replace(self, row: Row) -> Optional[Callable[..., Any]]:
        """The handler that refuses the requests of a row; None if the row is permitted."""
        if row.name != STEPPING and (self._may_change_world or not row.changes_world):
            return None

        def refuse(*_request: Any) -> str:
            with self._lock:
                self._used.add(row.name)
            if row.direction is SUBSCRIBES:
                return ""     # a message has no response
            raise CommandError(f"/gazebo/{row.name} is not permitted in this world")

        return refuse
