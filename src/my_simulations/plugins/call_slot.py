"""Holds a scheduled call of a plugin until it is ended or replaced."""
from __future__ import annotations

from typing import Optional

from .context import CallHandle


class CallSlot:
    """Holds at most one scheduled call."""

    def __init__(self) -> None:
        self._handle: Optional[CallHandle] = None

    @property
    def is_active(self) -> bool:
        """Whether a call was set and not ended."""
        return self._handle is not None

    def set(self, handle: CallHandle) -> None:
        """Hold a call; the previous one ends."""
        self.end()
        self._handle = handle

    def end(self) -> None:
        """End the call, if there is one."""
        if self._handle is not None:
            self._handle.end()
            self._handle = None
