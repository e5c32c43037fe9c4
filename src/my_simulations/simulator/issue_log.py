"""Buffers issues until a log is available."""
from __future__ import annotations

import threading
from collections import deque
from typing import Callable, Deque, List, Optional

from ..errors import Issue

RECENT_ISSUES = 100


class IssueLog:
    """Buffers issues until `open` is called, and keeps recent ones for `add_receiver`."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: List[Issue] = []
        self._recent: Deque[Issue] = deque(maxlen=RECENT_ISSUES)
        self._sink: Optional[Callable[[Issue], None]] = None
        self._also: Optional[Callable[[Issue], None]] = None

    def __call__(self, issue: Issue) -> None:
        with self._lock:
            sink, also = self._sink, self._also
            self._recent.append(issue)
            if sink is None:
                self._kept.append(issue)
        for receiver in (sink, also):
            if receiver is not None:
                receiver(issue)

    def add_receiver(self, sink: Callable[[Issue], None]) -> None:
        """Add a second receiver; it also gets the last `RECENT_ISSUES` issues."""
        with self._lock:
            self._also, recent = sink, list(self._recent)
        for issue in recent:
            sink(issue)

    def open(self, sink: Callable[[Issue], None]) -> None:
        """Set the receiver; it gets all buffered issues first."""
        with self._lock:
            self._sink, kept, self._kept = sink, self._kept, []
        for issue in kept:
            sink(issue)
